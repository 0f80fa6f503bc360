"""A multi-parametric program at single parameters: the independent answer that a law is compared with.

A verified interior-point solution names the active rows; the equations of these rows then give the solution to the last
digits, since a value that is wrong by a share a leaves a solution that may be wrong by the square root of a.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.mpqp import MpQp
from hysdel_py.optimize.qp import Qp, QpResult, QpSettings, QpStatus
from hysdel_py.optimize.verified import VerifiedSolver

__all__ = ["OnlineProblem", "sharpened"]

Vector = NDArray[np.float64]

_ACCURACY = 1e-10
_FAR = 1e7
"""Infeasibility is proven among variables up to this size."""

_TRIES = 10
"""Changes of the active rows before the interior-point solution is kept."""
_EXACT = 1e-11
"""Violations and wrong multipliers below this, relative to the sizes of the sides and of the cost, are rounding."""


class OnlineProblem:
    """The problem at single parameters, by the verified quadratic programs."""

    def __init__(self, problem: MpQp) -> None:
        self.problem = problem
        settings = QpSettings(accuracy=_ACCURACY, feasibility=1e-8, stationarity=1e-7)
        self._qp = self._at(np.zeros(problem.p))
        self._solver = VerifiedSolver(self._qp, "piqp", settings)

    def solve(self, theta: Vector) -> tuple[QpStatus, Vector, float]:
        """Status, solution and value."""
        qp = self._at(theta)
        far = np.full(self.problem.n, _FAR)
        answer = self._solver.solve(self._qp.with_vectors(q=qp.q, l=qp.l, u=qp.u), box=(-far, far)).answer
        x = sharpened(qp, answer) if answer.status is QpStatus.OPTIMAL else answer.x
        return answer.status, x, self.problem.value(x, theta)

    def _at(self, theta: Vector) -> Qp:
        p = self.problem
        assert p.e is not None
        assert p.E is not None
        assert p.D is not None
        equal = p.e + p.D @ theta
        upper = p.w + p.S @ theta
        free = np.full(p.n, np.inf)
        return Qp(
            (p.H + p.H.T) / 2,
            p.f + p.F @ theta,
            np.vstack([p.G, p.E]),
            np.concatenate([np.full(p.m, -np.inf), equal]),
            np.concatenate([upper, equal]),
            -free,
            free,
        )


def sharpened(qp: Qp, answer: QpResult) -> Vector:
    """Solution of the equations of the active rows, if it is one of the problem; else the solution as it was.

    A row is taken to be active where its multiplier is greater than its slack. Rows that turn out to be violated join,
    rows with a multiplier of the wrong sign leave.
    """
    A, sides = _one_sided(qp)
    multipliers = np.concatenate([np.maximum(answer.y, 0.0), np.maximum(-answer.y, 0.0)])[np.isfinite(_sides(qp))]
    active = multipliers > sides - A @ answer.x
    cost = _EXACT * (1.0 + float(np.max(np.abs(qp.q), initial=0.0)))
    for _ in range(_TRIES):
        x, y = _equations(qp, A[active], sides[active])
        wrong = np.flatnonzero(active)[y < -cost]
        excess = A @ x - sides
        broken = excess > _EXACT * (1.0 + np.abs(sides))
        if not wrong.size and not broken.any():
            slope = qp.P @ x + qp.q + A[active].T @ y
            return x if float(np.max(np.abs(slope), initial=0.0)) <= cost else answer.x
        active[wrong], active[broken] = False, True
    return answer.x


def _sides(qp: Qp) -> Vector:
    return np.concatenate([qp.u, -qp.l])


def _one_sided(qp: Qp) -> tuple[NDArray[np.float64], Vector]:
    """Rows ``A x <= b`` of a problem whose variables have no bounds."""
    dense = qp.A.toarray() if hasattr(qp.A, "toarray") else np.asarray(qp.A)
    sides = _sides(qp)
    real = np.isfinite(sides)
    return np.vstack([dense, -dense])[real], sides[real]


def _equations(qp: Qp, rows: NDArray[np.float64], sides: Vector) -> tuple[Vector, Vector]:
    """Point and multipliers of the problem with equalities only; of several the least ones."""
    P = qp.P.toarray() if hasattr(qp.P, "toarray") else np.asarray(qp.P)
    n, k = len(qp.q), len(sides)
    system = np.block([[P, rows.T], [rows, np.zeros((k, k))]])
    found = np.linalg.lstsq(system, np.concatenate([-qp.q, sides]), rcond=None)[0]
    return found[:n], found[n:]
