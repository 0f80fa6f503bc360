"""Independent linear programs (HiGHS through scipy) that settle what a QP solver could not.

:func:`elastic_phase_one` finds the least total violation of the rows; its multipliers are a candidate ray of Farkas.
:func:`recession_direction` looks for a direction in which the objective falls for ever.
Both give candidates only: the caller checks a ray with :func:`hysdel_py.optimize.certificate.farkas_bound`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.qp import Qp

__all__ = ["PhaseOne", "elastic_phase_one", "recession_direction"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class PhaseOne:
    """Answer of the elastic problem.

    Attributes
    ----------
    x : array of shape (n,)
        A point within the bounds that violates the rows least.
    y : array of shape (m,)
        Multipliers of the rows, between -1 and 1, positive at the upper side.
    violation : float
        Sum of the violations at x.
    """

    x: Vector
    y: Vector
    violation: float


def elastic_phase_one(qp: Qp) -> PhaseOne | None:
    """Minimise the sum of row violations within the bounds; None without an answer or with crossed bounds."""
    from scipy.sparse import eye_array, hstack

    if qp.n == 0 or np.any(qp.lb > qp.ub):
        return None
    rows, side, upper, lower = _one_sided(qp)
    if not len(side):
        return PhaseOne(np.clip(0.0, qp.lb, qp.ub), np.zeros(qp.m), 0.0)
    cost = np.concatenate([np.zeros(qp.n), np.ones(len(side))])
    low = np.concatenate([qp.lb, np.zeros(len(side))])
    high = np.concatenate([qp.ub, np.full(len(side), np.inf)])
    answer = _linprog(cost, hstack([rows, -eye_array(len(side))], format="csc"), side, low, high)
    if answer is None:
        return None
    y = np.zeros(qp.m)
    weights = -answer.ineqlin.marginals
    y[upper] += weights[: len(upper)]
    y[lower] -= weights[len(upper) :]
    return PhaseOne(answer.x[: qp.n], y, float(answer.fun))


def recession_direction(qp: Qp, tolerance: float = 1e-9) -> Vector | None:
    """A direction d, entries at most 1, with ``P d = 0``, ``q'd < 0`` along which no row and no bound is ever met.

    Together with a feasible point it proves that the problem is unbounded. None if there is no such direction.
    """
    from scipy.sparse import csr_array, vstack

    rows, _, _, _ = _one_sided(qp)
    P = csr_array(qp.P)
    A = vstack([rows, P, -P], format="csc")
    low, high = np.where(np.isfinite(qp.lb), 0.0, -1.0), np.where(np.isfinite(qp.ub), 0.0, 1.0)
    answer = _linprog(qp.q, A, np.zeros(A.shape[0]), low, high)
    if answer is None or answer.fun >= -tolerance * max(1.0, float(np.abs(qp.q).max())):
        return None
    return np.asarray(answer.x)


def _one_sided(qp: Qp) -> tuple[Any, Vector, NDArray[np.intp], NDArray[np.intp]]:
    """Rows as ``R w <= side``: first the finite upper sides, then the negated finite lower ones."""
    from scipy.sparse import vstack

    A = qp.A.tocsr()
    upper, lower = np.flatnonzero(np.isfinite(qp.u)), np.flatnonzero(np.isfinite(qp.l))
    return vstack([A[upper], -A[lower]], format="csr"), np.concatenate([qp.u[upper], -qp.l[lower]]), upper, lower


def _linprog(cost: Vector, A: Any, side: Vector, low: Vector, high: Vector) -> Any:
    from scipy.optimize import linprog

    options = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    answer = linprog(cost, A, side, bounds=np.column_stack([low, high]), method="highs", options=options)
    return answer if answer.status == 0 else None
