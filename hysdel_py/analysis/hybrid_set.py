"""Sets of hybrid states: polyhedra of the real states, each with values of the Boolean ones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.union import PolyhedralUnion, difference
from hysdel_py.systems.signals import Variable, as_vector

__all__ = ["HybridSet", "Piece", "Span", "box_of", "hybrid_set"]

Word = tuple[bool, ...]
Span = float | tuple[float, float]
"""A value, or the ends of an interval."""


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """A polyhedron of real states with values of the Boolean states.

    Attributes
    ----------
    word : tuple of bool
        In the order of the Boolean states.
    region : Polyhedron
        In the order of the real states.
    mode : int or None
        Mode of the step that led here, or that leads on from here where sets were computed backward.
    parent : int or None
        Number of the piece, one step earlier in the computation, that this one comes from; None where several were
        joined.
    """

    word: Word
    region: Polyhedron
    mode: int | None = None
    parent: int | None = None


@dataclass(frozen=True, eq=False)
class HybridSet:
    """A union of pieces.

    Attributes
    ----------
    x : tuple of Variable
        All states.
    pieces : tuple of Piece
    """

    x: tuple[Variable, ...]
    pieces: tuple[Piece, ...]

    @property
    def is_empty(self) -> bool:
        """Whether there is no state in the set."""
        return all(piece.region.is_empty for piece in self.pieces)

    def contains(self, x: ArrayLike | Mapping[str, float], tolerance: float = 0.0) -> bool:
        """Whether a state lies in the set."""
        word, reals = split_state(as_vector(x, self.x, "state"), self.x)
        return any(piece.word == word and piece.region.contains(reals, tolerance) for piece in self.pieces)

    def by_word(self) -> dict[Word, tuple[int, ...]]:
        """Numbers of the pieces for each value of the Boolean states."""
        found: dict[Word, list[int]] = {}
        for number, piece in enumerate(self.pieces):
            found.setdefault(piece.word, []).append(number)
        return {word: tuple(numbers) for word, numbers in found.items()}

    def ranges(self) -> dict[str, tuple[float, float]]:
        """Least and greatest value of each state; empty for an empty set."""
        filled = [piece for piece in self.pieces if not piece.region.is_empty]
        if not filled:
            return {}
        low = np.min([whole_state(p.word, p.region.bounding_box[0], self.x) for p in filled], axis=0)
        high = np.max([whole_state(p.word, p.region.bounding_box[1], self.x) for p in filled], axis=0)
        return {v.name: (float(a), float(b)) for v, a, b in zip(self.x, low, high, strict=True)}

    def covers(self, other: HybridSet) -> bool:
        """Whether every state of another set lies in this one, up to sets without inner points."""
        ours = self.by_word()
        return all(
            piece.region.is_empty or (piece.word in ours and self._union(ours[piece.word]).covers(piece.region))
            for piece in other.pieces
        )

    def _union(self, numbers: Iterable[int]) -> PolyhedralUnion:
        return PolyhedralUnion(tuple(self.pieces[i].region for i in numbers))

    def meets(self, other: HybridSet) -> tuple[int, int] | None:
        """Numbers of the first two pieces, one of each set, that have a state in common."""
        for i, ours in enumerate(self.pieces):
            for j, theirs in enumerate(other.pieces):
                if ours.word == theirs.word and not (ours.region & theirs.region).is_empty:
                    return i, j
        return None

    def minus(self, other: HybridSet) -> HybridSet:
        """What is left without the interior of another set."""
        theirs = other.by_word()
        left = [
            Piece(piece.word, part, piece.mode, piece.parent)
            for piece in self.pieces
            for part in _left(piece.region, [other.pieces[i].region for i in theirs.get(piece.word, ())])
        ]
        return HybridSet(self.x, tuple(left))

    def __and__(self, other: HybridSet) -> HybridSet:
        pairs = [
            Piece(ours.word, ours.region & theirs.region, ours.mode, ours.parent)
            for ours in self.pieces
            for theirs in other.pieces
            if ours.word == theirs.word
        ]
        return HybridSet(self.x, tuple(piece for piece in pairs if not piece.region.is_empty))

    def __or__(self, other: HybridSet) -> HybridSet:
        return HybridSet(self.x, (*self.pieces, *other.pieces))


def _left(region: Polyhedron, others: Sequence[Polyhedron]) -> tuple[Polyhedron, ...]:
    """A flat region stays whole unless one of the others holds it."""
    if region.dimension == region.n:
        return difference(region, others)
    covered = bool(others) and PolyhedralUnion(tuple(others)).covers(region)
    return () if covered or region.is_empty else (region,)


def split_state(x: NDArray[np.float64], variables: Sequence[Variable]) -> tuple[Word, NDArray[np.float64]]:
    """Boolean and real states of a state."""
    word = tuple(bool(value > 0.5) for value, v in zip(x, variables, strict=True) if v.is_bool)
    return word, np.array([value for value, v in zip(x, variables, strict=True) if not v.is_bool], dtype=float)


def whole_state(word: Word, reals: NDArray[np.float64], variables: Sequence[Variable]) -> NDArray[np.float64]:
    """The state with given Boolean and real parts."""
    booleans, rest = iter(word), iter(reals)
    return np.array([float(next(booleans)) if v.is_bool else float(next(rest)) for v in variables])


def hybrid_set(given: Mapping[str, Span] | Polyhedron | HybridSet, x: tuple[Variable, ...], what: str) -> HybridSet:
    """A set of states as it may be given.

    Parameters
    ----------
    given : mapping of name to value or (low, high), Polyhedron, or HybridSet
        States that a mapping leaves out may have any value of their range. A polyhedron is one over all states; the
        Boolean ones are taken to be 0 or 1.
    x : tuple of Variable
    what : str
        Name of the argument, for messages.

    Raises
    ------
    ArgumentError
        For an unknown name, an interval upside down, or a polyhedron of another dimension.
    """
    if isinstance(given, HybridSet):
        return given
    if isinstance(given, Polyhedron):
        return _from_polyhedron(given, x, what)
    low, high = box_of(given, x, what)
    return _from_polyhedron(Polyhedron.box(low, high), x, what)


def box_of(
    given: Mapping[str, Span], variables: Sequence[Variable], what: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Ends of the intervals of all variables; those that are not named have their declared range."""
    if not isinstance(given, Mapping):
        raise ArgumentError(f"{what}: expected names with values or (low, high), found {type(given).__name__}")
    names = [v.name for v in variables]
    unknown = [name for name in given if name not in names]
    if unknown:
        raise ArgumentError(f"{what}: there is no {unknown[0]}; the names are {', '.join(names) or 'none'}")
    ends = np.array([_span(given[v.name], v, what) if v.name in given else _declared(v) for v in variables])
    ends = ends.reshape(-1, 2)
    return ends[:, 0], ends[:, 1]


def _declared(variable: Variable) -> tuple[float, float]:
    return (0.0, 1.0) if variable.is_bool else (float(variable.low), float(variable.high))


def _span(value: Span, variable: Variable, what: str) -> tuple[float, float]:
    try:
        low, high = np.broadcast_to(np.asarray(value, dtype=float), (2,)).tolist()
    except (TypeError, ValueError):
        raise ArgumentError(f"{what}: {variable.name} must be a number or (low, high), found {value!r}") from None
    if not low <= high:
        raise ArgumentError(f"{what}: {variable.name} lies between {low:g} and {high:g}, which holds no number")
    return low, high


def _from_polyhedron(polyhedron: Polyhedron, x: tuple[Variable, ...], what: str) -> HybridSet:
    if polyhedron.n != len(x):
        raise ArgumentError(f"{what}: the polyhedron has {polyhedron.n} coordinates, the model {len(x)} states")
    booleans = [i for i, v in enumerate(x) if v.is_bool]
    pieces = []
    for values in product((False, True), repeat=len(booleans)):
        region = polyhedron.section(dict(zip(booleans, map(float, values), strict=True)))
        if not region.is_empty:
            pieces.append(Piece(values, region))
    return HybridSet(x, tuple(pieces))
