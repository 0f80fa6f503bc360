"""The problem, its answer, and the one residual that judges every method.

::

    w = M z + q,    lo <= z <= hi,    and for each i    w_i >= 0 where z_i = lo_i,
                                                        w_i <= 0 where z_i = hi_i,
                                                        w_i = 0 in between

With ``lo = 0`` and ``hi`` infinite this is the linear complementarity problem ``w, z >= 0, z'w = 0``. Dry friction is
the other case that matters: z holds the impulses, w the relative velocities, and the bounds are the friction limits.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.kernels.lcp import equilibrate
from hysdel_py.optimize.lcp.checks import bound_of, matrix_of, vector_of

__all__ = ["Lcp", "LcpResult", "LcpSettings", "LcpStatus", "natural_residual", "residual", "states_of"]

Vector = NDArray[np.float64]
States = NDArray[np.int8]


ROUNDS = 8
"""Rounds of scaling; each takes the square root of what is missing."""


class LcpStatus(Enum):
    """What is known about a problem after a method has worked on it.

    ``NO_SOLUTION`` is proven: either by a vector ``y >= 0`` with ``M'y <= 0`` and ``q'y < 0``, which forbids
    ``M z + q >= 0``, or because every mode was tried. ``RAY`` is weaker: Lemke's path went to infinity. For a matrix
    that is copositive plus, which every positive semidefinite one is, a ray means that there is no solution; for other
    matrices it means only that this path found none.
    """

    SOLVED = "solved"
    NO_SOLUTION = "no solution"
    RAY = "ray termination"
    ITERATION_LIMIT = "iteration limit"
    SINGULAR = "singular"
    NUMERICAL = "numerical trouble"


@dataclass(frozen=True, slots=True)
class LcpSettings:
    """Accuracy and effort; all tolerances refer to the scaled problem, whose data are of size one.

    Attributes
    ----------
    tolerance : float
        A point with a residual up to this is a solution.
    pivot : float
        Entries of the tableau below this are rounding.
    singular : float
        Least ratio of singular values of a block that counts as regular.
    pivots : int or None
        Most pivots of Lemke's method; None stands for 50 + 20 n.
    sweeps : int
        Most sweeps of the projected Gauss-Seidel method.
    newton_steps : int
        Most steps of the semi-smooth Newton method, and as many of its fallback.
    modes : int
        Most modes that are enumerated.
    """

    tolerance: float = 1e-9
    pivot: float = 1e-11
    singular: float = 1e-11
    pivots: int | None = None
    sweeps: int = 20_000
    newton_steps: int = 200
    modes: int = 200_000

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value: Any = getattr(self, name)
            given = value is not None or name != "pivots"
            if given and not (isinstance(value, Real) and float(value) > 0):
                raise ArgumentError(f"{name} is {value!r}: a positive number was expected")


@dataclass(frozen=True, eq=False, slots=True)
class LcpResult:
    """Answer of a method.

    Attributes
    ----------
    z, w : arrays of shape (n,)
        The solution where the status is SOLVED, else the last point that the method reached.
    status : LcpStatus
    residual : float
        See :func:`residual`; computed from z for every method alike.
    iterations : int
        Modes, pivots, sweeps or Newton steps, as the method counts.
    mode : array of int8, shape (n,)
        -1 where z is at its lower bound, 0 in between (w is zero), 1 at its upper bound.
    method : str
        The method that gave the answer.
    message : str
        The outcome in words.
    """

    z: Vector
    w: Vector
    status: LcpStatus
    residual: float
    iterations: int
    mode: States
    method: str
    message: str

    @property
    def solved(self) -> bool:
        """Whether z is a solution."""
        return self.status is LcpStatus.SOLVED


@dataclass(frozen=True, eq=False)
class Lcp:
    """A problem with bounds, and the same problem in units in which its data are of size one.

    Rows and columns of M are multiplied by one positive vector d until the largest entry of each is 1 (D. Ruiz, "A
    scaling algorithm to equilibrate both rows and columns norms in matrices", 2001), which keeps symmetry and signs.
    Then lengths are divided by the largest entry of q and of the bounds that exclude zero. So no tolerance depends on
    units.

    Attributes
    ----------
    M : array of shape (n, n), or sparse array in compressed rows
    q, lo, hi : arrays of shape (n,)
    """

    M: Any
    q: Vector
    lo: Vector
    hi: Vector

    def __post_init__(self) -> None:
        q = vector_of(self.q, "q")
        n = len(q)
        M = matrix_of(self.M, n)
        bounds = {name: bound_of(getattr(self, name), n, name) for name in ("lo", "hi")}
        for name, value in ({"M": M, "q": q} | bounds).items():
            object.__setattr__(self, name, value)
        _require_order(self.lo, self.hi)

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return len(self.q)

    @property
    def is_sparse(self) -> bool:
        """Whether M came as a sparse matrix."""
        return not isinstance(self.M, np.ndarray)

    @cached_property
    def d(self) -> Vector:
        """Scale of rows and columns."""
        return _equilibration(self.M)

    def with_vectors(self, q: ArrayLike, lo: ArrayLike | None = None, hi: ArrayLike | None = None) -> Lcp:
        """The problem with other vectors; the matrix, its scale and the solvers' data for it are shared."""
        q = vector_of(q, "q")
        if len(q) != self.n:
            raise ArgumentError(f"q has {len(q)} entries: {self.n} were expected, as M has {self.n} rows")
        low = self.lo if lo is None else bound_of(lo, self.n, "lo")
        high = self.hi if hi is None else bound_of(hi, self.n, "hi")
        _require_order(low, high)
        return _assembled(self.M, q, low, high, d=self.d, scaled_matrix=self.scaled_matrix)

    @cached_property
    def scaled_matrix(self) -> Any:
        """M with its rows and columns multiplied by d."""
        d = self.d
        return self.M.multiply(d[:, None]).multiply(d).tocsr() if self.is_sparse else d[:, None] * self.M * d

    @cached_property
    def scaled(self) -> Lcp:
        """The problem over ``z / (d size)``."""
        unit = self.d * self.size
        return _assembled(self.scaled_matrix, self.q * self.d / self.size, self.lo / unit, self.hi / unit)

    @cached_property
    def size(self) -> float:
        """Largest entry of the scaled q and of the point of the bounds nearest to zero.

        Other bounds count only where these are all zero, which makes zero a solution: a large bound that stands for
        none would make every residual look small.
        """
        anchor = np.clip(0.0, self.lo, self.hi)
        bounds = np.concatenate([self.lo / self.d, self.hi / self.d])
        return _largest(np.concatenate([self.q * self.d, anchor / self.d])) or _largest(bounds) or 1.0

    @cached_property
    def is_symmetric(self) -> bool:
        """Whether M equals its transpose up to rounding."""
        difference = abs(self.M - self.M.T)
        return not self.n or bool(difference.max() <= 1e-12 * abs(self.M).max())

    @cached_property
    def dense(self) -> Vector:
        """M as an array."""
        return np.ascontiguousarray(self.M.toarray() if self.is_sparse else self.M)

    @property
    def is_one_sided(self) -> bool:
        """Whether this is a linear complementarity problem proper: all lower bounds finite, no upper ones."""
        return bool(np.isfinite(self.lo).all() and np.isposinf(self.hi).all())


def residual(problem: Lcp, z: Vector) -> float:
    """How far z is from a solution: the natural residual of the scaled problem.

    ``max_i |z_i - median(lo_i, z_i - w_i, hi_i)|`` in scaled units; zero exactly at the solutions, and without a unit.
    """
    if not np.isfinite(z).all():
        return float("inf")
    scaled, x = problem.scaled, z / (problem.d * problem.size)
    return natural_residual(scaled, x, scaled.M @ x + scaled.q)


def natural_residual(problem: Lcp, z: Vector, w: Vector) -> float:
    """Largest entry of ``z - median(lo, z - w, hi)``."""
    return float(np.abs(z - np.clip(z - w, problem.lo, problem.hi)).max(initial=0.0))


def states_of(problem: Lcp, z: Vector, w: Vector) -> States:
    """Where z lies between its bounds, by the sign of ``z - w`` against them."""
    trial = z - w
    return np.where(trial <= problem.lo, -1, np.where(trial >= problem.hi, 1, 0)).astype(np.int8)


def _assembled(M: Any, q: Vector, lo: Vector, hi: Vector, **known: Any) -> Lcp:
    """A problem from parts that are already checked, with what is known of it."""
    problem = object.__new__(Lcp)
    for name, value in ({"M": M, "q": q, "lo": lo, "hi": hi} | known).items():
        object.__setattr__(problem, name, value)
    return problem


def _largest(values: Vector) -> float:
    """Greatest size among the finite entries."""
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


def _require_order(lo: Vector, hi: Vector) -> None:
    if (lo > hi).any():
        i = int(np.argmax(lo > hi))
        raise ArgumentError(f"lo[{i}] = {lo[i]:g} lies above hi[{i}] = {hi[i]:g}")


def _equilibration(M: Any) -> Vector:
    if isinstance(M, np.ndarray):
        return np.asarray(equilibrate(M, ROUNDS))
    rows, d = np.repeat(np.arange(M.shape[0]), np.diff(M.indptr)), np.ones(M.shape[0])
    for _ in range(ROUNDS):
        size, largest = np.abs(M.data) * d[rows] * d[M.indices], np.zeros(len(d))
        np.maximum.at(largest, rows, size)
        np.maximum.at(largest, M.indices, size)
        d /= np.sqrt(np.where(largest > 0, largest, 1.0))
    return d
