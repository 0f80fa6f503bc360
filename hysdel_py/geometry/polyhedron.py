"""Polyhedra as the solutions of linear inequalities."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.lp import LpResult, maximise
from hysdel_py.geometry.precision import DEFAULT_PRECISION, Precision

__all__ = ["Ball", "Polyhedron"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_LARGEST_RADIUS = 1e6
"""Radius at which the search for an inscribed ball stops in a polyhedron that holds balls of any size."""


@dataclass(frozen=True, eq=False, slots=True)
class Ball:
    """A greatest ball inside a polyhedron.

    Attributes
    ----------
    centre : array of shape (n,)
    radius : float
        Zero for a flat polyhedron; negative for an empty one: by how much all rows must move outwards to let a point
        in.
    """

    centre: Vector
    radius: float


@dataclass(frozen=True, eq=False)
class Polyhedron:
    """``{w : A w <= b}``; both arrays are read-only.

    Attributes
    ----------
    A : array of shape (m, n)
    b : array of shape (m,)
    precision : Precision
    """

    A: Matrix
    b: Vector
    precision: Precision = DEFAULT_PRECISION

    def __post_init__(self) -> None:
        A, b = np.array(self.A, dtype=float), np.array(self.b, dtype=float)
        if A.ndim != 2 or b.shape != (A.shape[0],):
            raise ArgumentError(f"A has shape {A.shape} and b {b.shape}: (m, n) and (m,) were expected")
        if not np.isfinite(A).all() or np.isnan(b).any():
            raise ArgumentError("A and b must be numbers, and A finite")
        for name, array in (("A", A), ("b", b)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @classmethod
    def box(cls, low: ArrayLike, high: ArrayLike, precision: Precision = DEFAULT_PRECISION) -> Polyhedron:
        """``low <= w <= high``; infinite ends give no row."""
        lb, ub = np.atleast_1d(np.asarray(low, dtype=float)), np.atleast_1d(np.asarray(high, dtype=float))
        eye = np.eye(len(lb))
        A, b = np.vstack([eye, -eye]), np.concatenate([ub, -lb])
        real = np.isfinite(b)
        return cls(A[real], b[real], precision)

    @property
    def n(self) -> int:
        """Dimension of the space."""
        return int(self.A.shape[1])

    @property
    def m(self) -> int:
        """Number of rows."""
        return len(self.b)

    def with_rows(self, A: ArrayLike, b: ArrayLike) -> Polyhedron:
        """The points that satisfy further rows as well."""
        more = np.asarray(A, dtype=float).reshape(-1, self.n)
        return Polyhedron(
            np.vstack([self.A, more]), np.concatenate([self.b, np.atleast_1d(np.asarray(b, float))]), self.precision
        )

    def __and__(self, other: Polyhedron) -> Polyhedron:
        return self.with_rows(other.A, other.b)

    def slack(self, w: ArrayLike) -> Vector:
        """``b - A w``: negative where a row is violated."""
        return np.asarray(self.b - self.A @ np.asarray(w, dtype=float))

    def contains(self, w: ArrayLike, tolerance: float = 0.0) -> bool:
        """Whether every row holds up to a tolerance, relative to 1 and the sizes of its terms."""
        point = np.asarray(w, dtype=float)
        size = np.maximum(1.0, np.abs(self.b) + np.abs(self.A) @ np.abs(point))
        return bool(np.all(self.slack(point) >= -tolerance * size))

    @cached_property
    def lengths(self) -> Vector:
        """Euclidean lengths of the normals."""
        return np.asarray(np.linalg.norm(self.A, axis=1))

    def maximise(self, direction: ArrayLike) -> LpResult:
        """Support function: the greatest value of ``direction'w`` and where it is attained."""
        unbounded = np.full(self.n, np.inf)
        return maximise(direction, self.A, self.b, -unbounded, unbounded, precision=self.precision)

    @cached_property
    def ball(self) -> Ball:
        """A greatest inscribed ball (Boyd and Vandenberghe, "Convex optimization", 2004, section 8.5.1)."""
        flat_rows = self.lengths == 0
        least = float(np.min(self.b[flat_rows], initial=np.inf))
        if least < 0:
            return Ball(np.zeros(self.n), -_LARGEST_RADIUS)
        G, h, lengths = self.A[~flat_rows], self.b[~flat_rows], self.lengths[~flat_rows]
        if not len(h) or not self.n:
            return Ball(np.zeros(self.n), _LARGEST_RADIUS)
        rows = np.column_stack([G / lengths[:, None], np.ones(len(h))])
        bound = np.append(np.full(self.n, np.inf), _LARGEST_RADIUS)
        answer = maximise(np.append(np.zeros(self.n), 1.0), rows, h / lengths, -bound, bound, precision=self.precision)
        return Ball(answer.w[:-1], float(answer.w[-1])) if answer.is_optimal else Ball(np.zeros(self.n), -np.inf)

    @property
    def is_empty(self) -> bool:
        """Whether no point satisfies all rows."""
        return self.ball.radius < -self.precision.empty

    @property
    def is_flat(self) -> bool:
        """Whether there are points but no inner ones."""
        return abs(self.ball.radius) <= self.precision.empty

    @cached_property
    def bounding_box(self) -> tuple[Vector, Vector]:
        """Least and greatest value of each coordinate; infinite where there is none."""
        eye = np.eye(self.n)
        low = np.array([-self.maximise(-row).value for row in eye])
        return low, np.array([self.maximise(row).value for row in eye])

    def irredundant_rows(self) -> tuple[int, ...]:
        """Rows without which the polyhedron would be larger, in their order; of equal rows the first.

        A row is redundant when it is not exceeded without it (one linear program for each row that rays from the
        centre do not hit first).
        """
        keep = _distinct_rows(self)
        needed = _hit_by_rays(self, keep)
        for row in [r for r in keep if r not in needed]:
            others = [r for r in keep if r != row]
            if self._exceeds(row, others):
                needed.add(row)
            else:
                keep = others
        return tuple(sorted(needed))

    def _exceeds(self, row: int, others: list[int]) -> bool:
        """Whether a row cuts something off that the others allow."""
        length = self.lengths[row]
        A = np.vstack([self.A[others], self.A[row]])
        b = np.append(self.b[others], self.b[row] + length)  # moved outwards, so that the program stays bounded
        free = np.full(self.n, np.inf)
        answer = maximise(self.A[row], A, b, -free, free, precision=self.precision)
        return not answer.is_optimal or answer.value > self.b[row] + self.precision.redundant * length

    def minimal(self) -> Polyhedron:
        """The same set with irredundant rows only."""
        rows = list(self.irredundant_rows())
        return Polyhedron(self.A[rows], self.b[rows], self.precision)


def _distinct_rows(polyhedron: Polyhedron) -> list[int]:
    """Rows that matter at all: of parallel rows the tightest, the first of equal ones."""
    best: dict[tuple[float, ...], int] = {}
    for row in range(polyhedron.m):
        length = polyhedron.lengths[row]
        if length == 0 or not np.isfinite(polyhedron.b[row]):
            continue
        key = tuple(np.round(polyhedron.A[row] / length, 12) + 0.0)
        rival = best.get(key)
        side = polyhedron.b[row] / length
        if rival is None or side < polyhedron.b[rival] / polyhedron.lengths[rival] - 1e-15 * abs(side):
            best[key] = row
    return sorted(best.values())


def _hit_by_rays(polyhedron: Polyhedron, rows: list[int]) -> set[int]:
    """Rows that a ray from the centre along some row's normal meets first, and no other row nearly as soon."""
    ball = polyhedron.ball
    if ball.radius <= polyhedron.precision.empty or not rows:
        return set()
    G = polyhedron.A[rows] / polyhedron.lengths[rows, None]
    distance = polyhedron.b[rows] / polyhedron.lengths[rows] - G @ ball.centre
    speed = G @ G.T
    with np.errstate(divide="ignore"):
        times = np.where(speed > 0, distance[:, None] / np.where(speed > 0, speed, 1.0), np.inf)
    order = np.sort(times, axis=0)
    first = np.argmin(times, axis=0)
    clear = order[1] > order[0] * (1 + 1e-6) if len(rows) > 1 else np.ones(1, dtype=bool)
    return {rows[f] for f, ok in zip(first, clear, strict=True) if ok}
