"""Linear programs with an answer that is checked.

``maximise c'w  subject to  A w <= b,  lb <= w <= ub``

Problems in few variables go to a dual simplex method (:mod:`hysdel_py.geometry.small_programs`), which needs some
microseconds where it is compiled; larger ones to PIQP; what they do not solve to the wanted precision, and what is very
large, to HiGHS. Every answer carries the bound that its multipliers prove: for any ``y >= 0``,
``c'w <= y'b + sum_j max((c - A'y)_j lb_j, (c - A'y)_j ub_j)`` (A. Neumaier and O. Shcherbina, "Safe bounds in linear
and mixed-integer linear programming", Mathematical Programming 99, 2004), with an allowance for rounding.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.geometry.precision import DEFAULT_PRECISION, Precision
from hysdel_py.geometry.small_programs import are_small, greatest_values
from hysdel_py.geometry.units import column_units

__all__ = ["Lp", "LpResult", "LpStatus", "is_proven_empty", "maximise", "proven_bound", "sharpened_bound"]

Vector = NDArray[np.float64]

DENSE_UP_TO = 20_000
"""Largest number of matrix entries that go to the dense solver."""

_ITERATIONS = 60
_MOST_EXCESS = 1e4  # of a row with a largest coefficient of 1; more is left unproven
_ACTIVE = 1e-7  # a row with a greater multiplier is active, a variable farther from its ends lies between them


class LpStatus(Enum):
    """What is known about a linear program."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    UNKNOWN = "unknown"


@dataclass(frozen=True, eq=False, slots=True)
class Lp:
    """``maximise c'w  subject to  A w <= b,  lb <= w <= ub``."""

    c: Vector
    A: Any
    b: Vector
    lb: Vector
    ub: Vector


@dataclass(frozen=True, eq=False, slots=True)
class LpResult:
    """Answer of a linear program.

    Attributes
    ----------
    status : LpStatus
    w : array of shape (n,)
        Where the value is attained; not finite without a solution.
    value : float
        ``c'w``; minus infinity if infeasible, infinity if unbounded.
    bound : float
        No feasible point has a greater value, proven by the multipliers; infinite where nothing is proven.
    y : array of shape (m,)
        Multipliers of the rows, not negative.
    """

    status: LpStatus
    w: Vector
    value: float
    bound: float
    y: Vector

    @property
    def is_optimal(self) -> bool:
        """Whether w is a solution."""
        return self.status is LpStatus.OPTIMAL


def maximise(
    c: ArrayLike,
    A: Any,
    b: ArrayLike,
    lb: ArrayLike,
    ub: ArrayLike,
    *,
    precision: Precision = DEFAULT_PRECISION,
    vertex: bool = False,
) -> LpResult:
    """Solve a linear program.

    Parameters
    ----------
    c : array_like of shape (n,)
    A : array or sparse array of shape (m, n)
    b : array_like of shape (m,)
        An infinite side is a row that never matters.
    lb, ub : array_like of shape (n,)
        May be infinite.
    vertex : bool
        Ask for a vertex, whose active rows hold to the last digits.
    """
    lp = Lp(np.asarray(c, dtype=float), A, *(np.asarray(side, dtype=float) for side in (b, lb, ub)))
    if np.any(lp.lb > lp.ub):
        return _nothing(lp, LpStatus.INFEASIBLE)
    if not len(lp.c):
        return _without_variables(lp)
    small = _with_simplex(lp, precision) if are_small(*A.shape) else None
    if small is not None and small.status is not LpStatus.INFEASIBLE:
        return small
    units = column_units(A)
    if np.any(units != 1.0):
        return _in_units(lp, units, precision, vertex=vertex)
    return _with_others(lp, precision, vertex=vertex) if small is None else small


def proven_bound(lp: Lp, y: Vector) -> float:
    """Upper bound of ``c'w`` over the feasible set, from any multipliers of the rows."""
    return _greatest(_prices(lp, y), lp.lb, lp.ub)


_Prices = tuple[Vector, Vector, float]


def _prices(lp: Lp, y: Vector) -> _Prices:
    """What is left of the costs of the variables, how far rounding may have moved it, and what the rows pay."""
    c, A, b = lp.c, lp.A, lp.b
    y = np.where((y > 0) & np.isfinite(b), y, 0.0)
    reduced = c - A.T @ y
    rounding = float(np.finfo(float).eps) * 2 * (len(b) + len(c) + 8)
    noise = rounding * (np.abs(c) + abs(A).T @ y)
    paid = y @ np.where(y > 0, b, 0.0)
    allowance = rounding * (y @ np.where(y > 0, np.abs(b), 0.0))
    return reduced, noise, float(paid + allowance)


def _greatest(prices: _Prices, lb: Vector, ub: Vector) -> float:
    """The bound for variables in given intervals."""
    reduced, noise, paid = prices
    return float(paid + _most(reduced, noise, lb, ub).sum())


def sharpened_bound(lp: Lp, found: LpResult) -> float:
    """The proven bound of an answer, made as good as the last digit where its active rows tell the multipliers.

    An interior-point method leaves a residual in the columns that are at none of their ends. The smallest change of the
    multipliers of active rows takes it out; the bound of the changed multipliers is proven like any other.
    """
    if not found.is_optimal:
        return found.bound
    active = np.flatnonzero(found.y > _ACTIVE * max(1.0, float(found.y.max(initial=0.0))))
    near = _ACTIVE * np.maximum(1.0, np.abs(found.w))
    inner = np.flatnonzero((found.w - lp.lb > near) & (lp.ub - found.w > near))
    rows = _dense(lp.A)[active]
    residual = lp.c[inner] - rows[:, inner].T @ found.y[active]
    change = np.linalg.lstsq(rows[:, inner].T, residual)[0] if active.size and inner.size else 0.0
    y = np.zeros(len(lp.b))
    y[active] = np.maximum(found.y[active] + change, 0.0)
    return min(found.bound, proven_bound(lp, y))


def is_proven_empty(lp: Lp, *, precision: Precision = DEFAULT_PRECISION) -> bool:
    """Whether no point satisfies the rows and ranges, by the multipliers of a program that may exceed the rows.

    The rows, brought to a largest coefficient of 1, may be exceeded by t; emptiness is proven by a lower bound of t.
    """
    if np.any(lp.lb > lp.ub):
        return True
    A = _dense(lp.A)
    size = np.abs(A).max(axis=1, initial=0.0)
    size[size == 0] = 1.0
    rows = np.column_stack([A / size[:, None], -np.ones(len(lp.b))])
    c = np.append(np.zeros(len(lp.c)), -1.0)
    ends = np.append(lp.lb, 0.0), np.append(lp.ub, _MOST_EXCESS)
    found = maximise(c, rows, lp.b / size, *ends, precision=precision)
    return found.is_optimal and -found.bound > precision.empty


def _most(reduced: Vector, noise: Vector, lb: Vector, ub: Vector) -> Vector:
    """Greatest value of each (reduced ± noise) w_j over its interval."""
    ends = [_times(reduced + s * noise, bound) for s in (-1.0, 1.0) for bound in (lb, ub)]
    return np.asarray(np.maximum.reduce(ends))


def _times(coefficient: Vector, bound: Vector) -> Vector:
    """Product in which zero times infinity is zero: the variable does not matter."""
    return np.asarray(coefficient * np.where(coefficient == 0, 0.0, bound))


def _dense(A: Any) -> NDArray[np.float64]:
    return np.ascontiguousarray(A.toarray() if hasattr(A, "toarray") else A, dtype=float)


def _with_simplex(lp: Lp, precision: Precision) -> LpResult | None:
    """Answer of the simplex method if it stands the check, else None."""
    found = greatest_values(lp.c[None], _dense(lp.A), lp.b, lp.lb, lp.ub, tolerance=precision.lp)
    if found is None:
        return None
    if not found.is_feasible:
        return _nothing(lp, LpStatus.INFEASIBLE)
    value = float(found.values[0])
    if value == np.inf:
        return _nothing(lp, LpStatus.UNBOUNDED)
    return LpResult(LpStatus.OPTIMAL, found.points[0], value, float(found.bounds[0]), found.multipliers[0])


def _with_piqp(lp: Lp, precision: Precision) -> LpResult | None:
    """Answer of PIQP if it stands the check, else None."""
    real = np.isfinite(lp.b)
    A = _dense(lp.A)[real]
    lengths = np.linalg.norm(A, axis=1)
    if np.any(lengths == 0):
        return None
    G, h = A / lengths[:, None], lp.b[real] / lengths
    w, multipliers = _piqp(Lp(lp.c, G, h, lp.lb, lp.ub), precision)
    if w is None or multipliers is None:
        return None
    w = np.clip(w, lp.lb, lp.ub)
    y = np.zeros(len(lp.b))
    y[real] = multipliers / lengths
    value = float(lp.c @ w)
    prices = _prices(lp, y)
    if _greatest(prices, *_near(lp, w)) - value > precision.lp * max(1.0, abs(value)):
        return None
    if np.any(G @ w - h > precision.lp * np.maximum(1.0, np.abs(h))):
        return None
    return LpResult(LpStatus.OPTIMAL, w, value, _greatest(prices, lp.lb, lp.ub), y)


def _near(lp: Lp, w: Vector) -> tuple[Vector, Vector]:
    """Ends of the variables, a missing one taken to lie near w."""
    low = np.where(np.isfinite(lp.lb), lp.lb, w - np.maximum(1.0, np.abs(w)))
    high = np.where(np.isfinite(lp.ub), lp.ub, w + np.maximum(1.0, np.abs(w)))
    return low, high


def _piqp(lp: Lp, precision: Precision) -> tuple[Vector | None, Vector | None]:
    import piqp

    solver = piqp.DenseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = 0.01 * precision.lp
    solver.settings.eps_duality_gap_abs = solver.settings.eps_duality_gap_rel = 0.1 * precision.lp
    solver.settings.max_iter = _ITERATIONS
    size, sides = len(lp.c), len(lp.b)
    rows = (lp.A, np.full(sides, -np.inf), lp.b) if sides else (None, None, None)
    try:
        solver.setup(np.zeros((size, size)), -lp.c, None, None, *rows, lp.lb, lp.ub)
        solver.solve()
    except (RuntimeError, ValueError):
        return None, None
    w = np.array(solver.result.x)
    y = np.array(solver.result.z_u) if sides else np.zeros(0)
    return (w, np.maximum(y, 0.0)) if np.isfinite(w).all() and np.isfinite(y).all() else (None, None)


def _with_highs(lp: Lp) -> LpResult:
    real = np.isfinite(lp.b)
    answer = _highs(lp, -lp.c, real)
    status = _HIGHS.get(answer.status, LpStatus.UNKNOWN)
    if status is LpStatus.INFEASIBLE and _highs(lp, np.zeros(len(lp.c)), real, presolve=False).status == 0:
        status = LpStatus.UNBOUNDED  # presolve calls some unbounded programs infeasible
    if status is not LpStatus.OPTIMAL:
        return _nothing(lp, status)
    y = np.zeros(len(lp.b))
    if real.any():
        y[real] = np.maximum(-answer.ineqlin.marginals, 0.0)
    w = np.asarray(answer.x, dtype=float)
    return LpResult(status, w, float(lp.c @ w), proven_bound(lp, y), y)


def _highs(lp: Lp, cost: Vector, real: NDArray[np.bool_], *, presolve: bool = True) -> Any:
    """Answer of HiGHS with the rows whose sides are finite."""
    from scipy.optimize import linprog

    tight = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10, "presolve": presolve}
    rows = (lp.A[real], lp.b[real]) if real.any() else (None, None)
    return linprog(cost, *rows, bounds=np.column_stack([lp.lb, lp.ub]), method="highs", options=tight)


def _in_units(lp: Lp, units: Vector, precision: Precision, *, vertex: bool) -> LpResult:
    """Solve a program in units of its variables."""
    scaled = Lp(lp.c / units, lp.A / units, lp.b, lp.lb * units, lp.ub * units)
    found = _with_simplex(scaled, precision) if are_small(*lp.A.shape) else None
    found = _with_others(scaled, precision, vertex=vertex) if found is None else found
    return replace(found, w=found.w / units)


def _with_others(lp: Lp, precision: Precision, *, vertex: bool) -> LpResult:
    """Answer of PIQP, and of HiGHS where that does not stand the check."""
    dense = not vertex and lp.A.shape[0] * lp.A.shape[1] <= DENSE_UP_TO
    answer = _with_piqp(lp, precision) if dense else None
    return _with_highs(lp) if answer is None else answer


_HIGHS = {0: LpStatus.OPTIMAL, 2: LpStatus.INFEASIBLE, 3: LpStatus.UNBOUNDED}
"""Codes of scipy.optimize.linprog."""


def _without_variables(lp: Lp) -> LpResult:
    if np.all(lp.b >= 0):
        return LpResult(LpStatus.OPTIMAL, lp.c, 0.0, 0.0, np.zeros(len(lp.b)))
    return _nothing(lp, LpStatus.INFEASIBLE)


def _nothing(lp: Lp, status: LpStatus) -> LpResult:
    value = {LpStatus.INFEASIBLE: -np.inf, LpStatus.UNBOUNDED: np.inf}.get(status, np.nan)
    bound = -np.inf if status is LpStatus.INFEASIBLE else np.inf
    return LpResult(status, np.full(len(lp.c), np.nan), value, bound, np.zeros(len(lp.b)))
