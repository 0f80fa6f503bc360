"""One mode of a piecewise affine system: an affine map on a polyhedron, and why the polyhedron is what it is."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.affine import Affine

__all__ = ["Auxiliaries", "Condition", "Mode", "RowKind", "Word"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Word = tuple[tuple[str, bool | None], ...]
"""Names of Booleans with their values; None stands for both."""

_NEGATED = {"<=": ">", ">=": "<", "<": ">=", ">": "<="}
_COMPARISON = re.compile(r"<=|>=|<|>")


class RowKind(Enum):
    """What a row of a region comes from."""

    EVENT = "event"
    MUST = "must"
    RANGE = "range"
    BOOLEAN = "boolean"


@dataclass(frozen=True, slots=True)
class Condition:
    """The source of a row of a region.

    Attributes
    ----------
    kind : RowKind
        A threshold, a requirement, a declared range or the value of a Boolean.
    name : str
        The Boolean that the threshold defines, or the variable that has the range or the value.
    holds : bool
        Whether the row is the side ``form <= 0`` of the threshold; the other side is ``form >= gap``.
    gap : float
        Epsilon of the threshold, 0 elsewhere.
    text : str
        The condition as it is written in the source, empty where it has no text of its own.
    line : int
        Line in the source, 0 if unknown.
    """

    kind: RowKind
    name: str
    holds: bool = True
    gap: float = 0.0
    text: str = ""
    line: int = 0

    def describe(self, form: Affine) -> str:
        """The condition in words of the source; `form` is ``a w - b`` of the row, for one without text."""
        place = f" (line {self.line})" if self.line else ""
        return f"{self._statement(form)}{place}"

    def _statement(self, form: Affine) -> str:
        text = self.text
        if not text:
            return f"{form} <= 0"
        if self.holds:
            return text
        signs = _COMPARISON.findall(text)
        if len(signs) == 1:
            return _COMPARISON.sub(_NEGATED[signs[0]], text)
        return f"~({text})"


@dataclass(frozen=True, eq=False, slots=True)
class Auxiliaries:
    """Auxiliary variables of a mode: ``d`` constant and ``z = Z w + z0`` in ``w = (x, u)``.

    Attributes
    ----------
    d : array of shape (nd,)
    Z : array of shape (nz, nx + nu)
    z0 : array of shape (nz,)
    """

    d: Vector
    Z: Matrix
    z0: Vector

    def at(self, w: Vector) -> tuple[Vector, Vector]:
        """Values of d and z at a point."""
        return self.d, self.Z @ w + self.z0


@dataclass(frozen=True, eq=False, repr=False)
class Mode:
    """``x+ = A x + B u + f`` and ``y = C x + D u + g`` on a polyhedron in (x, u); Booleans are 0 or 1.

    Attributes
    ----------
    index : int
    A, B, f : arrays of shapes (nx, nx), (nx, nu), (nx,)
    C, D, g : arrays of shapes (ny, nx), (ny, nu), (ny,)
    region : Polyhedron
        Over ``(x, u)``, without rows that others imply. Rows of Booleans come last.
    sources : tuple of Condition
        One for each row of the region.
    word : tuple of (name, value)
        Values of the Booleans that matter and of all d; None where both values belong to the mode.
    is_flat : bool
        Whether the region has no inner points with respect to its real coordinates.
    names : tuple of str
        Names of the coordinates of the region.
    """

    index: int
    A: Matrix
    B: Matrix
    f: Vector
    C: Matrix
    D: Matrix
    g: Vector
    region: Polyhedron
    sources: tuple[Condition, ...]
    word: Word
    is_flat: bool
    names: tuple[str, ...]

    def __repr__(self) -> str:
        return f"<Mode {self.index}: {self.bits or 'no Booleans'}, {self.region.m} rows>"

    def __post_init__(self) -> None:
        for array in (self.A, self.B, self.f, self.C, self.D, self.g):
            array.setflags(write=False)

    @property
    def bits(self) -> str:
        """The word as zeros and ones, ``*`` where both values belong to the mode."""
        return "".join("*" if value is None else str(int(value)) for _, value in self.word)

    @property
    def values(self) -> dict[str, bool | None]:
        """The word by name."""
        return dict(self.word)

    @property
    def conditions(self) -> tuple[str, ...]:
        """Thresholds and requirements that select the mode, as they are written in the source."""
        rows = zip(self.sources, self.region.A, self.region.b, strict=True)
        chosen = [(source, self.form(a, b)) for source, a, b in rows if source.kind not in _STATED_ELSEWHERE]
        return tuple(dict.fromkeys(source.describe(form) for source, form in chosen))

    def form(self, a: Vector, b: float) -> Affine:
        """``a w - b`` with names."""
        return Affine(-float(b), tuple((n, float(c)) for n, c in zip(self.names, a, strict=True) if c))

    def map(self, x: Vector, u: Vector) -> tuple[Vector, Vector]:
        """Next state and output."""
        return self.A @ x + self.B @ u + self.f, self.C @ x + self.D @ u + self.g

    @property
    def dynamics(self) -> Matrix:
        """``[A B f; C D g]``."""
        upper, lower = np.column_stack([self.A, self.B, self.f]), np.column_stack([self.C, self.D, self.g])
        return np.vstack([upper, lower])


_STATED_ELSEWHERE = frozenset({RowKind.RANGE, RowKind.BOOLEAN})
