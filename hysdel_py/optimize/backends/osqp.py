"""OSQP: operator splitting; warm started, cheap per iteration, moderately accurate.

B. Stellato, G. Banjac, P. Goulart, A. Bemporad, S. Boyd, "OSQP: an operator splitting solver for quadratic programs",
Mathematical Programming Computation 12, 2020. Bounds become rows of an identity below A.
"""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.backends.answer import checked_result, empty_result, failed_result
from hysdel_py.optimize.qp import Qp, QpResult, QpSettings, QpStatus

__all__ = ["backend"]

Vector = NDArray[np.float64]

DEFAULT_ACCURACY = 1e-7
DEFAULT_ITERATIONS = 4_000


@dataclass(frozen=True, slots=True)
class _Osqp:
    settings: QpSettings
    name: str = "osqp"

    def workspace(self, qp: Qp) -> _OsqpWorkspace:
        return _OsqpWorkspace(qp, self.settings)


def backend(settings: QpSettings) -> _Osqp:
    """OSQP with the given settings."""
    return _Osqp(settings)


@dataclass(slots=True)
class _OsqpWorkspace:
    qp: Qp
    settings: QpSettings
    _solver: Any = None

    def solve(
        self,
        q: Vector | None = None,
        *,
        l: Vector | None = None,  # noqa: E741
        u: Vector | None = None,
        lb: Vector | None = None,
        ub: Vector | None = None,
        x0: Vector | None = None,
        y0: Vector | None = None,
    ) -> QpResult:
        start = perf_counter()
        self.qp = qp = self.qp.with_vectors(q, l=l, u=u, lb=lb, ub=ub)
        trivial = empty_result(qp)
        if trivial is not None:
            return trivial
        try:
            self._load(q)
            self._guess(x0, y0)
            raw = self._solver.solve(raise_error=False)
        except Exception as error:
            self._solver = None
            return failed_result(qp, QpStatus.NUMERICAL, f"osqp: {type(error).__name__} {error}")
        return self._read(raw, perf_counter() - start)

    def _load(self, q: Vector | None) -> None:
        if self._solver is None:
            self._solver = _set_up(self.qp, self.settings)
            return
        low, high = _stacked(self.qp)
        self._solver.update(q=q, l=low, u=high)

    def _guess(self, x0: Vector | None, y0: Vector | None) -> None:
        if x0 is None:
            return
        y = None if y0 is None else np.concatenate([y0, -self._gradient(x0, y0)])
        self._solver.warm_start(x=np.ascontiguousarray(x0), y=y)

    def _gradient(self, x: Vector, y: Vector) -> Vector:
        gradient: Vector = self.qp.P @ x + self.qp.q + self.qp.A.T @ y
        return gradient

    def _read(self, raw: Any, seconds: float) -> QpResult:
        claim = _STATUS.get(raw.info.status, QpStatus.NUMERICAL)
        multipliers = raw.prim_inf_cert if claim is QpStatus.INFEASIBLE else raw.y
        x = self._direction(raw) if claim in (QpStatus.INFEASIBLE, QpStatus.UNBOUNDED) else raw.x
        y, z = multipliers[: self.qp.m], multipliers[self.qp.m :]
        if claim is QpStatus.UNBOUNDED:
            y, z = np.zeros(self.qp.m), np.zeros(self.qp.n)
        word = f"osqp: {raw.info.status}"
        return checked_result(
            self.qp,
            self.settings,
            claim,
            x=x.copy(),
            y=y.copy(),
            z=z.copy(),
            iterations=raw.info.iter,
            seconds=seconds,
            word=word,
        )

    def _direction(self, raw: Any) -> Vector:
        direction = raw.dual_inf_cert
        usable = direction is not None and len(direction) == self.qp.n and np.isfinite(direction).all()
        return np.asarray(direction) if usable else np.zeros(self.qp.n)


_STATUS = {
    "solved": QpStatus.OPTIMAL,
    "solved inaccurate": QpStatus.OPTIMAL,
    "primal infeasible": QpStatus.INFEASIBLE,
    "primal infeasible inaccurate": QpStatus.INFEASIBLE,
    "dual infeasible": QpStatus.UNBOUNDED,
    "dual infeasible inaccurate": QpStatus.UNBOUNDED,
    "maximum iterations reached": QpStatus.ITERATION_LIMIT,
}


INFINITY = 1e30
"""The solver takes larger numbers for infinite and refuses a lower side above it."""


def _stacked(qp: Qp) -> tuple[Vector, Vector]:
    low, high = np.concatenate([qp.l, qp.lb]), np.concatenate([qp.u, qp.ub])
    return np.clip(low, -INFINITY, INFINITY), np.clip(high, -INFINITY, INFINITY)


def _set_up(qp: Qp, settings: QpSettings) -> Any:
    import osqp
    from scipy.sparse import csc_matrix, eye_array, triu, vstack

    accuracy = settings.accuracy or DEFAULT_ACCURACY
    low, high = _stacked(qp)
    solver = osqp.OSQP()
    solver.setup(
        csc_matrix(triu(qp.P, format="csc")),
        qp.q,
        csc_matrix(vstack([qp.A, eye_array(qp.n)], format="csc")),
        low,
        high,
        eps_abs=accuracy,
        eps_rel=accuracy,
        eps_prim_inf=min(1e-7, accuracy),
        eps_dual_inf=min(1e-7, accuracy),
        max_iter=settings.iterations or DEFAULT_ITERATIONS,
        polishing=False,  # it writes to the terminal where no bound is active
        adaptive_rho_interval=50,  # the default measures time, which would make the iterates depend on the machine
        verbose=False,
    )
    return solver
