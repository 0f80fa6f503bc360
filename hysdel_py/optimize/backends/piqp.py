"""PIQP: a proximal interior-point method; accurate, no warm start.

R. Schwan, Y. Jiang, D. Kuhn, C. N. Jones, "PIQP: A Proximal Interior-Point Quadratic Programming Solver", CDC 2023.
Rows with equal sides go to the solver's equalities, the others to its two-sided inequalities, bounds to its box; rows
without a finite side are left out, because the solver complains about them on the terminal.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.backends.answer import checked_result, empty_result, failed_result
from hysdel_py.optimize.qp import Qp, QpResult, QpSettings, QpStatus

__all__ = ["backend"]

Vector = NDArray[np.float64]

DEFAULT_ACCURACY = 1e-9
DEFAULT_ITERATIONS = 60
DENSE_UP_TO = 40
"""Largest number of variables for which the dense factorisation is the faster one."""


@dataclass(frozen=True, slots=True)
class _Piqp:
    settings: QpSettings
    name: str = "piqp"

    def workspace(self, qp: Qp) -> _PiqpWorkspace:
        return _PiqpWorkspace(qp, self.settings)


def backend(settings: QpSettings) -> _Piqp:
    """PIQP with the given settings."""
    return _Piqp(settings)


@dataclass(slots=True)
class _PiqpWorkspace:
    qp: Qp
    settings: QpSettings
    _solver: Any = None
    _kind: NDArray[np.int8] = field(default_factory=lambda: np.zeros(0, dtype=np.int8))

    def solve(
        self,
        q: Vector | None = None,
        *,
        l: Vector | None = None,  # noqa: E741
        u: Vector | None = None,
        lb: Vector | None = None,
        ub: Vector | None = None,
        x0: Vector | None = None,  # noqa: ARG002 - an interior-point method starts from its own centre
        y0: Vector | None = None,  # noqa: ARG002
    ) -> QpResult:
        start = perf_counter()
        self.qp = qp = self.qp.with_vectors(q, l=l, u=u, lb=lb, ub=ub)
        trivial = empty_result(qp)
        if trivial is not None:
            return trivial
        try:
            self._load(rows_changed=l is not None or u is not None)
            claim = _STATUS.get(self._solver.solve().name, QpStatus.NUMERICAL)
        except (RuntimeError, ValueError) as error:
            self._solver = None
            return failed_result(qp, QpStatus.NUMERICAL, f"piqp: {error}")
        return self._read(claim, perf_counter() - start)

    def _load(self, rows_changed: bool) -> None:
        qp = self.qp
        if self._solver is None or (rows_changed and not np.array_equal(self._kind, _kinds(qp))):
            self._set_up()
            return
        e, i = self._equalities(), self._inequalities()
        self._solver.update(c=qp.q, b=qp.l[e], h_l=qp.l[i], h_u=qp.u[i], x_l=qp.lb, x_u=qp.ub)

    def _set_up(self) -> None:
        qp, dense = self.qp, self.qp.n <= DENSE_UP_TO
        matrix = _dense if dense else _compressed
        self._kind, self._solver = _kinds(qp), _new_solver(dense, self.settings)
        e, i, rows = self._equalities(), self._inequalities(), qp.A.tocsr()
        self._solver.setup(
            matrix(qp.P), qp.q, matrix(rows[e]), qp.l[e], matrix(rows[i]), qp.l[i], qp.u[i], qp.lb, qp.ub
        )

    def _equalities(self) -> NDArray[np.bool_]:
        rows: NDArray[np.bool_] = self._kind == EQUALITY
        return rows

    def _inequalities(self) -> NDArray[np.bool_]:
        rows: NDArray[np.bool_] = self._kind == INEQUALITY
        return rows

    def _read(self, claim: QpStatus, seconds: float) -> QpResult:
        r, y = self._solver.result, np.zeros(self.qp.m)
        # A failed run may leave infinities behind; what is not a number is refused where the answer is checked.
        with np.errstate(invalid="ignore"):
            y[self._equalities()], y[self._inequalities()] = r.y, r.z_u - r.z_l
            z = r.z_bu - r.z_bl
        word = f"piqp: {r.info.status.name.removeprefix('PIQP_').lower().replace('_', ' ')}"
        return checked_result(
            self.qp, self.settings, claim, x=r.x.copy(), y=y, z=z, iterations=r.info.iter, seconds=seconds, word=word
        )


NO_ROW, EQUALITY, INEQUALITY = 0, 1, 2


def _kinds(qp: Qp) -> NDArray[np.int8]:
    finite = np.isfinite(qp.l) | np.isfinite(qp.u)
    kinds = np.where(qp.l == qp.u, EQUALITY, np.where(finite, INEQUALITY, NO_ROW))
    return kinds.astype(np.int8)


_STATUS = {
    "PIQP_SOLVED": QpStatus.OPTIMAL,
    "PIQP_PRIMAL_INFEASIBLE": QpStatus.INFEASIBLE,
    "PIQP_DUAL_INFEASIBLE": QpStatus.UNBOUNDED,
    "PIQP_MAX_ITER_REACHED": QpStatus.ITERATION_LIMIT,
}


def _new_solver(dense: bool, settings: QpSettings) -> Any:
    import piqp

    solver = piqp.DenseSolver() if dense else piqp.SparseSolver()
    accuracy = settings.accuracy or DEFAULT_ACCURACY
    solver.settings.eps_abs = solver.settings.eps_rel = accuracy
    solver.settings.eps_duality_gap_abs = solver.settings.eps_duality_gap_rel = accuracy
    solver.settings.max_iter = settings.iterations or DEFAULT_ITERATIONS
    return solver


def _dense(matrix: Any) -> Any:
    return np.asfortranarray(matrix.toarray())


def _compressed(matrix: Any) -> Any:
    from scipy.sparse import csc_matrix

    return csc_matrix(matrix)
