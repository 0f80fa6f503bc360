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

from hysdel_py.geometry.lp import LpResult
from hysdel_py.geometry.redundancy import irredundant_rows
from hysdel_py.geometry.sampling import spread_points
from hysdel_py.geometry.solver import LpSolver

__all__ = ["Cell", "Frame"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_POINTS = 64
"""Points with which the first box is filled."""
_BEYOND = 2.0
"""Bound of scaled coordinates, outside the box of finite ranges; it lets multipliers prove a bound."""
_ON_THE_WAY = 0.7
"""Where on the way from an inner point to a face another one is put."""
_RAY_POINTS = 16
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
    is_minimal : bool
        Whether all rows are known to be needed.
    """

    frame: Frame
    A: Matrix
    b: Vector
    tags: tuple[object, ...]
    low: Vector
    high: Vector
    points: Matrix
    is_flat: bool = False
    is_minimal: bool = False

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
        return self._cut(a, b, tag, solver)[0]

    def split(self, a: Vector, c: float, gap: float, tags: tuple[object, object], solver: LpSolver) -> Sides:
        """The parts with ``a w + c <= 0`` and with ``a w + c >= gap``, each None if there is none.

        Where one part is empty by a clear margin, the other one is the whole cell, without a further row.
        """
        first, least = self._cut(a, -c, tags[0], solver)
        if first is None:
            whole = c + least >= gap
            return None, self if whole else self.cut(-a, c - gap, tags[1], solver)
        second, least = self._cut(-a, c - gap, tags[1], solver)
        if second is None and c - least <= 0.0:
            return self, None
        return first, second

    def _cut(self, a: Vector, b: float, tag: object, solver: LpSolver) -> tuple[Cell | None, float]:
        """The part with ``a w <= b``, and a lower bound of ``a w`` on the cell if there is none."""
        low, high = self.range_of(a, 0.0, solver)
        if low - b > solver.precision.touch:
            return None, low
        if high <= b:
            return self, low
        points = self._points_of_cut(a, b, solver)
        child = self._with_row(a, b, tag, points)
        if len(points):
            return child, low
        found, excess = child._searched(solver)
        return found, max(low, b + excess)

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

    def _searched(self, solver: LpSolver) -> tuple[Cell | None, float]:
        """The cell with a point that a linear program found, or None and by how much the other rows exceed the last."""
        if not self.is_flat:
            answer = self._greatest_ball(solver)
            radius = float(answer.w[-1]) if answer.is_optimal else 0.0
            if radius > solver.precision.interior:
                return self._with_points(self.frame.centre + self.frame.half * answer.w[:-1], flat=False), -np.inf
            if radius < -solver.precision.interior:
                return None, self._excess(answer)
        return self._settled_by_a_vertex(solver), -np.inf

    def _excess(self, answer: LpResult) -> float:
        """By how much the last row is missed by all points that satisfy the others, proven by the multipliers.

        With multipliers y and the bound t of the greatest radius, every such point has ``a w - b >= -t / y_last`` for
        the last row at unit length, since the terms of the other rows are not negative.
        """
        last = float(answer.y[-1])
        if last <= 0.0 or not answer.bound < 0.0:
            return 0.0
        return -answer.bound / last * float(self._units[2][-1])

    def _greatest_ball(self, solver: LpSolver) -> LpResult:
        G, h, _ = self._units
        reach = np.where(np.isfinite(self.high - self.low), _BEYOND, np.inf)
        rows = np.column_stack([G, np.ones(len(h))])
        low, high = np.append(-reach, -np.inf), np.append(reach, 1.0)
        return solver.maximise(np.append(np.zeros(self.n), 1.0), rows, h, low, high)

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

    def minimal(self, solver: LpSolver) -> Cell:
        """The same cell without rows that others imply.

        What a cell does not need, no part of it needs: dropping rows early saves their tests in all parts.
        """
        if self.is_minimal:
            return self
        G, h, _ = self._units
        inside = np.zeros((0, self.n)) if self.is_flat else self._spread(G, h)
        rows = list(irredundant_rows(G, h, inside[:_RAY_POINTS], solver))
        tags = tuple(self.tags[row] for row in rows)
        points = self.points if self.is_flat else self.frame.centre + self.frame.half * inside
        return Cell(
            self.frame, self.A[rows], self.b[rows], tags, self.low, self.high, points, self.is_flat, is_minimal=True
        )

    def _spread(self, G: Matrix, h: Vector) -> Matrix:
        """Known points in scaled coordinates; if they are few, with more on the way from the first one to each face."""
        points = (self.points - self.frame.centre) / self.frame.half
        if len(points) >= _RAY_POINTS or not len(h):
            return points
        with np.errstate(divide="ignore", invalid="ignore"):
            times = (h - G @ points[0])[:, None] / (G @ G.T)
        soonest = np.where(times > 0, times, np.inf).min(axis=0)
        bounded = np.isfinite(soonest)
        return np.vstack([points, points[0] + _ON_THE_WAY * soonest[bounded, None] * G[bounded]])


def _tightened(low: Vector, high: Vector, column: int, a: float, b: float) -> tuple[Vector, Vector]:
    """A box cut by ``a w_column <= b``."""
    low, high = low.copy(), high.copy()
    if a > 0:
        high[column] = min(high[column], b / a)
    else:
        low[column] = max(low[column], b / a)
    return low, high


Sides = tuple[Cell | None, Cell | None]
