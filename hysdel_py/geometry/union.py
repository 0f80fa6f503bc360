"""Unions of polyhedra, and what is left of a polyhedron when others are taken away."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.relations import includes

__all__ = ["PolyhedralUnion", "difference"]

_INWARDS = 0.99
"""Share of the way from the centre to a corner at which the corner is judged."""

_SAME_VOLUME = 1e-9
"""Relative difference of volumes of two sets that are the same."""


def difference(polyhedron: Polyhedron, others: Iterable[Polyhedron]) -> tuple[Polyhedron, ...]:
    """Polyhedra with disjoint interiors whose union is a polyhedron without the interiors of others.

    One of the others after the other is cut away row by row: the part beyond its first row, the part within the first
    and beyond the second, and so on (M. Baotic, "Polytopic computations in constrained optimal control", Automatika 50,
    2009). Parts without inner points are dropped.
    """
    return tuple(_remaining(polyhedron, [other for other in others if _overlap(polyhedron, other)]))


def _remaining(polyhedron: Polyhedron, others: Sequence[Polyhedron]) -> Iterator[Polyhedron]:
    """Pieces of a difference, one after the other, so that asking for the first is cheap."""
    others = _cutting(polyhedron, others)
    open_pieces = [(polyhedron, 0)] if _has_inner_points(polyhedron) else []
    while open_pieces:
        part, level = open_pieces.pop()
        if level == len(others):
            yield part
        else:
            open_pieces += [(piece, level + 1) for piece in _outside(part, others[level])][::-1]


def _cutting(polyhedron: Polyhedron, others: Sequence[Polyhedron]) -> list[Polyhedron]:
    """The others that have inner points of a bounded polyhedron, with the rows alone that cut it, few rows first.

    A row that no corner passes by more than a ball of the least radius is wide cuts no piece off.
    """
    corners = _corners(polyhedron)
    if corners is None:
        return list(others)
    width, found = 2 * polyhedron.precision.empty, []
    for other in (one.normalised() for one in others):
        beyond = corners @ other.A.T - other.b
        if np.all(beyond.min(axis=0, initial=np.inf) < -width):
            rows = beyond.max(axis=0, initial=-np.inf) > width
            found.append(Polyhedron(other.A[rows], other.b[rows], other.precision))
    return sorted(found, key=lambda other: other.m)


def _corners(polyhedron: Polyhedron) -> NDArray[np.float64] | None:
    """Vertices, None for an unbounded polyhedron and one whose scale is too bad for them."""
    try:
        return polyhedron.vertices
    except ArgumentError:
        return None


def _overlap(first: Polyhedron, second: Polyhedron) -> bool:
    """Whether the boxes around two polyhedra have inner points in common."""
    (low, high), (other_low, other_high) = first.bounding_box, second.bounding_box
    return bool(np.all(np.minimum(high, other_high) - np.maximum(low, other_low) > first.precision.empty))


def _outside(part: Polyhedron, other: Polyhedron) -> Iterator[Polyhedron]:
    """Pieces of a polyhedron outside another one."""
    cutting = _cutting(part, [other])
    if not cutting or not _share_inner_points(part, cutting[0]):
        yield part
        return
    rest, cut = part, cutting[0].normalised()
    for a, b in zip(cut.A, cut.b, strict=True):
        beyond = rest.with_rows(-a, -b)
        if _has_inner_points(beyond):
            yield beyond
            rest = rest.with_rows(a, b)


def _share_inner_points(part: Polyhedron, other: Polyhedron) -> bool:
    """Whether two polyhedra have inner points in common; the centre of the first one may tell."""
    if float(np.min(other.slack(part.ball.centre) / other.lengths, initial=np.inf)) > part.precision.empty:
        return _has_inner_points(part)
    return _has_inner_points(part & other)


def _has_inner_points(polyhedron: Polyhedron) -> bool:
    return polyhedron.ball.radius > polyhedron.precision.empty


@dataclass(frozen=True, eq=False, repr=False)
class PolyhedralUnion:
    """Points that lie in at least one of some polyhedra.

    Attributes
    ----------
    parts : tuple of Polyhedron
        They may overlap, be flat or empty; at least one.
    """

    parts: tuple[Polyhedron, ...]

    def __repr__(self) -> str:
        return f"<PolyhedralUnion of {len(self.parts)} polyhedra in {self.n} coordinates>"

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        if not self.parts:
            raise ArgumentError("a union needs at least one polyhedron; use Polyhedron.empty(n) for an empty set")
        if len({part.n for part in self.parts}) > 1:
            raise ArgumentError(f"all parts must have as many coordinates; found {sorted({p.n for p in self.parts})}")

    @property
    def n(self) -> int:
        """Dimension of the space."""
        return self.parts[0].n

    def contains(self, w: ArrayLike, tolerance: float = 0.0) -> bool:
        """Whether a point lies in some part."""
        return any(part.contains(w, tolerance) for part in self.parts)

    @property
    def is_empty(self) -> bool:
        """Whether every part is empty."""
        return all(part.is_empty for part in self.parts)

    @property
    def is_full_dimensional(self) -> bool:
        """Whether every part that is not empty has inner points."""
        return not self.is_empty and all(part.is_empty or part.dimension == part.n for part in self.parts)

    @property
    def is_bounded(self) -> bool:
        """Whether every part is bounded."""
        return all(part.is_bounded for part in self.parts)

    @cached_property
    def envelope(self) -> Polyhedron:
        """Convex hull of all parts; closed, as every polyhedron is."""
        found = [part.generators for part in self.parts if not part.is_empty]
        if not found:
            return Polyhedron.empty(self.n)
        points, rays, lines = (np.vstack([getattr(g, what) for g in found]) for what in ("points", "rays", "lines"))
        return Polyhedron.hull(points, rays, lines, self.parts[0].precision)

    @property
    def is_convex(self) -> bool:
        """Whether the union is its convex hull, up to sets without inner points.

        A. Bemporad, K. Fukuda and F. D. Torrisi, "Convexity recognition of the union of polyhedra", Computational
        Geometry 18, 2001.
        """
        return self.covers(self.envelope)

    def covers(self, polyhedron: Polyhedron) -> bool:
        """Whether every point of a polyhedron lies in the union, up to sets without inner points.

        A flat polyhedron is covered if one part holds it.
        """
        if polyhedron.dimension < polyhedron.n:
            return any(includes(part, polyhedron) for part in self.parts)
        meeting = [part for part in self.parts if _overlap(polyhedron, part)]
        if _sticks_out(polyhedron, meeting):
            return False
        if polyhedron.is_bounded and any(_holds_corners(part, polyhedron) for part in meeting):
            return True
        return next(_remaining(polyhedron, meeting), None) is None

    @cached_property
    def is_connected(self) -> bool:
        """Whether any two points are joined by a path inside the union."""
        left = [part for part in self.parts if not part.is_empty]
        reached, left = left[:1], left[1:]
        while reached and left:
            here = reached.pop()
            touching = [part for part in left if not (part & here).is_empty]
            left = [part for part in left if all(part is not other for other in touching)]
            reached += touching
        return not left

    def minus(self, others: Iterable[Polyhedron]) -> tuple[Polyhedron, ...]:
        """What is left with the interiors of other polyhedra taken away."""
        taken = tuple(others)
        return tuple(piece for part in self.disjoint for piece in difference(part, taken))

    @cached_property
    def disjoint(self) -> tuple[Polyhedron, ...]:
        """Polyhedra with disjoint interiors and the same union, up to sets without inner points."""
        pieces: list[Polyhedron] = []
        for i, part in enumerate(self.parts):
            pieces += difference(part, self.parts[:i])
        return tuple(pieces)

    @cached_property
    def volume(self) -> float:
        """Volume; what is covered twice counts once."""
        return float(sum(piece.volume for piece in self.disjoint))

    def reduced(self) -> PolyhedralUnion:
        """The same union without parts that the others cover; of equal parts the first stays."""
        kept = [part for part in self.parts if not part.is_empty]
        for part in reversed(tuple(kept)):
            rest = [other for other in kept if other is not part]
            if rest and PolyhedralUnion(tuple(rest)).covers(part):
                kept = rest
        return PolyhedralUnion(tuple(kept) or (Polyhedron.empty(self.n),))

    def merged(self) -> PolyhedralUnion:
        """The same union with neighbours whose union is convex joined, until no two are left."""
        parts = list(self.reduced().parts)
        done = 0  # no two of the first so many parts can be joined
        while done < len(parts):
            found = _joinable(parts[:done], parts[done])
            if found is None:
                done += 1
            else:
                i, joined = found
                parts = [*parts[:i], *parts[i + 1 : done], *parts[done + 1 :], joined]
                done -= 1
        return PolyhedralUnion(tuple(parts))


def _joinable(parts: list[Polyhedron], last: Polyhedron) -> tuple[int, Polyhedron] | None:
    """The first part that makes a convex union with another one, and that union."""
    for i, part in enumerate(parts):
        joined = _joined_if_told(part, last) if _touch(part, last) else None
        if joined is not None:
            return i, joined
    return None


def _joined_if_told(first: Polyhedron, second: Polyhedron) -> Polyhedron | None:
    """As `_joined`; parts of so bad a scale that their hull can't be told stay as they are."""
    try:
        return _joined(first, second)
    except ArgumentError:
        return None


def _sticks_out(polyhedron: Polyhedron, parts: Sequence[Polyhedron]) -> bool:
    """Whether a corner, moved a little inwards, lies clearly outside all parts.

    Then a small ball around it is left over. It costs no linear program; that no corner does so proves nothing.
    """
    if not polyhedron.is_bounded:
        return False
    points = polyhedron.ball.centre + _INWARDS * (polyhedron.vertices - polyhedron.ball.centre)
    far = 4.0 * polyhedron.precision.empty
    outside = _least_slack(polyhedron, points) > far
    for part in parts:
        outside &= _least_slack(part, points) < -far
    return bool(outside.any())


def _holds_corners(part: Polyhedron, polyhedron: Polyhedron) -> bool:
    """Whether a part holds all corners of a bounded polyhedron, and so the polyhedron."""
    return bool(np.all(_least_slack(part, polyhedron.vertices) >= -part.precision.empty))


def _least_slack(polyhedron: Polyhedron, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of each point to the nearest row, negative outside."""
    lengths = np.where(polyhedron.lengths > 0, polyhedron.lengths, np.inf)
    return np.asarray(np.min((polyhedron.b - points @ polyhedron.A.T) / lengths, axis=1, initial=np.inf))


def _touch(first: Polyhedron, second: Polyhedron) -> bool:
    """Whether the boxes around two polyhedra meet."""
    (low, high), (other_low, other_high) = first.bounding_box, second.bounding_box
    return bool(np.all(np.minimum(high, other_high) - np.maximum(low, other_low) >= -first.precision.empty))


def _leave_a_dent(first: Polyhedron, second: Polyhedron) -> bool:
    """Whether the middle between two corners lies clearly outside both polyhedra, so that their union is not convex."""
    middles = (first.vertices[:, None] + second.vertices[None]).reshape(-1, first.n) / 2.0
    far = -4.0 * first.precision.empty
    return bool(np.any((_least_slack(first, middles) < far) & (_least_slack(second, middles) < far)))


def _joined(first: Polyhedron, second: Polyhedron) -> Polyhedron | None:
    """The union of two polyhedra if it is convex; for bounded ones with inner points the volumes tell."""
    pair = PolyhedralUnion((first, second))
    if not (pair.is_bounded and pair.is_full_dimensional):
        return pair.envelope if (first & second).dimension >= first.n - 1 and pair.is_convex else None
    if _leave_a_dent(first, second):
        return None
    apart = first.volume + second.volume
    missing = pair.envelope.volume - apart
    if missing > _SAME_VOLUME * apart:
        return None
    overlap = (first & second).volume if missing < -_SAME_VOLUME * apart else 0.0
    return pair.envelope if missing + overlap <= _SAME_VOLUME * apart else None
