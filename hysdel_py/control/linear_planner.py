"""One linear program with its solver: from parameters to a checked plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.linear_prediction import LinearPrediction
from hysdel_py.control.linear_program import LinearProgram
from hysdel_py.control.linear_rows import LimitRow, SlackPlan
from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.control.settings import ControlTolerances
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from hysdel_py.optimize.qp import Qp
    from hysdel_py.optimize.verified import Verdict, VerifiedSolver

__all__ = ["LinearPlan", "LinearPlanner"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

FAR = 1e7
"""Infeasibility is proven among plans whose moves and slacks, scaled to a curvature of 1, are not larger than this."""


@dataclass(frozen=True, slots=True, eq=False)
class LinearPlan:
    """A program and what it was built from.

    Attributes
    ----------
    program : LinearProgram
    models : tuple of Lti
        One per stage.
    prediction : LinearPrediction
        Forms of all signals.
    slacks : SlackPlan
    """

    program: LinearProgram
    models: tuple[Lti, ...]
    prediction: LinearPrediction
    slacks: SlackPlan


class LinearPlanner:
    """Plan from measured states.

    Parameters
    ----------
    plan : LinearPlan
    backend : str
    tolerances : ControlTolerances
    """

    def __init__(self, plan: LinearPlan, backend: str, tolerances: ControlTolerances) -> None:
        self.built, self.tolerances = plan, tolerances
        self._scale = _scale(plan.program.H)
        self._base = self._scaled(plan.program.qp(np.zeros(plan.program.columns.p)))
        self._solver = _solver(self._base, backend, tolerances)

    def plan(self, theta: Vector) -> Move:
        """Plan for given parameters; the move has no time yet."""
        q, low, high, constant = self.built.program.vectors(theta)
        qp = self._base.with_vectors(q=self._scale * q, l=low, u=high, constant=constant)
        box = np.full(qp.n, FAR)
        before = self._solver.solves
        verdict = self._solver.solve(qp, box=(-box, box))
        solves = self._solver.solves - before
        if not verdict.optimal:
            return self._without_plan(verdict, solves)
        return self._judged(theta, verdict, solves)

    def _scaled(self, qp: Qp) -> Qp:
        """The program in variables whose curvature is 1, so that the price of a slack does not drown the moves."""
        D = self._scale
        P, A = qp.P.toarray() * np.outer(D, D), qp.A.toarray() * D
        return replace(qp, P=(P + P.T) / 2, q=qp.q * D, A=A)

    def broken_input_limits(self, theta: Vector, u: Vector) -> list[str]:
        """Names of the inputs that leave their limits, those of their increments included."""
        low, high = self._input_ends(theta)
        room = self.tolerances.residual
        names = [v.name for v in self.built.models[0].u]
        return [n for n, value, a, b in zip(names, u, low, high, strict=True) if not a - room <= value <= b + room]

    def _without_plan(self, verdict: Verdict, solves: int) -> Move:
        if verdict.infeasible:
            return Move(MoveStatus.INFEASIBLE, f"infeasible: {self._why()}", bound=inf, qps=solves)
        if verdict.unbounded:
            message = (
                "unbounded: the cost falls for ever; give every input or its increment a positive weight or a limit"
            )
            return Move(MoveStatus.UNBOUNDED, message, qps=solves)
        return Move(
            MoveStatus.NUMERICAL,
            f"numerical trouble: {verdict.answer.message}; {_TROUBLE}",
            bound=verdict.bound,
            qps=solves,
        )

    def _why(self) -> str:
        rows = self.built.program.rows
        hard = dict.fromkeys(_words(row) for row in rows if self._is_hard(row.group, row.name, row.time))
        return (
            f"no plan keeps the hard limits of {', '.join(hard)}; soften those of outputs and states with "
            "LinearLimits(rho=...), widen the others, or give a fallback"
        )

    def _is_hard(self, group: str, name: str, time: int) -> bool:
        if group == "slack":
            return False
        return self.built.slacks.of(group, "set" if group == "terminal" else name, time) is None

    def _judged(self, theta: Vector, verdict: Verdict, solves: int) -> Move:
        v = self._scale * verdict.answer.x
        predicted = self._predicted(v, theta)
        residual = self._residual(v, theta, predicted)
        if not residual <= self.tolerances.residual:
            message = f"numerical trouble: the plan violates its limits by {residual:.2g}; {_TROUBLE}"
            return Move(MoveStatus.NUMERICAL, message, bound=verdict.bound, qps=solves, residual=residual)
        cost = verdict.answer.objective
        columns = self.built.program.columns
        slack = np.maximum(v[columns.n - columns.slacks :], 0.0)
        exceeded = dict(zip(self.built.slacks.labels, slack.tolist(), strict=True))
        return Move(
            MoveStatus.OPTIMAL,
            f"optimal: cost {cost:.6g}" + _remark(exceeded, self.tolerances.residual),
            u=predicted.u[0].copy(),
            cost=cost,
            bound=verdict.bound,
            gap=max(0.0, cost - verdict.bound),
            qps=solves,
            predicted=predicted,
            slack=exceeded,
            residual=residual,
        )

    def _predicted(self, v: Vector, theta: Vector) -> Trajectory:
        """The plan as the models themselves run it."""
        models, known = self.built.models, np.concatenate([v, theta, [1.0]])
        nx, steps = models[0].nx, len(models)
        u = np.array([form @ known for form in self.built.prediction.u[:steps]]).reshape(steps, models[0].nu)
        u[0] = np.clip(u[0], *self._input_ends(theta))
        x, y = [theta[:nx]], []
        for lti, control in zip(models, u, strict=True):
            y.append(lti.C @ x[-1] + lti.D @ control + lti.g)
            x.append(lti.A @ x[-1] + lti.B @ control + lti.f)
        return _trajectory(models[0], x, u, y)

    def _input_ends(self, theta: Vector) -> tuple[Vector, Vector]:
        """Interval of the first input that its hard limits leave."""
        columns = self.built.program.columns
        nu = columns.nu
        low, high = np.full(nu, -inf), np.full(nu, inf)
        last = theta[columns.nx : columns.nx + nu] if columns.previous else np.zeros(nu)
        names = [v.name for v in self.built.models[0].u]
        for row in self.built.program.rows:
            if row.time == 0 and row.group in ("u", "du"):
                i = names.index(row.name)
                shift = last[i] if row.group == "du" else 0.0
                low[i], high[i] = max(low[i], row.low + shift), min(high[i], row.high + shift)
        return low, np.maximum(low, high)

    def _residual(self, v: Vector, theta: Vector, predicted: Trajectory) -> float:
        """Largest violation of a row by the simulated plan, relative to its side and at least absolute."""
        program = self.built.program
        values = program.forms @ np.concatenate([v, theta, [1.0]])
        excess = np.maximum(program.low - values, values - program.high)
        sides = np.minimum(np.abs(program.low), np.abs(program.high))
        rows = float(np.max(excess / np.maximum(1.0, sides), initial=0.0))
        return max(rows, self._drift(v, theta, predicted))

    def _drift(self, v: Vector, theta: Vector, predicted: Trajectory) -> float:
        """Difference of the states of the program and of the simulated ones, relative to their size."""
        known = np.concatenate([v, theta, [1.0]])
        x = np.array([form @ known for form in self.built.prediction.x])
        return float(np.max(np.abs(x - predicted.x), initial=0.0) / max(1.0, float(np.abs(x).max(initial=0.0))))


def _scale(H: Matrix) -> Vector:
    curvature = np.diag(H)
    return np.asarray(1.0 / np.sqrt(np.where(curvature > 0, curvature, 1.0)))


def _words(row: LimitRow) -> str:
    return "the terminal set" if row.group == "terminal" else f"{row.group} {row.name}"


def _remark(exceeded: Mapping[str, float], tolerance: float) -> str:
    """Which softened limits a plan exceeds, in words."""
    found = [f"{name} by {value:.4g}" for name, value in exceeded.items() if value > tolerance]
    return f"; softened limits exceeded: {', '.join(found)}" if found else ""


def _trajectory(lti: Lti, x: Sequence[Vector], u: Matrix, y: Sequence[Vector]) -> Trajectory:
    steps = len(u)
    none = np.zeros((steps, 0))
    variables = {"x": lti.x, "u": lti.u, "y": lti.y, "d": (), "z": ()}
    t = np.arange(steps + 1, dtype=np.float64) * lti.ts
    return Trajectory(t, np.array(x), u, np.array(y).reshape(steps, lti.ny), none, none.copy(), variables)


_TROUBLE = 'try the other solver (backend="osqp" or "piqp"), and check that limits and weights are of similar size'


def _solver(qp: Qp, backend: str, tolerances: ControlTolerances) -> VerifiedSolver:
    from hysdel_py.optimize.backends.registry import get_backend
    from hysdel_py.optimize.dense import dense_solver
    from hysdel_py.optimize.mixed_integer import KERNELS, Miqp
    from hysdel_py.optimize.qp import QpSettings
    from hysdel_py.optimize.verified import VerifiedSolver

    name = "piqp" if backend in KERNELS else backend
    settings = QpSettings(accuracy=_ACCURACY, feasibility=tolerances.feasibility)
    get_backend(name, settings)
    return VerifiedSolver(qp, name, settings, dense=dense_solver(Miqp(qp, ()), backend))


_ACCURACY = 1e-10
"""Asked of the solver, so that the online input is that of an explicit law."""
