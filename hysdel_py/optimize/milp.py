"""Mixed-integer linear programs by HiGHS (through scipy), with the answer checked here.

HiGHS accepts points whose binaries are 1e-6 away from 0 and 1, which a big-M row turns into a violation of a
threshold. So its binaries are rounded, the linear program that remains is solved anew, and the point is accepted only
if it keeps every row and bound to the feasibility tolerance. The bound is the one that HiGHS reports: it is compared
with the point, not proven. Whatever does not fit together goes to the branch and bound of
:mod:`hysdel_py.optimize.miqp`, whose bounds are certified.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.miqp import MiqpSolver
from hysdel_py.optimize.mixed_integer import Miqp, MiqpResult, MiqpSettings, MiqpStatus, SearchInfo
from hysdel_py.optimize.qp import Qp, objective_value, violation

__all__ = ["MilpSolver", "solve_milp"]

Vector = NDArray[np.float64]

_FOUND, _LIMIT, _INFEASIBLE, _UNBOUNDED = 0, 1, 2, 3
"""Status numbers of ``scipy.optimize.milp``."""


@dataclass(frozen=True, slots=True, eq=False)
class _Word:
    """What HiGHS said: its status, its point, and its bound without the constant."""

    status: int
    x: Vector | None
    bound: float
    nodes: int
    message: str


@dataclass(frozen=True, slots=True, eq=False)
class _Point:
    """A point that passed the check, and its objective."""

    x: Vector
    objective: float


class MilpSolver:
    """HiGHS over one set of matrices, with the interface of :class:`~hysdel_py.optimize.miqp.MiqpSolver`.

    Parameters
    ----------
    miqp : Miqp
        Without a quadratic term.
    settings : MiqpSettings, optional
        ``backend``, ``rounding``, ``qp`` and ``propagation`` count for the second opinion only.

    Raises
    ------
    ArgumentError
        If the Hessian is not zero.
    """

    def __init__(self, miqp: Miqp, settings: MiqpSettings | None = None) -> None:
        if abs(miqp.qp.P).max() if miqp.qp.P.nnz else 0.0:
            raise ArgumentError("the Hessian is not zero: a linear objective was expected")
        self.miqp, self.settings = miqp, settings or MiqpSettings()
        self._linear_programs = 0

    def solve(
        self,
        q: ArrayLike | None = None,
        *,
        l: ArrayLike | None = None,  # noqa: E741
        u: ArrayLike | None = None,
        lb: ArrayLike | None = None,
        ub: ArrayLike | None = None,
        constant: float | None = None,
        floor: float = -inf,
        incumbent: ArrayLike | None = None,
        heuristic: Any = None,
        progress: Any = None,
    ) -> MiqpResult:
        """Search for the optimum.

        Parameters
        ----------
        q, l, u, lb, ub, constant, floor, incumbent
            As in :meth:`MiqpSolver.solve`. HiGHS cannot start from a point: the incumbent is the answer when the
            search ends with nothing better.
        heuristic : callable, optional
            For the second opinion.
        progress : callable, optional
            Called once, after the search, for HiGHS does not report its nodes here.

        Returns
        -------
        MiqpResult
            `qps` counts the linear programs solved here, `nodes` those of HiGHS; the message says whose word counts.
        """
        start = perf_counter()
        self._linear_programs = 0
        qp = self._cut(self.miqp.qp.with_vectors(q, l=l, u=u, lb=lb, ub=ub, constant=constant))
        guess = None if incumbent is None else self._polished(qp, np.asarray(incumbent, dtype=float))
        word = self._ask(qp, self.settings.time_limit - (perf_counter() - start))
        found = None if word.x is None else self._polished(qp, word.x[self.miqp.binaries])
        best = min((p for p in (found, guess) if p is not None), key=lambda p: p.objective, default=None)
        result = self._result(qp, word, best, floor, start)
        if result is None:
            options = {"floor": floor, "heuristic": heuristic, "progress": progress}
            return self._second_opinion(qp, word, best, start, options)
        if progress is not None:
            progress(SearchInfo(result.nodes, result.qps, 0, result.objective, result.bound, result.seconds))
        return result

    def _cut(self, qp: Qp) -> Qp:
        """Cut the bounds of the binaries to [0, 1]."""
        lb, ub, at = qp.lb.copy(), qp.ub.copy(), self.miqp.binaries
        lb[at], ub[at] = np.maximum(lb[at], 0.0), np.minimum(ub[at], 1.0)
        return qp.with_vectors(lb=lb, ub=ub)

    def _ask(self, qp: Qp, seconds: float) -> _Word:
        integrality = np.zeros(qp.n)
        integrality[self.miqp.binaries] = 1
        options: dict[str, Any] = {"mip_rel_gap": self.settings.gap_rel, "node_limit": self.settings.node_limit}
        if seconds < inf:
            options["time_limit"] = max(0.0, seconds)
        return _highs(qp, integrality, options)

    def _polished(self, qp: Qp, values: Vector) -> _Point | None:
        """Best point with the binaries held at the rounded values; None if it keeps the rows only roughly."""
        lb, ub, at = qp.lb.copy(), qp.ub.copy(), self.miqp.binaries
        word = np.round(values) + 0.0
        if np.any(word < lb[at]) or np.any(word > ub[at]):
            return None
        lb[at] = ub[at] = word
        self._linear_programs += 1
        answer = _highs(qp.with_vectors(lb=lb, ub=ub), np.zeros(qp.n), {})
        if answer.x is None:
            return None
        x = np.clip(answer.x, lb, ub)
        return _Point(x, objective_value(qp, x)) if violation(qp, x) <= self.settings.feasibility else None

    def _result(self, qp: Qp, word: _Word, best: _Point | None, floor: float, start: float) -> MiqpResult | None:
        """The answer if all that is known fits together, None otherwise."""
        status = self._status(word, best, perf_counter() - start)
        if status is None:
            return None
        objective = inf if best is None else best.objective
        bound = _bound(status, word, qp.constant, floor)
        if bound > objective + self._allowed(objective):
            return None
        bound = min(bound, objective)
        if status is MiqpStatus.OPTIMAL and objective - bound > self._allowed(objective):
            return None
        gap = objective - bound if best is not None else inf
        return MiqpResult(
            status, None if best is None else best.x, -inf if status is MiqpStatus.UNBOUNDED else objective, bound, gap,
            word.nodes, self._linear_programs, perf_counter() - start, f"HiGHS: {word.message}",
            inf if best is None else _residual(qp, best.x),
        )  # fmt: skip

    def _status(self, word: _Word, best: _Point | None, seconds: float) -> MiqpStatus | None:
        match word.status:
            case n if n == _FOUND and best is not None:
                return MiqpStatus.OPTIMAL
            case n if n == _INFEASIBLE and best is None:
                return MiqpStatus.INFEASIBLE
            case n if n == _UNBOUNDED:
                return MiqpStatus.UNBOUNDED
            case n if n == _LIMIT:
                return MiqpStatus.TIME_LIMIT if seconds >= self.settings.time_limit else MiqpStatus.NODE_LIMIT
            case _:
                return None

    def _allowed(self, objective: float) -> float:
        size = abs(objective) if np.isfinite(objective) else 0.0
        return max(self.settings.gap_abs, self.settings.gap_rel * size)

    def _second_opinion(
        self, qp: Qp, word: _Word, best: _Point | None, start: float, options: dict[str, Any]
    ) -> MiqpResult:
        """Branch and bound with certified bounds, for answers that do not fit together."""
        left = max(0.0, self.settings.time_limit - (perf_counter() - start))
        solver = MiqpSolver(self.miqp, replace(self.settings, time_limit=left))
        result = solver.solve(
            qp.q, l=qp.l, u=qp.u, lb=qp.lb, ub=qp.ub, constant=qp.constant,
            incumbent=None if best is None else best.x[self.miqp.binaries], **options,
        )  # fmt: skip
        message = f"{result.message}; by branch and bound, for the answer of HiGHS ({word.message}) failed its check"
        return replace(result, message=message, seconds=perf_counter() - start, nodes=result.nodes + word.nodes)


def solve_milp(miqp: Miqp, settings: MiqpSettings | None = None, **vectors: Any) -> MiqpResult:
    """Solve one problem once; the keywords are those of :meth:`MilpSolver.solve`."""
    return MilpSolver(miqp, settings).solve(**vectors)


def _bound(status: MiqpStatus, word: _Word, constant: float, floor: float) -> float:
    if status is MiqpStatus.INFEASIBLE:
        return inf
    if status is MiqpStatus.UNBOUNDED:
        return -inf
    return max(floor, word.bound + constant)


def _residual(qp: Qp, x: Vector) -> float:
    rows = qp.A @ x
    excess = np.concatenate([qp.l - rows, rows - qp.u, qp.lb - x, x - qp.ub, [0.0]])
    return float(excess.max())


def _highs(qp: Qp, integrality: Vector, options: dict[str, Any]) -> _Word:
    """HiGHS on the program without its constant."""
    from scipy.optimize import Bounds, LinearConstraint, milp

    if np.any(qp.lb > qp.ub) or np.any(qp.l > qp.u):
        return _Word(_INFEASIBLE, None, inf, 0, "a lower side is above its upper side")
    rows = LinearConstraint(qp.A, qp.l, qp.u) if qp.m else None
    answer = milp(qp.q, integrality=integrality, bounds=Bounds(qp.lb, qp.ub), constraints=rows, options=options)
    x = None if answer.x is None else np.asarray(answer.x, dtype=float)
    bound = answer.get("mip_dual_bound")
    return _Word(
        int(answer.status), x, -inf if bound is None else float(bound), int(answer.get("mip_node_count") or 0),
        str(answer.message),
    )  # fmt: skip
