"""Cells: polyhedra that are cut by one half-space after the other, at the price of few linear programs.

A cell knows points inside it, so that most cuts leave a part that is known not to be empty; intervals and parallel rows
settle many of the others. What is left is one linear program for the greatest ball, in coordinates in which the first
box is ``[-1, 1]^n``. Where that ball is too small to trust, a vertex decides whether all rows can be met at all: a cell
without inner points is kept and marked flat.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.redundancy import irredundant_rows
from hysdel_py.geometry.sampling import spread_points
from hysdel_py.geometry.solver import LpSolver

__all__ = ["Cell", "Frame"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_POINTS = 64
"""Points with which the first box is filled."""
_RAY_POINTS = 4
"""Points from which the needed rows of a cell are looked for."""


@dataclass(frozen=True, eq=False, slots=True)
class Frame:
    """Coordinates in which a box is ``[-1, 1]^n``; a coordinate without finite ends keeps its unit.

    Attributes
    ----------
    centre, half : arrays of shape (n,)
    """

    centre: Vector
    half: Vector

    @classmethod
    def of_box(cls, low: Vector, high: Vector) -> Frame:
        """The frame of a box."""
        finite = np.isfinite(low) & np.isfinite(high)
        near = np.where(np.isfinite(low), low + 1.0, np.where(np.isfinite(high), high - 1.0, 0.0))
        centre = np.where(finite, (np.where(finite, low, 0.0) + np.where(finite, high, 0.0)) / 2.0, near)
        half = np.where(finite, (np.where(finite, high, 1.0) - np.where(finite, low, -1.0)) / 2.0, 1.0)
        return cls(centre, np.where(half > 0, half, 1.0))

    def row(self, a: Vector, b: float) -> tuple[Vector, float]:
        """A row ``a w <= b`` in the scaled coordinates."""
        return a * self.half, float(b - a @ self.centre)


@dataclass(frozen=True, eq=False)
class Cell:
    """``{w : A w <= b, low <= w <= high}``.

    Attributes
    ----------
    frame : Frame
    A, b : arrays of shapes (m, n) and (m,)
        Rows of the cuts, in the units of who made them.
    tags : tuple
        What the maker of a cut wants to be told of it again, one for each row.
    low, high : arrays of shape (n,)
        Box around the cell; tightened by cuts along one coordinate.
    points : array of shape (k, n)
        Inner points that are known; a flat cell has points that satisfy all rows instead.
    is_flat : bool
        Whether there are points but no inner ones.
    """

    frame: Frame
    A: Matrix
    b: Vector
    tags: tuple[object, ...]
    low: Vector
    high: Vector
    points: Matrix
    is_flat: bool = False

    @classmethod
    def box(cls, low: Vector, high: Vector, tags: tuple[object, ...]) -> Cell:
        """A box with the rows ``w <= high`` and ``-w <= -low`` in this order; infinite ends give no row.

        Parameters
        ----------
        tags : tuple of length 2 n
        """
        eye = np.eye(len(low))
        A, b = np.vstack([eye, -eye]), np.concatenate([high, -low])
        real = np.flatnonzero(np.isfinite(b))
        frame = Frame.of_box(low, high)
        flat = bool(np.any(low == high))
        spread = frame.centre + frame.half * (2.0 * spread_points(_POINTS, len(low)) - 1.0)
        points = frame.centre[None] if flat else np.vstack([frame.centre, spread])
        return cls(frame, A[real], b[real], tuple(tags[i] for i in real), low, high, points, flat)

    @property
    def n(self) -> int:
        """Dimension of the space."""
        return len(self.low)

    @cached_property
    def _units(self) -> tuple[Matrix, Vector, Vector]:
        """Unit normals and sides in the scaled coordinates, and the lengths of the scaled normals."""
        scaled = self.A * self.frame.half
        lengths = np.asarray(np.linalg.norm(scaled, axis=1))
        return scaled / lengths[:, None], (self.b - self.A @ self.frame.centre) / lengths, lengths

    def range_of(self, a: Vector, c: float, solver: LpSolver) -> tuple[float, float]:
        """Bounds of ``a w + c`` from the box and from parallel rows, without a linear program."""
        positive = a > 0
        ends_low, ends_high = np.where(positive, self.low, self.high), np.where(positive, self.high, self.low)
        used = a != 0
        low, high = float(a[used] @ ends_low[used]) + c, float(a[used] @ ends_high[used]) + c
        if int(used.sum()) < 2 or not len(self.b):
            return low, high
        G, h, _ = self._units
        scaled, side = self.frame.row(a, -c)
        length = float(np.linalg.norm(scaled))
        unit, margin = scaled / length, solver.precision.parallel
        same = np.abs(G - unit).max(axis=1) <= margin
        opposite = np.abs(G + unit).max(axis=1) <= margin
        if same.any():
            high = min(high, float(h[same].min()) * length - side)
        if opposite.any():
            low = max(low, -float(h[opposite].min()) * length - side)
        return low, high

    def cut(self, a: Vector, b: float, tag: object, solver: LpSolver) -> Cell | None:
        """The part with ``a w <= b``, None if there is none; a row that cannot cut anything off is left out."""
        low, high = self.range_of(a, -b, solver)
        touch = solver.precision.touch
        if low > touch:
            return None
        if high <= 0.0:
            return self
        points = self._points_of_cut(a, b, solver)
        child = self._with_row(a, b, tag, points)
        return child if len(points) else child._searched(solver)

    def _points_of_cut(self, a: Vector, b: float, solver: LpSolver) -> Matrix:
        """Known points that stay inside."""
        slack = b - self.points @ a
        if self.is_flat:
            return self.points[slack >= 0.0]
        return self.points[slack > solver.precision.interior * float(np.linalg.norm(a * self.frame.half))]

    def _with_row(self, a: Vector, b: float, tag: object, points: Matrix) -> Cell:
        low, high = self.low, self.high
        used = np.flatnonzero(a)
        if len(used) == 1:
            low, high = _tightened(low, high, int(used[0]), float(a[used[0]]), b)
        return Cell(
            self.frame, np.vstack([self.A, a]), np.append(self.b, b), (*self.tags, tag), low, high, points, self.is_flat
        )

    def _searched(self, solver: LpSolver) -> Cell | None:
        """The cell with a point that a linear program found, or None."""
        if not self.is_flat:
            centre, radius = self._greatest_ball(solver)
            if radius > solver.precision.interior:
                return self._with_points(centre, flat=False)
            if radius < -solver.precision.interior:
                return None
        return self._settled_by_a_vertex(solver)

    def _greatest_ball(self, solver: LpSolver) -> tuple[Vector, float]:
        G, h, _ = self._units
        free = np.full(self.n + 1, np.inf)
        rows = np.column_stack([G, np.ones(len(h))])
        high = np.append(free[:-1], 1.0)
        answer = solver.maximise(np.append(np.zeros(self.n), 1.0), rows, h, -free, high)
        if answer.is_optimal:
            return self.frame.centre + self.frame.half * answer.w[:-1], float(answer.w[-1])
        return self.frame.centre, 0.0

    def _settled_by_a_vertex(self, solver: LpSolver) -> Cell | None:
        """Move all rows outwards as little as possible, each in its own unit."""
        G, h, lengths = self._units
        rows = np.column_stack([G, 1.0 / lengths])
        free = np.append(np.full(self.n, np.inf), np.inf)
        high = np.append(free[:-1], 1.0)
        answer = solver.maximise_exactly(np.append(np.zeros(self.n), 1.0), rows, h, -free, high)
        if not answer.is_optimal or answer.w[-1] < -solver.precision.touch:
            return None
        point = self.frame.centre + self.frame.half * answer.w[:-1]
        return self._with_points(point, flat=bool(answer.w[-1] <= solver.precision.touch))

    def _with_points(self, point: Vector, *, flat: bool) -> Cell:
        return Cell(self.frame, self.A, self.b, self.tags, self.low, self.high, point[None], flat)

    def needed_rows(self, solver: LpSolver) -> tuple[int, ...]:
        """Rows without which the cell would be larger."""
        G, h, _ = self._units
        inside = np.zeros((0, self.n)) if self.is_flat else self.points[:_RAY_POINTS]
        return irredundant_rows(G, h, (inside - self.frame.centre) / self.frame.half, solver)


def _tightened(low: Vector, high: Vector, column: int, a: float, b: float) -> tuple[Vector, Vector]:
    """A box cut by ``a w_column <= b``."""
    low, high = low.copy(), high.copy()
    if a > 0:
        high[column] = min(high[column], b / a)
    else:
        low[column] = max(low[column], b / a)
    return low, high
