"""Model predictive control of mixed logical dynamical systems by mixed-integer quadratic or linear programming.

After Bemporad and Morari, "Control of systems integrating logic, dynamics, and constraints", Automatica 35, 1999; cost
and limits as in the HYBCON controllers of the Hybrid Toolbox.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control import construction
from hysdel_py.control import fallback as fallbacks
from hysdel_py.control.bands import ResolvedLimits
from hysdel_py.control.changed_limits import for_call
from hysdel_py.control.costs import Cost
from hysdel_py.control.fallback import Fallback, Reserve, check_fallback
from hysdel_py.control.formulation import Formulation, formulate
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import Case, Move, MoveStatus
from hysdel_py.control.planner import Planner
from hysdel_py.control.prediction import choose_step
from hysdel_py.control.references import Reference, choose_references
from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES, ControlTolerances
from hysdel_py.control.settled import allowing_for_rounding
from hysdel_py.control.shape import choose_shape
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import as_vector
from hysdel_py.systems.thresholds import out_of_gaps, state_thresholds

if TYPE_CHECKING:
    from pathlib import Path

    from hysdel_py.control.explanation import PlanExplanation
    from hysdel_py.optimize.miqp import Miqp, MiqpSettings

__all__ = ["HybridMpc", "Move", "MoveStatus"]

Matrix = NDArray[np.float64]
LastInput = ArrayLike | Mapping[str, float] | None


class HybridMpc:
    """Hybrid model predictive controller.

    The program is assembled once; :meth:`solve` only moves it to the measured state and the references. The controller
    remembers its last plan as the start of the next search, which changes the time of an answer and, among plans of
    equal cost, the plan; never its cost beyond the gap.

    Parameters
    ----------
    model : Model or Mld
        A compiled model, or its MLD form.
    horizon : int
        Number N >= 1 of steps that are planned.
    cost : Cost
    limits : Limits, optional
        None beside the declared ranges by default.
    references : sequence of str, optional
        Signals that must be given a reference in every call, in the order of references given as vectors. By default
        every signal with a weight may have one and follows 0 otherwise.
    backend : str
        Solver of the quadratic programs: ``"dense"`` (compiled kernels of our own), ``"piqp"`` or ``"osqp"``;
        ``"auto"`` takes the kernels where numba is installed and PIQP elsewhere.
    time_limit : float, optional
        Seconds per answer.
    node_limit : int, optional
        Nodes of the branch and bound per answer.
    gap_rel, gap_abs : float
        A plan is optimal when its cost exceeds the bound by no more than the larger of `gap_abs` and `gap_rel` times
        the cost.
    progress : callable, optional
        Passed on to the branch and bound; with the norms 1 and infinity it is called once, after the search.
    tolerances : ControlTolerances, optional
    blocking : sequence of int, optional
        Lengths of the blocks of stages with equal inputs, with the sum N.
    control_horizon : int, optional
        Number of inputs that are decided; the last one is held to the end of the horizon.
    binary_horizon : int, optional
        Number of stages whose switches are decided exactly. Later ones are relaxed: the plan is an approximation
        there, and says so.
    fallback : "soft", "last_plan", callable or None
        What gives the input when there is no plan: the same controller with all limits of states and outputs
        softened, the next input of the last plan (with one call of :meth:`solve` per step), or
        ``fallback(x, move) -> u``. The move then has the status ``FALLBACK`` and says why.
    leaves : int
        Ends of the last search tree, one step later, from which the tree of a warm answer begins, at most; 0 begins
        with the whole problem. Only the dense kernels do this.

    Attributes
    ----------
    model : Model or Mld
        What it was built from.
    mld : Mld
    horizon : int
    limits : Limits
    formulation : Formulation
        The program, with the meaning of each variable and row.

    Raises
    ------
    ArgumentError
        If an argument does not fit the model; the message says which and what was expected.
    """

    def __init__(
        self,
        model: Any,
        horizon: int,
        cost: Cost,
        limits: Limits | None = None,
        references: Sequence[str] | None = None,
        *,
        backend: str = "auto",
        time_limit: float | None = None,
        node_limit: int | None = None,
        gap_rel: float = 1e-4,
        gap_abs: float = 1e-5,
        progress: Callable[..., Any] | None = None,
        tolerances: ControlTolerances = DEFAULT_CONTROL_TOLERANCES,
        blocking: Sequence[int] | None = None,
        control_horizon: int | None = None,
        binary_horizon: int | None = None,
        fallback: Fallback = None,
        leaves: int = 64,
    ) -> None:
        self.model = model
        limits = construction.checked(Limits() if limits is None else limits, Limits, "limits")
        self.mld = construction.mld_of(model)
        self.horizon = construction.checked_horizon(horizon, self.mld)
        shape = choose_shape(self.horizon, blocking, control_horizon, binary_horizon)
        construction.checked(tolerances, ControlTolerances, "tolerances")
        weights = construction.checked(cost, Cost, "cost").resolve(self.mld, tolerances)
        bands = self._resolved(limits, tolerances)
        self.references = choose_references(references, weights.names, self.horizon)
        self.formulation: Formulation = formulate(self.mld, self.horizon, weights, bands, shape)
        self.tolerances = tolerances
        self.sample_time: float = getattr(model, "sample_time", 1.0)
        limits_of_search = {"time_limit": time_limit, "node_limit": node_limit, "leaves": leaves}
        settings = construction.search_settings(backend, limits_of_search, gap_rel, gap_abs, tolerances.feasibility)
        step, callback = choose_step(model, self.mld), construction.checked_callable(progress, "progress")

        def planner(formulation: Formulation) -> Planner:
            return Planner(formulation, settings, step, tolerances, progress=callback)

        self.limits = limits
        dha = getattr(model, "dha", None)
        self._thresholds = () if dha is None else state_thresholds(dha)
        self._planner = planner(self.formulation)
        self._fallback = check_fallback(fallback, limits)
        self._reserve: Reserve | None = None
        self._softened: Planner | None = None
        if fallback == "soft":
            softened = self._resolved(replace(limits, soft=True), tolerances)
            self._softened = planner(formulate(self.mld, self.horizon, weights, softened, shape))

    def _resolved(self, limits: Limits, tolerances: ControlTolerances) -> ResolvedLimits:
        resolved = limits.resolve(self.mld, self.horizon)
        return allowing_for_rounding(resolved, self.mld, self.horizon, tolerances.settled)

    @property
    def uses_last_input(self) -> bool:
        """Whether increments of the inputs are weighed or limited, so that :meth:`solve` needs the last input."""
        return self.formulation.uses_last_input

    @property
    def settings(self) -> MiqpSettings:
        """Settings of the search, among them the gap up to which a plan counts as optimal."""
        return self._planner.solver.settings

    def reset(self) -> None:
        """Forget the last plan."""
        self._reserve = None
        for planner in (self._planner, self._softened):
            if planner is not None:
                planner.reset()

    def solve(
        self,
        x: ArrayLike | Mapping[str, float],
        ref: Reference = None,
        *,
        warm: bool = True,
        last_input: LastInput = None,
        limits: Limits | None = None,
    ) -> Move:
        """Plan from a measured state and return the first input.

        Parameters
        ----------
        x : array_like of shape (nx,), or mapping of name to number
            Measured state.
        ref : mapping of name to number or array, or array_like, optional
            References: a number holds over the horizon, an array of length N or N+1 has one value for each time
            0, 1, ...; a vector has one number per name in `references`.
        warm : bool
            Start from the last plan, shifted by one step.
        last_input : array_like of shape (nu,), or mapping of name to number
            The input applied in the step before; needed exactly when increments are weighed or limited.
        limits : Limits, optional
            Limits of this call in place of those of the controller, for the signals that it names; the others stay, and
            so do softness and prices. Each end must be one that the controller limits.

        Returns
        -------
        Move
            ``move.u`` is None when there is no input; ``move.status`` and ``move.message`` say why. Trouble in the
            solver never raises.

        Raises
        ------
        ArgumentError
            Wrong dimension, unknown name, NaN, infinite values, missing references or a missing last input; limits of
            signals that the controller does not limit.
        """
        begin = time.perf_counter()
        measured = out_of_gaps(as_vector(x, self.mld.x, "state"), self._thresholds, self.tolerances.measured)
        table = self.references.table(ref)
        last = construction.checked_last_input(last_input, self.mld, needed=self.uses_last_input)
        formulation = for_call(self.formulation, self.limits, limits)
        move = self._planner.plan(
            measured, table, last, warm=warm, sample_time=self.sample_time, formulation=formulation
        )
        if move.ok:
            if self._fallback is not None:
                self._reserve = None if move.predicted is None else Reserve(move.predicted.u)
        elif self._fallback is not None:
            move = self._fall_back(move, (measured, table, last), formulation, limits)
        return move.at(time.perf_counter() - begin)

    def _fall_back(
        self,
        failed: Move,
        given: tuple[Matrix, Mapping[str, Matrix], Matrix | None],
        formulation: Formulation,
        limits: Limits | None,
    ) -> Move:
        measured, table, last = given
        if self._softened is not None:
            softer = for_call(self._softened.formulation, self.limits, limits, soft=True)
            again = self._softened.plan(
                measured, table, last, warm=False, sample_time=self.sample_time, formulation=softer
            )
            softened = fallbacks.from_softened(failed, again)
            self._reserve = None if softened.predicted is None else Reserve(softened.predicted.u)
            return softened
        if callable(self._fallback):
            return fallbacks.from_callable(failed, self._fallback, measured, self.mld.u)
        broken = partial(fallbacks.broken_input_limits, formulation, last, self.tolerances.residual)
        move = fallbacks.from_reserve(failed, self._reserve, broken)
        self._reserve = None if self._reserve is None else replace(self._reserve, used=self._reserve.used + 1)
        return move

    def why(self, move: Move) -> PlanExplanation:
        """Explain a plan of this controller: active limits, binaries without a choice, prices of requirements.

        Parameters
        ----------
        move : Move
            An answer of this controller with a plan.

        Raises
        ------
        ArgumentError
            The move has no plan of this controller.
        """
        from hysdel_py.control.explanation import explain

        return explain(self.formulation, self._planner.solver.miqp, move)

    def dump_problem(
        self,
        path: str | Path,
        x: ArrayLike | Mapping[str, float] | None = None,
        ref: Reference = None,
        *,
        last_input: LastInput = None,
        move: Move | None = None,
    ) -> None:
        """Write the program of one call as a JSON file, which ``hysdel solve`` and :func:`read_case` solve anywhere.

        Parameters
        ----------
        path : str or Path
        x, ref, last_input
            As for :meth:`solve`.
        move : Move, optional
            Instead of them: the program of an answer of this controller.

        Raises
        ------
        ArgumentError
            Neither a state nor a move with its program.
        """
        from hysdel_py.optimize.case_file import write_case

        if (move is None) == (x is None):
            raise ArgumentError("either a state or a move was expected")
        if x is not None:
            program = self.problem(x, ref, last_input=last_input)
        else:
            program = self._planner.program(_case_of(move).vectors)
        f = self.formulation
        variables = [f.describe_variable(i) for i in range(f.layout.n)]
        write_case(path, program, self._planner.solver.settings, variables, [str(row) for row in f.rows])

    def problem(
        self,
        x: ArrayLike | Mapping[str, float],
        ref: Reference = None,
        *,
        last_input: LastInput = None,
        limits: Limits | None = None,
    ) -> Miqp:
        """Return the mixed-integer program of one call, to study it or to hand it to another solver.

        Parameters and errors are those of :meth:`solve`. The cost includes the constant, so that its value is that of
        ``Move.cost``; the state is not moved onto its range.
        """
        state = as_vector(x, self.mld.x, "state")
        last = construction.checked_last_input(last_input, self.mld, needed=self.uses_last_input)
        formulation = for_call(self.formulation, self.limits, limits)
        return self._planner.program(formulation.vectors(state, self.references.table(ref), last))


def _case_of(move: Move | None) -> Case:
    if move is None or move.case is None:
        raise ArgumentError("the move has no program: its state was refused before there was one")
    return move.case
