"""Answers to convex quadratic programs that are not taken on trust.

A solver's "optimal" needs small residuals, its "infeasible" needs a ray of Farkas that passes the check, its
"unbounded" needs a direction. What the first solver cannot settle goes to the linear programs of
:mod:`hysdel_py.optimize.phase_one` and then to the other solver. Whatever happens, there is a valid lower bound.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.backends.answer import checked_result
from hysdel_py.optimize.backends.protocol import QpWorkspace
from hysdel_py.optimize.backends.registry import BACKENDS, get_backend
from hysdel_py.optimize.certificate import Certifier, spare_curvature
from hysdel_py.optimize.dense import Active, DenseSolver
from hysdel_py.optimize.phase_one import elastic_phase_one, recession_direction
from hysdel_py.optimize.qp import Qp, QpResult, QpSettings, QpStatus, violation
from hysdel_py.optimize.reduction import Reducer

__all__ = ["Start", "Verdict", "VerifiedSolver", "solve_qp"]

Vector = NDArray[np.float64]

REDUCE_FROM = 0.3
"""Share of fixed variables from which the reduced problem is the first to be solved."""


@dataclass(frozen=True, eq=False, slots=True)
class Start:
    """What is known of a similar problem: a point, multipliers of the rows, and the active rows of the dense solver."""

    x: Vector
    y: Vector
    active: Active | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Verdict:
    """What is proven about a problem.

    Attributes
    ----------
    answer : QpResult
        Of the solver whose word counts; INFEASIBLE and UNBOUNDED are proven, OPTIMAL has small residuals.
    bound : float
        Certified lower bound of the objective: infinite for a proven infeasible problem.
    active : array or None
        Active rows, where the dense solver gave the answer.
    """

    answer: QpResult
    bound: float
    active: Active | None = None

    @property
    def start(self) -> Start:
        """Start for a similar problem."""
        return Start(self.answer.x, self.answer.y, self.active)

    @property
    def infeasible(self) -> bool:
        """Whether it is proven that there is no feasible point."""
        return self.answer.status is QpStatus.INFEASIBLE

    @property
    def unbounded(self) -> bool:
        """Whether it is proven that the objective has no lower bound, if there is a feasible point at all."""
        return self.answer.status is QpStatus.UNBOUNDED

    @property
    def optimal(self) -> bool:
        """Whether the answer has small residuals."""
        return self.answer.status is QpStatus.OPTIMAL


@dataclass(slots=True)
class VerifiedSolver:
    """A back end, its substitute and the certificates of one set of matrices.

    Attributes
    ----------
    qp : Qp
        The problem for which the work spaces are built; the vectors come with each call.
    backend : str
    settings : QpSettings
    solves : int
        Number of quadratic programs solved so far, by any back end.
    open_space : callable, optional
        Makes the work space of a back end for a problem; the registry's by default.
    dense : DenseSolver, optional
        Asked before the back ends.
    """

    qp: Qp
    backend: str
    settings: QpSettings
    solves: int = 0
    open_space: Callable[[str, Qp], QpWorkspace] | None = None
    dense: DenseSolver | None = None
    _spaces: dict[str, QpWorkspace] = field(default_factory=dict)
    _certifiers: dict[bytes, Certifier] = field(default_factory=dict)
    _reduction: Reducer | None = None

    def solve(
        self,
        qp: Qp,
        box: tuple[Vector, Vector] | None = None,
        guess: Start | None = None,
        enough: Callable[[Verdict], bool] | None = None,
        *,
        thorough: bool = True,
    ) -> Verdict:
        """Solve and verify.

        Parameters
        ----------
        qp : Qp
            Matrices of the constructor, any vectors.
        box : pair of arrays, optional
            Implied bounds, at most as wide as those of `qp`; the certificates use them, the solver does not see them.
        guess : Start, optional
            What a similar problem gave.
        enough : callable, optional
            Whether a verdict needs no second opinion; by default as soon as something is proven or optimal.
        thorough : bool
            Whether the other solver is asked although there is a finite bound already.
        """
        judged = qp if box is None else qp.with_vectors(lb=box[0], ub=box[1])
        settled = enough or _settled
        best = self._dense_verdict(judged, qp, guess)
        if best is not None and (settled(best) or best.infeasible):
            return best
        for answer in self._opinions(qp, guess):
            best = _better(best, self._judge(judged, answer))
            if settled(best) or best.infeasible:
                return best
        assert best is not None  # there is always one opinion
        # What a solver cannot settle is most often infeasible by little, which linear programs prove faster than
        # another solver fails at it.
        best = self._ask_linear_programs(judged, best)
        for name in (other for other in BACKENDS if other != self.backend):
            if settled(best) or best.infeasible or best.unbounded or (best.bound > -inf and not thorough):
                return best
            best = _better(best, self._judge(judged, self._ask(name, qp, guess)))
        return best

    def _dense_verdict(self, judged: Qp, qp: Qp, guess: Start | None) -> Verdict | None:
        """Word of the dense solver, if it has one."""
        if self.dense is None or np.any(judged.lb > judged.ub):
            return None
        self.solves += 1
        answer, active = self.dense.solve(
            qp, (judged.lb, judged.ub), None if guess is None else guess.active, self.settings
        )
        answer = replace(answer, objective=answer.objective - qp.constant + self.qp.constant)
        verdict = replace(self._judge(judged, answer), active=active)
        return verdict if verdict.optimal or verdict.infeasible else None

    def _opinions(self, qp: Qp, guess: Start | None) -> Iterator[QpResult]:
        """Answers of the chosen solver: first of the form of the problem that suits it, then of the other one."""
        share = np.count_nonzero(qp.lb >= qp.ub) / max(1, qp.n)
        for reduced in (share >= REDUCE_FROM, share < REDUCE_FROM):
            answer = self._ask_reduced(qp) if reduced else self._ask(self.backend, qp, guess)
            if answer is not None:
                yield answer

    def _ask_reduced(self, qp: Qp) -> QpResult | None:
        """Answer of the chosen solver to the problem without its fixed variables and doubled rows."""
        reduction = self._reducer().reduce(qp)
        if reduction is None:
            return None
        self.solves += 1
        answer = self._open(self.backend, reduction.qp).solve()
        x, y = reduction.primal(answer.x), reduction.multipliers(answer.y)
        # The multipliers of the bounds follow from the gradient, also where a variable was taken out.
        z = -(qp.P @ x + qp.q + qp.At @ y)
        z[reduction.free] = answer.z
        word = f"{answer.message} (reduced to {reduction.qp.n} variables)"
        # Like a work space, this answers with the constant of the constructor.
        return checked_result(
            qp.with_vectors(constant=self.qp.constant),
            self.settings,
            answer.status,
            x=x,
            y=y,
            z=z,
            iterations=answer.iterations,
            seconds=answer.seconds,
            word=word,
        )

    def _open(self, name: str, qp: Qp) -> QpWorkspace:
        if self.open_space is not None:
            return self.open_space(name, qp)
        return get_backend(name, self.settings).workspace(qp)

    def _reducer(self) -> Reducer:
        if self._reduction is None:
            self._reduction = Reducer(self.qp)
        return self._reduction

    def _ask(self, name: str, qp: Qp, guess: Start | None) -> QpResult:
        if name not in self._spaces:
            self._spaces[name] = self._open(name, self.qp)
        self.solves += 1
        x0, y0 = (guess.x, guess.y) if guess is not None else (None, None)
        return self._spaces[name].solve(q=qp.q, l=qp.l, u=qp.u, lb=qp.lb, ub=qp.ub, x0=x0, y0=y0)

    def _judge(self, qp: Qp, answer: QpResult) -> Verdict:
        if qp.constant != self.qp.constant:
            answer = replace(answer, objective=answer.objective + qp.constant - self.qp.constant)
        if np.any(qp.lb > qp.ub):
            return Verdict(answer, inf)
        certifier = self.certifier(qp)
        claims_none = answer.status is QpStatus.INFEASIBLE
        if answer.status is not QpStatus.OPTIMAL and certifier.farkas_bound(qp, answer.y) > 0:
            return Verdict(replace(answer, status=QpStatus.INFEASIBLE), inf)
        if claims_none or answer.status is QpStatus.UNBOUNDED:
            answer = replace(answer, status=QpStatus.NUMERICAL, message=f"{answer.message}, which is not proven")
        return Verdict(answer, certifier.dual_bound(qp, answer.x, answer.y))

    def _ask_linear_programs(self, qp: Qp, verdict: Verdict) -> Verdict:
        """Last resort: a ray of the elastic problem, or a direction of descent without end."""
        phase = elastic_phase_one(qp)
        if phase is None:
            return verdict
        if self.certifier(qp).farkas_bound(qp, phase.y) > 0:
            message = f"{verdict.answer.message}; HiGHS gave a ray that proves infeasibility"
            return Verdict(replace(verdict.answer, status=QpStatus.INFEASIBLE, y=phase.y, message=message), inf)
        if verdict.optimal or verdict.bound > -inf or violation(qp, phase.x) > self.settings.feasibility:
            return verdict
        direction = recession_direction(qp)
        if direction is None:
            return verdict
        message = f"{verdict.answer.message}; HiGHS gave a direction of descent without end"
        return Verdict(replace(verdict.answer, status=QpStatus.UNBOUNDED, x=direction, message=message), -inf)

    def certifier(self, qp: Qp) -> Certifier:
        """The certificates for problems whose variables are bounded where those of `qp` are."""
        free = ~np.isfinite(qp.lb) | ~np.isfinite(qp.ub)
        key = free.tobytes()
        if key not in self._certifiers:
            self._certifiers[key] = Certifier.of(self.qp, spare_curvature(self.qp, free))
        return self._certifiers[key]


def solve_qp(qp: Qp, backend: str = "piqp", settings: QpSettings | None = None) -> QpResult:
    """Solve one quadratic program and verify the answer.

    Parameters
    ----------
    qp : Qp
    backend : {"piqp", "osqp"}
        Asked first.
    settings : QpSettings, optional

    Returns
    -------
    QpResult
        OPTIMAL has small residuals, INFEASIBLE and UNBOUNDED are proven; anything else is NUMERICAL or
        ITERATION_LIMIT with a message.
    """
    get_backend(backend, settings)
    return VerifiedSolver(qp, backend, settings or QpSettings()).solve(qp).answer


def _settled(verdict: Verdict) -> bool:
    return verdict.optimal or verdict.infeasible or verdict.unbounded


def _better(old: Verdict | None, new: Verdict) -> Verdict:
    """The answer that says more, with the higher of the two bounds, for both are valid."""
    if old is None or new.infeasible:
        return new
    kept = old if _rank(old) <= _rank(new) else new
    return replace(kept, bound=max(old.bound, new.bound))


def _rank(verdict: Verdict) -> float:
    return verdict.answer.primal_residual if verdict.optimal else inf
