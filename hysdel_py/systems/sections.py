"""The part of a mode's region that lies in the real coordinates, where its Boolean coordinates are fixed or free."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.precision import Precision
from hysdel_py.systems.mode import Condition, Mode, RowKind
from hysdel_py.systems.signals import Variable

__all__ = ["Section", "compatible", "facing_rows", "section_of"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Section:
    """``{v : A v <= b}`` in the real coordinates.

    Attributes
    ----------
    mode : Mode
    A, b : arrays of shapes (m, k) and (m,)
    sources : tuple of Condition
        One for each row.
    booleans : tuple of (column, value)
        Boolean coordinates of the region; None stands for both values.
    low, high : arrays of shape (k,)
        Box around the section, from the declared ranges and the rows along one coordinate.
    """

    mode: Mode
    A: Matrix
    b: Vector
    sources: tuple[Condition, ...]
    booleans: tuple[tuple[int, bool | None], ...]
    low: Vector
    high: Vector

    @cached_property
    def gaps(self) -> Vector:
        """Epsilon of each row, 0 where it is no threshold."""
        return np.array([source.gap for source in self.sources])

    @cached_property
    def lengths(self) -> Vector:
        """Lengths of the normals."""
        return np.asarray(np.linalg.norm(self.A, axis=1))


def section_of(mode: Mode, variables: tuple[Variable, ...]) -> Section:
    """Section of a mode; `variables` are those of (x, u)."""
    reals = [i for i, v in enumerate(variables) if not v.is_bool]
    rows = [i for i, source in enumerate(mode.sources) if source.kind is not RowKind.BOOLEAN]
    A, b = mode.region.A[np.ix_(rows, reals)], mode.region.b[rows]
    values = mode.values
    booleans = tuple((i, values[v.name]) for i, v in enumerate(variables) if v.is_bool)
    low = np.array([variables[i].low for i in reals], dtype=float)
    high = np.array([variables[i].high for i in reals], dtype=float)
    for row, side in zip(A, b, strict=True):
        used = np.flatnonzero(row)
        if len(used) == 1:
            column, end = used[0], side / row[used[0]]
            if row[column] > 0:
                high[column] = min(high[column], end)
            else:
                low[column] = max(low[column], end)
    return Section(mode, A, b, tuple(mode.sources[i] for i in rows), booleans, low, high)


def compatible(first: Section, second: Section) -> bool:
    """Whether some values of the Boolean coordinates belong to both."""
    pairs = zip(first.booleans, second.booleans, strict=True)
    return all(None in (one, other) or one == other for (_, one), (_, other) in pairs)


def facing_rows(first: Section, second: Section, precision: Precision) -> list[tuple[int, int]]:
    """Pairs of rows with opposite normals that are at most a gap apart: the two sides of one hyperplane."""
    if not len(first.b) or not len(second.b):
        return []
    G, H = first.A / first.lengths[:, None], second.A / second.lengths[:, None]
    opposite = np.abs(G[:, None, :] + H[None, :, :]).max(axis=2) <= precision.parallel
    apart = -(first.b / first.lengths)[:, None] - (second.b / second.lengths)[None, :]
    allowed = np.maximum((first.gaps / first.lengths)[:, None], (second.gaps / second.lengths)[None, :])
    size = 1.0 + np.abs(first.b / first.lengths)[:, None]
    near = np.abs(apart) <= allowed * (1.0 + precision.interior) + precision.touch * size
    return [(int(i), int(j)) for i, j in np.argwhere(opposite & near)]
