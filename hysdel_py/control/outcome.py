"""From the measured state to a program that can be tried, and from the solver's answer to a move in plain words."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.bands import NEVER_SOFT, ResolvedLimits
from hysdel_py.control.formulation import Formulation, Vectors
from hysdel_py.control.layout import Plan
from hysdel_py.control.move import Case, Deferred, Move, MoveStatus
from hysdel_py.control.prediction import as_trajectory
from hysdel_py.control.ranges import onto_range
from hysdel_py.control.settings import ControlTolerances
from hysdel_py.systems.signals import Variable, range_violations
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from hysdel_py.optimize.miqp import MiqpResult

__all__ = ["admissible_state", "judged", "refused"]

Matrix = NDArray[np.float64]


def admissible_state(
    formulation: Formulation, measured: Matrix, tolerances: ControlTolerances
) -> tuple[Matrix, tuple[str, ...]]:
    """Move a measured state onto its range where it is outside by no more than the tolerance.

    Returns
    -------
    x0 : array of shape (nx,)
    reasons : tuple of str
        Why there can be no plan from this state: ranges that it leaves and requirements of the model that it breaks
        whatever the input is. The rows of the MLD form are valid inside the ranges only.
    """
    variables = formulation.layout.mld.x
    x0, outside = onto_range(measured, variables, tolerances.measured)
    reasons = _left_ranges(measured, variables, outside) if outside.any() else ()
    broken = () if reasons else formulation.failed_conditions(x0, tolerances.measured)
    return x0, (*reasons, *(f"the measured state breaks a requirement of the model: {row}" for row in broken))


def _left_ranges(measured: Matrix, variables: tuple[Variable, ...], outside: NDArray[np.bool_]) -> tuple[str, ...]:
    left = [v for v, out in zip(variables, outside, strict=True) if out]
    return range_violations(measured[outside], left, "measured state", 0.0)


def refused(reasons: tuple[str, ...], seconds: float) -> Move:
    """Return the move for a state from which there can be no plan."""
    advice = "check the measurement, or widen the range in the model if such states occur"
    message = f"infeasible: {'; '.join(reasons)}; {advice}"
    return Move(MoveStatus.INFEASIBLE, message, bound=np.inf, seconds=seconds)


def judged(
    formulation: Formulation,
    vectors: Vectors,
    x0: Matrix,
    result: MiqpResult,
    tolerances: ControlTolerances,
    *,
    sample_time: float = 1.0,
    remark: Callable[[Plan], str] | None = None,
    missed: Callable[[], list[str]] = list,
) -> tuple[Move, Callable[[], Plan] | None]:
    """Check the answer of the branch and bound and put it into words.

    Plan, trajectory and words are worked out when they are asked for; `remark` adds to the words, `missed`
    names the limits that the measured state breaks whatever the inputs are.

    Returns
    -------
    move : Move
        Without its time.
    plan : callable or None
        Gives what was planned, None where there is no plan that passed the check.
    """
    if result.x is None:
        status = _status_without_plan(result.status.name)
        bound = np.inf if status is MoveStatus.INFEASIBLE else result.bound
        advice = _advice(status, formulation.limits, result, missed)
        return Move(
            status, advice, bound=bound, nodes=result.nodes, qps=result.qps, case=Case(vectors, None, formulation)
        ), None
    v = result.x.copy()
    v[formulation.binaries] = np.round(v[formulation.binaries])
    residual = formulation.residual(v, vectors)
    if not residual <= tolerances.residual:
        message = f"numerical trouble: the plan violates the model by {residual:.2g}; {_TROUBLE}"
        return Move(MoveStatus.NUMERICAL, message, bound=result.bound, nodes=result.nodes, qps=result.qps), None
    v = np.minimum(np.maximum(v, formulation.lb), formulation.ub)
    layout, shape = formulation.layout, formulation.shape
    plan = Deferred(lambda: layout.split(v, x0))
    predicted = Deferred(lambda: as_trajectory(layout.mld, plan.value(), sample_time, shape.exact))
    status = MoveStatus.OPTIMAL if result.status.name == "OPTIMAL" else MoveStatus.FEASIBLE
    move = Move(
        status,
        Deferred(  # type: ignore[arg-type]
            lambda: (
                "; ".join([_worth(status, result), *_remarks(formulation, predicted.value(), status)])
                + ("" if remark is None else remark(plan.value()))
            )
        ),
        u=_first_input(formulation, v),
        cost=float(result.objective),
        bound=float(result.bound),
        gap=float(result.gap),
        predicted=predicted,  # type: ignore[arg-type]
        slack=dict(zip(layout.slacks, v[layout.slack(0) : layout.term(0)].tolist(), strict=True)),
        nodes=result.nodes,
        qps=result.qps,
        approximate_from=None if shape.is_exact else shape.exact,
        case=Case(vectors, v, formulation),
    )
    return move, plan.value


def _first_input(formulation: Formulation, v: Matrix) -> Matrix:
    """The input of stage 0, Boolean entries exactly 0 or 1."""
    u: Matrix = v[: formulation.layout.mld.nu].copy()
    if formulation.shape.exact:
        for i, variable in enumerate(formulation.layout.mld.u):
            if variable.is_bool:
                u[i] = np.round(u[i])
    return u


def _status_without_plan(name: str) -> MoveStatus:
    known = {
        "INFEASIBLE": MoveStatus.INFEASIBLE,
        "UNBOUNDED": MoveStatus.UNBOUNDED,
        "TIME_LIMIT": MoveStatus.NO_PLAN,
        "NODE_LIMIT": MoveStatus.NO_PLAN,
        "INTERRUPTED": MoveStatus.NO_PLAN,
    }
    return known.get(name, MoveStatus.NUMERICAL)


def _worth(status: MoveStatus, result: MiqpResult) -> str:
    if status is MoveStatus.OPTIMAL:
        return f"optimal: cost {result.objective:.6g}"
    ended = {"TIME_LIMIT": "the time limit", "NODE_LIMIT": "the node limit", "INTERRUPTED": "an interruption"}
    cause = ended.get(result.status.name, f"trouble in the solver ({result.message})")
    return (
        f"feasible: {cause} ended the search; the plan costs {result.objective:.6g}, which is above the optimum by "
        f"{result.gap:.3g} at most"
    )


def _remarks(formulation: Formulation, predicted: Trajectory, status: MoveStatus) -> list[str]:
    """Missing ranges that spoil the proof, outputs that no input can move into their limit, relaxed stages."""
    return [*_missing_ranges(formulation, status), *_unmovable(formulation, predicted), *_relaxed(formulation)]


def _relaxed(formulation: Formulation) -> list[str]:
    shape = formulation.shape
    return [] if shape.is_exact else [f"an approximation: binaries of step {shape.exact} and later are relaxed"]


def _missing_ranges(formulation: Formulation, status: MoveStatus) -> list[str]:
    mld = formulation.layout.mld
    without = [v.name for v in (*mld.x, *mld.u, *mld.z) if not np.isfinite([v.low, v.high]).all()]
    if status is MoveStatus.OPTIMAL or not without:
        return []
    return [f"the bound of the search needs ranges: give one to {', '.join(without)}"]


def _unmovable(formulation: Formulation, predicted: Trajectory) -> list[str]:
    return [
        f"output {band.name} = {value:.6g} is outside its limit {band.text(0)} now, and no input can change that in "
        "this step"
        for band in formulation.unmovable
        if not band.at(0)[0] <= (value := predicted.y[0, band.column]) <= band.at(0)[1]
    ]


_TROUBLE = 'try the other solver (backend="osqp" or "piqp"), and check that ranges and weights are of similar size'


_WHICH = "hys.explain_infeasible(controller, x) finds which of them contradict each other, and when"


def _advice(status: MoveStatus, limits: ResolvedLimits, result: MiqpResult, missed: Callable[[], list[str]]) -> str:
    match status:
        case MoveStatus.INFEASIBLE:
            reason = "; ".join(missed()) or _why_infeasible(limits)
            return f"infeasible: no plan keeps the model and the limits; {reason}; {_WHICH}"
        case MoveStatus.NO_PLAN:
            return "no plan found: the search ended too early; allow more time or nodes, or shorten the horizon"
        case MoveStatus.UNBOUNDED:
            return "unbounded: the cost has no lower bound; give every signal a range"
        case _:
            return f"numerical trouble: {result.message}; {_TROUBLE}"


def _why_infeasible(limits: ResolvedLimits) -> str:
    inside = "the measured state is within its declared range"
    hard = [
        f"{band.group} {band.name} in {band.text()}"
        for band in limits.bands
        if band.group not in NEVER_SOFT and limits.slack_of(band) is None
    ]
    if limits.polytope is not None and limits.polytope_slack is None:
        hard.append("the terminal polytope")
    if hard:
        return f"{inside}; these limits are hard and can be softened with Limits(soft=...): {', '.join(hard)}"
    inputs = "the limits of the inputs, " if any(band.group in NEVER_SOFT for band in limits.bands) else ""
    return (
        f"{inside} and no hard limit of a state or output is left to soften: {inputs}the declared ranges and the MUST "
        "requirements of the model cannot be kept over the horizon"
    )
