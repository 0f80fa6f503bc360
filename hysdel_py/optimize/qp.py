"""The canonical convex quadratic program and the answer to it.

::

    min  1/2 x'P x + q'x + constant    subject to   l <= A x <= u,   lb <= x <= ub

An equality is a row with ``l == u``, a missing side is infinite. Multipliers follow the convention of a two-sided row:
positive where the upper side holds the solution back, negative where the lower one does, so that a solution has
``P x + q + A'y + z = 0``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError

__all__ = [
    "Qp",
    "QpResult",
    "QpSettings",
    "QpStatus",
    "Residuals",
    "is_convex",
    "objective_value",
    "residuals",
    "violation",
]

Vector = NDArray[np.float64]


class QpStatus(Enum):
    """What is known about a quadratic program after a solver has worked on it."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    ITERATION_LIMIT = "iteration limit"
    NUMERICAL = "numerical trouble"


@dataclass(frozen=True, slots=True)
class QpSettings:
    """What is asked of a back end and what is accepted from it.

    Attributes
    ----------
    accuracy : float or None
        Absolute and relative accuracy handed to the solver; None takes the back end's own default.
    iterations : int or None
        Largest number of iterations; None takes the back end's own default.
    feasibility, stationarity : float
        An answer is called optimal only if its residuals, computed here, stay below these. Both are relative: to the
        largest of 1 and the sides of the rows, and to the largest of 1 and the terms of the gradient.
    """

    accuracy: float | None = None
    iterations: int | None = None
    feasibility: float = 1e-6
    stationarity: float = 1e-6

    def __post_init__(self) -> None:
        for name in ("accuracy", "iterations", "feasibility", "stationarity"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise ArgumentError(f"{name} is {value}: a positive number was expected")


@dataclass(frozen=True, eq=False)
class Qp:
    """A quadratic program; the arrays are checked once and never written to.

    Attributes
    ----------
    P : sparse array of shape (n, n), or array_like
        Symmetric Hessian; stored in compressed columns. That it is positive semidefinite is the caller's promise,
        which :func:`is_convex` checks.
    q : array of shape (n,)
    A : sparse array of shape (m, n), or array_like
        Stored in compressed columns.
    l, u : arrays of shape (m,)
        Sides of the rows. ``l > u`` is an infeasible problem, not an error.
    lb, ub : arrays of shape (n,)
        Bounds of the variables.
    constant : float
        Added to the objective.

    Raises
    ------
    ArgumentError
        A wrong shape, a NaN, an infinite cost, or a Hessian that is not symmetric.
    """

    P: Any
    q: Vector
    A: Any
    l: Vector  # noqa: E741 - the name of the canonical form
    u: Vector
    lb: Vector
    ub: Vector
    constant: float = 0.0
    _size: tuple[int, int] = field(init=False, repr=False, default=(0, 0))
    _transposed: Any = field(init=False, repr=False, default=None)

    def __post_init__(self) -> None:
        q = _vector(self.q, None, "q")
        P, A = _sparse(self.P, "P"), _sparse(self.A, "A")
        n, m = len(q), A.shape[0]
        if P.shape != (n, n):
            raise ArgumentError(f"P has shape {P.shape}: {(n, n)} was expected, as q has {n} entries")
        if A.shape[1] != n:
            raise ArgumentError(f"A has {A.shape[1]} columns: {n} were expected, as q has {n} entries")
        _require_symmetric(P)
        if not np.isfinite(self.constant):
            raise ArgumentError(f"constant is {self.constant}: a finite number was expected")
        values = {
            "P": P,
            "q": _finite(q, "q"),
            "A": A,
            "_size": (n, m),
            "_transposed": A.T.tocsr(),
            "constant": float(self.constant),
        }
        values |= {name: _vector(getattr(self, name), m, name) for name in ("l", "u")}
        values |= {name: _vector(getattr(self, name), n, name) for name in ("lb", "ub")}
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def n(self) -> int:
        """Number of variables."""
        return self._size[0]

    @property
    def At(self) -> Any:
        """A transposed, in compressed rows."""
        return self._transposed

    @property
    def m(self) -> int:
        """Number of rows."""
        return self._size[1]

    def with_vectors(
        self,
        q: ArrayLike | None = None,
        *,
        l: ArrayLike | None = None,  # noqa: E741
        u: ArrayLike | None = None,
        lb: ArrayLike | None = None,
        ub: ArrayLike | None = None,
        constant: float | None = None,
    ) -> Qp:
        """Return the program with some vectors replaced; the matrices are shared and not checked again."""
        sizes = {"q": self.n, "l": self.m, "u": self.m, "lb": self.n, "ub": self.n}
        given = {"q": q, "l": l, "u": u, "lb": lb, "ub": ub}
        twin = object.__new__(Qp)
        for name in ("P", "A", "_size", "_transposed"):
            object.__setattr__(twin, name, getattr(self, name))
        for name, value in given.items():
            own = getattr(self, name)
            vector = own if value is None or value is own else _vector(value, sizes[name], name)
            object.__setattr__(twin, name, vector)
        if q is not None:
            _finite(twin.q, "q")
        object.__setattr__(twin, "constant", self.constant if constant is None else float(constant))
        return twin


@dataclass(frozen=True, slots=True)
class Residuals:
    """How far a triple (x, y, z) is from the conditions of Karush, Kuhn and Tucker; all absolute, infinity norm.

    Attributes
    ----------
    primal : float
        Largest violation of a row or bound.
    dual : float
        Largest entry of ``P x + q + A'y + z``.
    relative_primal, relative_dual : float
        The same relative to the size of the sides and of the terms of the gradient, at least 1.
    """

    primal: float
    dual: float
    relative_primal: float
    relative_dual: float


@dataclass(frozen=True, eq=False, slots=True)
class QpResult:
    """Answer of a back end; the residuals are computed from x, y, z and never taken from the solver.

    Attributes
    ----------
    status : QpStatus
    x : array of shape (n,)
        Solution, or the last iterate.
    y : array of shape (m,)
        Multipliers of the rows, positive at the upper side. With INFEASIBLE: a candidate ray of Farkas.
    z : array of shape (n,)
        Multipliers of the bounds, of the same sign convention.
    objective : float
        Value at x, with the constant.
    primal_residual, dual_residual : float
        Absolute, infinity norm.
    iterations : int
    seconds : float
        Wall-clock time of the solver with the update of its data.
    message : str
        The solver's own word and what was found when checking it.
    """

    status: QpStatus
    x: Vector
    y: Vector
    z: Vector
    objective: float
    primal_residual: float
    dual_residual: float
    iterations: int
    seconds: float
    message: str


def objective_value(qp: Qp, x: Vector) -> float:
    """Value of the objective at x, with the constant."""
    return float(0.5 * (x @ (qp.P @ x)) + qp.q @ x + qp.constant)


def violation(qp: Qp, x: Vector) -> float:
    """Largest violation of a row or bound at x, each relative to the size of its side and at least absolute."""
    rows = _excess(qp.A @ x, qp.l, qp.u)
    bounds = _excess(x, qp.lb, qp.ub)
    return max(_largest(rows / _scale(qp.l, qp.u)), _largest(bounds / _scale(qp.lb, qp.ub)))


def residuals(qp: Qp, x: Vector, y: Vector, z: Vector) -> Residuals:
    """Distance of (x, y, z) from optimality, as numbers that any reader can recompute."""
    rows = qp.A @ x
    Px, Ay = qp.P @ x, qp.At @ y
    primal = max(_largest(_excess(rows, qp.l, qp.u)), _largest(_excess(x, qp.lb, qp.ub)))
    dual = _largest(np.abs(Px + qp.q + Ay + z))
    rows_scale = max(1.0, _largest(np.abs(rows)), _largest(np.abs(x)))
    dual_scale = max(1.0, *(_largest(np.abs(term)) for term in (Px, qp.q, Ay, z)))
    return Residuals(primal, dual, primal / rows_scale, dual / dual_scale)


def is_convex(qp: Qp, tolerance: float = 1e-9) -> bool:
    """Whether P is positive semidefinite: its least eigenvalue is at least ``-tolerance`` times its largest entry."""
    if qp.n == 0 or qp.P.nnz == 0:
        return True
    dense = qp.P.toarray()
    return bool(np.linalg.eigvalsh(dense)[0] >= -tolerance * np.abs(dense).max())


def _excess(value: Vector, low: Vector, high: Vector) -> Vector:
    return np.maximum(np.maximum(low - value, value - high), 0.0)


def _scale(low: Vector, high: Vector) -> Vector:
    sizes = np.minimum(np.abs(low), np.abs(high))
    return 1.0 + np.where(np.isfinite(sizes), sizes, 0.0)


def _largest(values: Vector) -> float:
    return float(values.max()) if values.size else 0.0


def _vector(value: ArrayLike, size: int | None, name: str) -> Vector:
    vector = np.asarray(value, dtype=float)
    if vector.ndim != 1 or (size is not None and vector.shape[0] != size):
        expected = "one dimension" if size is None else f"shape {(size,)}"
        raise ArgumentError(f"{name} has shape {vector.shape}: {expected} was expected")
    if np.isnan(vector).any():
        raise ArgumentError(f"{name}[{int(np.isnan(vector).argmax())}] is not a number")
    return vector


def _finite(vector: Vector, name: str) -> Vector:
    if not np.isfinite(vector).all():
        raise ArgumentError(f"{name} has an infinite entry: finite numbers were expected")
    return vector


def _sparse(value: Any, name: str) -> Any:
    from scipy.sparse import csc_array

    try:
        matrix = csc_array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{name} must be a matrix of numbers: {error}") from None
    if matrix.ndim != 2:
        raise ArgumentError(f"{name} has {matrix.ndim} dimension: a matrix was expected")
    if not np.isfinite(matrix.data).all():
        raise ArgumentError(f"{name} has an entry that is not finite")
    matrix.sum_duplicates()
    return matrix


def _require_symmetric(P: Any, tolerance: float = 1e-12) -> None:
    if P.nnz and abs(P - P.T).max() > tolerance * max(1.0, abs(P).max()):
        raise ArgumentError("P is not symmetric: pass (P + P')/2, the objective stays the same")
