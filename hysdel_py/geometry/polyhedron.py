"""Polyhedra as the solutions of linear inequalities."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.lp import LpResult, LpStatus, maximise
from hysdel_py.geometry.precision import DEFAULT_PRECISION, Precision
from hysdel_py.geometry.redundancy import irredundant_rows
from hysdel_py.geometry.solver import LpSolver

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
        answer = _largest(rows, h / lengths, np.inf, self.precision)
        if answer.status is LpStatus.UNBOUNDED:
            answer = _largest(rows, h / lengths, _LARGEST_RADIUS, self.precision)
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
        """Rows without which the polyhedron would be larger, in their order; of equal rows the first."""
        ball = self.ball
        inside = ball.centre[None] if ball.radius > self.precision.empty else np.zeros((0, self.n))
        return irredundant_rows(self.A, self.b, inside, LpSolver(self.precision))

    def minimal(self) -> Polyhedron:
        """The same set with irredundant rows only."""
        rows = list(self.irredundant_rows())
        return Polyhedron(self.A[rows], self.b[rows], self.precision)


def _largest(rows: Matrix, sides: Vector, radius: float, precision: Precision) -> LpResult:
    """Centre and radius of a greatest ball whose radius is bounded."""
    free = np.append(np.full(rows.shape[1] - 1, np.inf), radius)
    return maximise(np.append(np.zeros(len(free) - 1), 1.0), rows, sides, -free, free, precision=precision)
