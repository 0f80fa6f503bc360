"""From a solver's raw vectors to a checked result."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.qp import Qp, QpResult, QpSettings, QpStatus, objective_value, residuals

__all__ = ["checked_result", "empty_result", "failed_result"]

Vector = NDArray[np.float64]


def checked_result(
    qp: Qp,
    settings: QpSettings,
    claim: QpStatus,
    *,
    x: Vector,
    y: Vector,
    z: Vector,
    iterations: int,
    seconds: float,
    word: str,
) -> QpResult:
    """Compute the residuals of an answer and withdraw the word "optimal" where they do not support it."""
    if not (np.isfinite(x).all() and np.isfinite(y).all() and np.isfinite(z).all()):
        claim = QpStatus.NUMERICAL if claim is QpStatus.OPTIMAL else claim
        return replace(failed_result(qp, claim, word), y=y, iterations=iterations, seconds=seconds)
    r = residuals(qp, x, y, z)
    if claim is QpStatus.OPTIMAL and not (
        r.relative_primal <= settings.feasibility and r.relative_dual <= settings.stationarity
    ):
        claim = QpStatus.NUMERICAL
        word += f", but the residuals are {r.primal:.2g} (rows and bounds) and {r.dual:.2g} (gradient)"
    return QpResult(claim, x, y, z, objective_value(qp, x), r.primal, r.dual, iterations, seconds, word)


def failed_result(qp: Qp, status: QpStatus, message: str) -> QpResult:
    """A result without a point: zero vectors and infinite residuals."""
    inf = float("inf")
    x, y, z = np.zeros(qp.n), np.zeros(qp.m), np.zeros(qp.n)
    return QpResult(status, x, y, z, inf, inf, inf, 0, 0.0, message)


def empty_result(qp: Qp) -> QpResult | None:
    """What needs no solver: crossed sides or bounds, and a problem without variables; otherwise None."""
    rows, bounds = np.flatnonzero(qp.l > qp.u), np.flatnonzero(qp.lb > qp.ub)
    if len(rows):
        y = np.zeros(qp.m)
        y[rows[0]] = 1.0
        return replace(failed_result(qp, QpStatus.INFEASIBLE, f"row {rows[0]} has l > u"), y=y)
    if len(bounds):
        return failed_result(qp, QpStatus.INFEASIBLE, f"variable {bounds[0]} has lb > ub")
    if qp.n == 0:
        feasible = bool(np.all(qp.l <= 0) and np.all(qp.u >= 0))
        status = QpStatus.OPTIMAL if feasible else QpStatus.INFEASIBLE
        y = np.where(qp.l > 0, -1.0, np.where(qp.u < 0, 1.0, 0.0))
        message = "no variables"
        return replace(
            failed_result(qp, status, message), y=y, objective=qp.constant, primal_residual=0.0, dual_residual=0.0
        )
    return None
