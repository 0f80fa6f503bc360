"""One program with its solver and the memory of its last plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control import construction, outcome
from hysdel_py.control.formulation import Formulation, Vectors
from hysdel_py.control.layout import Plan
from hysdel_py.control.move import Move
from hysdel_py.control.prediction import (
    Step,
    shifted,
    shifted_cover,
    shifted_experience,
    shifted_sides,
    shifted_variables,
    simulated_binaries,
)
from hysdel_py.control.settings import ControlTolerances
from hysdel_py.control.settled import missed_limits

if TYPE_CHECKING:
    from hysdel_py.optimize.miqp import Miqp, MiqpResult, MiqpSettings

__all__ = ["Planner"]

Matrix = NDArray[np.float64]


class Planner:
    """Plan from measured states with one formulation.

    Parameters
    ----------
    formulation : Formulation
    settings : MiqpSettings
    step : Step or None
        Simulation of the model, for guesses.
    tolerances : ControlTolerances
    progress : callable or None
        Passed on to the search.

    Attributes
    ----------
    solver : MilpSolver or MiqpSolver
    """

    def __init__(
        self,
        formulation: Formulation,
        settings: MiqpSettings,
        step: Step | None,
        tolerances: ControlTolerances,
        *,
        progress: Callable[..., Any] | None,
    ) -> None:
        self.formulation, self.tolerances = formulation, tolerances
        self.solver = construction.make_solver(formulation, settings)
        self._step, self._progress = step, progress
        self._plan: Callable[[], Plan] | None = None
        self._last: MiqpResult | None = None
        self._has_kernel = getattr(self.solver, "workspace", None) is not None
        self._before = shifted_sides(formulation)

    def reset(self) -> None:
        """Forget the last plan."""
        self._plan = self._last = None

    def plan(
        self,
        measured: Matrix,
        table: Mapping[str, Matrix],
        last: Matrix | None,
        *,
        warm: bool,
        sample_time: float = 1.0,
        formulation: Formulation | None = None,
    ) -> Move:
        """Plan from a measured state with references and the input applied last; the move has no time yet.

        `formulation` is the program of the planner with other numbers in its limits, for this call.
        """
        f = self.formulation if formulation is None else formulation
        x0, reasons = outcome.admissible_state(f, measured, self.tolerances)
        if reasons:
            return outcome.refused(reasons, 0.0)
        vectors = f.vectors(x0, table, last)
        result = self._search(vectors, x0, warm)
        move, plan = outcome.judged(
            f, vectors, x0, result, self.tolerances, sample_time=sample_time,
            remark=lambda plan: self._remark_on_thresholds(plan, x0),
            missed=lambda: missed_limits(f, self._step, x0),
        )  # fmt: skip
        self._plan = plan
        self._last = None if plan is None else result
        return move

    def program(self, vectors: Vectors) -> Miqp:
        """Return the program of one call, to study it or to hand it to another solver."""
        from hysdel_py.optimize.miqp import Miqp

        program = self.solver.miqp
        qp = program.qp.with_vectors(**vectors.as_keywords())
        return Miqp(qp, program.binaries, priorities=program.priorities, drivers=program.drivers)

    def _remark_on_thresholds(self, plan: Plan, x0: Matrix) -> str:
        """Say where the plan counts on a threshold that the model, without epsilon and rounding, sees differently."""
        f = self.formulation
        planned = np.round(f.layout.join(plan)[f.binaries])
        differing = np.flatnonzero(planned != simulated_binaries(f, self._step, x0, plan))
        if not differing.size:
            return ""
        first = f.describe_variable(int(f.binaries[differing[0]]))
        return (
            f"; the plan stands on a threshold, which the simulated model may see from the other side first at {first}"
        )

    def _search(self, vectors: Vectors, x0: Matrix, warm: bool) -> MiqpResult:
        hints = self._kernel_hints(warm) if self._has_kernel else self._hints(x0, warm)
        return self.solver.solve(
            **vectors.as_keywords(),
            floor=0.0,  # the cost is a sum of squares or absolute values
            progress=self._progress,
            **hints,
        )

    def _hints(self, x0: Matrix, warm: bool) -> dict[str, Any]:
        """Guesses by the model's own simulation."""
        return {"incumbent": self._guess(x0) if warm else None, "heuristic": self._heuristic(x0)}

    def _kernel_hints(self, warm: bool) -> dict[str, Any]:
        """The last plan, its active rows, what was learnt about splitting and the ends of its tree, one step later."""
        f, last = self.formulation, self._last
        if not warm or last is None or last.x is None:
            return {}
        hints: dict[str, Any] = {"point": shifted_variables(f, last.x)}
        if last.active is not None:
            active = last.active.copy()
            active[:, 0] = self._before[active[:, 0]]
            hints["active"] = active[active[:, 0] >= 0]
        if last.pseudo_costs is not None:
            hints["pseudo_costs"] = shifted_experience(f, last.pseudo_costs)
        if last.cover is not None:
            hints["cover"] = shifted_cover(f, last.cover, last.x, self._before)
        return hints

    def _guess(self, x0: Matrix) -> Matrix | None:
        """Binaries of the last plan, one step later and as the model moves from the measured state."""
        if self._plan is None:
            return None
        return simulated_binaries(self.formulation, self._step, x0, shifted(self._plan()))

    def _heuristic(self, x0: Matrix) -> Callable[[Matrix, Matrix, Matrix], Matrix]:
        def simulate_relaxation(v: Matrix, _lb: Matrix, _ub: Matrix) -> Matrix:
            relaxed = self.formulation.layout.split(v, x0)
            return simulated_binaries(self.formulation, self._step, x0, relaxed)

        return simulate_relaxation
