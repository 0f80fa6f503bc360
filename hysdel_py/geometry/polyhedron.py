"""Polyhedra as the solutions of linear inequalities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.affine_hull import AffineHull, affine_hull
from hysdel_py.geometry.ball import LARGEST_RADIUS, Ball, greatest_ball
from hysdel_py.geometry.convex_hull import hull_rows, hull_volume
from hysdel_py.geometry.generators import Generators, few_generators_of, generators_of
from hysdel_py.geometry.lp import LpResult, maximise
from hysdel_py.geometry.mapping import mapped
from hysdel_py.geometry.precision import DEFAULT_PRECISION, Precision
from hysdel_py.geometry.projection import eliminate
from hysdel_py.geometry.redundancy import irredundant_rows
from hysdel_py.geometry.small_programs import are_small, greatest_values
from hysdel_py.geometry.solver import LpSolver

__all__ = ["Ball", "Polyhedron"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_EASY_VERTICES = 6
"""Up to this dimension a shadow is the hull of projected vertices."""

_ROUNDING = 1e-14
"""A sum this small relative to the sizes of its terms is zero."""

_DOUBTFUL = 1e-9
"""A shadow of a unit ray that is this short, but not zero, may be a ray or rounding."""


@dataclass(frozen=True, eq=False, repr=False)
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

    def __repr__(self) -> str:
        return f"<Polyhedron in {self.n} coordinates, {self.m} rows>"

    def __post_init__(self) -> None:
        A, b = np.array(self.A, dtype=float, order="C"), np.array(self.b, dtype=float)
        if A.ndim != 2 or b.shape != (A.shape[0],):
            raise ArgumentError(f"A has shape {A.shape} and b {b.shape}: (m, n) and (m,) were expected")
        if not _are_finite(A, b) and not (_are_finite(A) and not np.isnan(b).any()):
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

    @classmethod
    def hull(
        cls,
        points: ArrayLike,
        rays: ArrayLike = (),
        lines: ArrayLike = (),
        precision: Precision = DEFAULT_PRECISION,
    ) -> Polyhedron:
        """Convex hull of points, with rays and lines added to them, one per row; its rows have unit length.

        Raises
        ------
        ArgumentError
            If there is no point, or the widths differ.
        """
        corners = np.atleast_2d(np.asarray(points, dtype=float))
        if not corners.size:
            raise ArgumentError("a convex hull needs at least one point; for an empty set use Polyhedron.empty(n)")
        n = corners.shape[1]
        ways, axes = (np.array(part, dtype=float).reshape(-1, n) for part in (rays, lines))
        if not _are_finite(corners, ways, axes):
            raise ArgumentError("points, rays and lines must be finite numbers")
        return cls(*hull_rows(corners, ways, axes, precision), precision)

    @classmethod
    def empty(cls, n: int, precision: Precision = DEFAULT_PRECISION) -> Polyhedron:
        """The empty set in n dimensions."""
        return cls(np.zeros((1, n)), np.array([-1.0]), precision)

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
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", self.A, self.A)))

    def maximise(self, direction: ArrayLike) -> LpResult:
        """Support function: the greatest value of ``direction'w`` and where it is attained."""
        unbounded = np.full(self.n, np.inf)
        return maximise(direction, self.A, self.b, -unbounded, unbounded, precision=self.precision)

    @cached_property
    def ball(self) -> Ball:
        """A greatest inscribed ball; :attr:`relative_ball` is the one of a flat polyhedron in its own space."""
        return greatest_ball(self.A, self.b, self.precision)

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
        ends = self._greatest(np.vstack([eye, -eye]))
        if ends is not None:
            return -ends[self.n :], ends[: self.n]
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

    @cached_property
    def _unit(self) -> tuple[Matrix, Vector]:
        """Rows of unit length, without those that have no coefficients or no finite side."""
        real = (self.lengths > 0) & np.isfinite(self.b)
        if real.all():
            return self.A / self.lengths[:, None], self.b / self.lengths
        return self.A[real] / self.lengths[real, None], self.b[real] / self.lengths[real]

    def normalised(self) -> Polyhedron:
        """The same set with rows of unit length; rows without coefficients are dropped unless they can't be met."""
        if np.any(self.b[self.lengths == 0] < -self.precision.touch):
            return Polyhedron.empty(self.n, self.precision)
        return Polyhedron(*self._unit, self.precision)

    @cached_property
    def affine_hull(self) -> AffineHull:
        """Smallest affine space around the polyhedron, in terms of the rows of :meth:`normalised`.

        Raises
        ------
        ArgumentError
            If the polyhedron is empty.
        """
        if self.is_empty:
            raise ArgumentError("the polyhedron is empty: it has no affine hull; ask is_empty first")
        return affine_hull(*self._unit, self.ball.centre, self.ball.radius, self.precision)

    @property
    def dimension(self) -> int:
        """Dimension of the set: n for one with inner points, 0 for a point, -1 for an empty one."""
        return -1 if self.is_empty else self.affine_hull.dimension

    @cached_property
    def relative_ball(self) -> Ball:
        """A greatest ball within the affine hull; for an empty polyhedron :attr:`ball`."""
        if self.is_empty or self.dimension == self.n:
            return self.ball
        (A, b), hull = self._unit, self.affine_hull
        ball = greatest_ball(A[~hull.tight] @ hull.basis, (b - A @ hull.origin)[~hull.tight], self.precision)
        return Ball(hull.origin + hull.basis @ ball.centre, ball.radius)

    @property
    def _inside(self) -> Vector:
        """A point near some vertex, an inner one if there are any."""
        ball = self.ball
        return (ball if ball.radius < LARGEST_RADIUS else greatest_ball(self.A, self.b, self.precision, 1.0)).centre

    @cached_property
    def generators(self) -> Generators:
        """Vertices, extreme rays and lines, each in a fixed order.

        Raises
        ------
        ArgumentError
            If the scale of the polyhedron is too bad for the computation.
        """
        if self.is_empty:
            none = np.zeros((0, self.n))
            return Generators(none, none, none)
        few = few_generators_of(*self._unit, self._inside, self.precision)
        return generators_of(*self._unit, self.affine_hull) if few is None else few

    @property
    def is_bounded(self) -> bool:
        """Whether no coordinate grows without end; an empty polyhedron is bounded."""
        return self.is_empty or all(np.isfinite(end).all() for end in self.bounding_box)

    @property
    def vertices(self) -> Matrix:
        """Vertices of a bounded polyhedron, of shape (p, n).

        Raises
        ------
        ArgumentError
            If the polyhedron is unbounded: then :attr:`generators` has what there is.
        """
        found = self.generators
        if len(found.rays) or len(found.lines):
            raise ArgumentError("an unbounded polyhedron is more than its vertices: use generators")
        return found.points

    @cached_property
    def volume(self) -> float:
        """Volume: 0 for a flat polyhedron, infinity for an unbounded one with inner points."""
        if self.ball.radius <= self.precision.empty:
            return 0.0
        found = self.generators
        return float("inf") if len(found.rays) or len(found.lines) else hull_volume(found.points)

    def facet(self, row: int) -> Polyhedron:
        """The points at which a row holds with equality."""
        return self.with_rows(-self.A[[row]], -self.b[[row]])

    def section(self, values: Mapping[int, float]) -> Polyhedron:
        """The cut with some coordinates fixed, in the others, which keep their order."""
        fixed = [self._coordinate(i) for i in values]
        kept = [i for i in range(self.n) if i not in fixed]
        side = self.b - self.A[:, fixed] @ np.array([float(v) for v in values.values()])
        return Polyhedron(self.A[:, kept], side, self.precision)

    def project(self, coordinates: Sequence[int]) -> Polyhedron:
        """Shadow of the polyhedron in some coordinates, in the order given."""
        kept = [self._coordinate(i) for i in coordinates]
        if len(set(kept)) != len(kept):
            raise ArgumentError(f"each coordinate can be kept once; found {list(coordinates)}")
        if self.is_empty:
            return Polyhedron.empty(len(kept), self.precision)
        if len(kept) == self.n:
            return Polyhedron(self.A[:, kept], self.b, self.precision).minimal()
        shadow = self._shadow_of_generators(kept)
        if shadow is not None:
            return shadow
        gone = [i for i in range(self.n) if i not in kept]
        A, b = eliminate(*self._unit, self.affine_hull, gone, self.precision)
        return Polyhedron(A[:, np.argsort(np.argsort(kept))], b, self.precision).minimal()

    def _shadow_of_generators(self, kept: list[int]) -> Polyhedron | None:
        """The projection as the hull of projected vertices, where these are had cheaply; of one coordinate its ends."""
        if len(kept) == 1:
            eye = np.eye(self.n)[kept]
            found = self._greatest(np.vstack([eye, -eye]))
            return None if found is None else Polyhedron.box(-found[1:], found[:1], self.precision)
        if not kept or self.n > _EASY_VERTICES:
            return None
        try:
            whole = self.generators
            rays, lines = _shadow_of_ways(whole.rays[:, kept]), _shadow_of_ways(whole.lines[:, kept])
            if rays is None or lines is None:
                return None
            return Polyhedron.hull(whole.points[:, kept], rays, lines, self.precision)
        except ArgumentError:
            return None  # of a bad scale: coordinates are eliminated one after the other

    def _greatest(self, directions: Matrix) -> Vector | None:
        """Greatest values along directions, infinite where there is none; None if there are no points or doubts."""
        if not are_small(*self.A.shape):
            return None
        free = np.full(self.n, np.inf)
        found = greatest_values(directions, self.A, self.b, -free, free, tolerance=self.precision.lp)
        return found.values if found is not None and found.is_feasible else None

    def preimage(self, M: ArrayLike, t: ArrayLike = 0.0) -> Polyhedron:
        """``{v : M v + t is in the polyhedron}``."""
        matrix = np.asarray(M, dtype=float)
        A, size = self.A @ matrix, np.abs(self.A) @ np.abs(matrix)
        A[np.abs(A) <= _ROUNDING * size] = 0.0
        return Polyhedron(A, self.b - self.A @ (np.zeros(self.n) + np.asarray(t, dtype=float)), self.precision)

    def image(self, M: ArrayLike, t: ArrayLike = 0.0) -> Polyhedron:
        """``{M w + t : w in the polyhedron}``."""
        matrix = np.atleast_2d(np.asarray(M, dtype=float))
        if matrix.shape[1] != self.n:
            raise ArgumentError(f"M has shape {matrix.shape}: {self.n} columns were expected")
        offset = np.zeros(len(matrix)) + np.asarray(t, dtype=float)
        if self.is_empty:
            return Polyhedron.empty(len(matrix), self.precision)
        change = mapped(self.A, self.b, matrix)
        shadow = Polyhedron(change.A, change.b, self.precision).project(range(len(change.chosen)))
        rest = np.setdiff1d(np.arange(len(matrix)), change.chosen)
        link = np.eye(len(matrix))[rest]
        link[:, change.chosen] -= change.weights[rest]
        A = np.zeros((shadow.m, len(matrix)))
        A[:, change.chosen] = shadow.A
        rows = np.vstack([A, link, -link])
        sides = np.concatenate([shadow.b, np.zeros(2 * len(rest))])
        return Polyhedron(rows, sides + rows @ offset, self.precision)

    def _coordinate(self, i: int) -> int:
        if not 0 <= i < self.n:
            raise ArgumentError(f"coordinate {i} does not exist: they are numbered from 0 to {self.n - 1}")
        return int(i)


def _are_finite(*arrays: Matrix) -> bool:
    """Whether all entries are finite: one look at their sum, which is so only if they are, spares one at each."""
    return isfinite(sum(np.add.reduce(a, None) for a in arrays)) or all(np.isfinite(a).all() for a in arrays)


def _shadow_of_ways(ways: Matrix) -> Matrix | None:
    """Rays or lines of unit length in some coordinates, without those that vanish there; None if some are in doubt."""
    lengths = np.sqrt(np.einsum("ij,ij->i", ways, ways))
    real = lengths > _ROUNDING
    return None if np.any(lengths[real] < _DOUBTFUL) else np.asarray(ways[real])
