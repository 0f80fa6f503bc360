"""Whether the cost of the best plan falls outside of a target, and by how much."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite, nan

from hysdel_py.analysis.certificate import Premise, Proof
from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.least_cost import Squares, least_value
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.monitor import Monitor
from hysdel_py.analysis.runs import start_runs
from hysdel_py.analysis.settings import DEFAULT_SEARCH_TOLERANCES
from hysdel_py.analysis.terminal_cost import AddedCost, greatest_addition
from hysdel_py.analysis.terminal_step import demand_piece
from hysdel_py.control.weights import Norm
from hysdel_py.errors import ArgumentError
from hysdel_py.reports.plan_question import PlanQuestion

__all__ = ["Fall", "fall_of"]


@dataclass(frozen=True, eq=False, slots=True)
class Fall:
    """What is known of the cost of the best plan.

    Attributes
    ----------
    premise : Premise
    decrease : float
        By at least so much it falls along a step outside of the target; not a number where that is not proven.
    floor : float
        No plan costs less.
    """

    premise: Premise
    decrease: float = nan
    floor: float = 0.0


def fall_of(
    question: PlanQuestion, wanted: Monitor, greatest: float, parts: int, clock: Clock, *, is_kept: bool
) -> Fall:
    """Whether the cost falls along each step that starts outside of a target.

    Parameters
    ----------
    question : PlanQuestion
    wanted : Monitor
        The target.
    greatest : float
        What the best plan costs at most, for the gap that is relative to it.
    parts, clock : int, Clock
        Limits of the work.
    is_kept : bool
        Whether each state in which a plan ends has a step that leads back; without it there is nothing to compare with.
    """
    name, stage = f"the cost falls outside of {wanted.text}", question.stage
    refused = _not_shifted(question, is_kept=is_kept) or _not_bounded(question, stage)
    if refused:
        return Fall(Premise(name, Proof.NOT_SETTLED, "", refused))
    least = _least_outside(question, wanted, stage, clock)
    costs = stage, question.terminal
    try:
        added = greatest_addition(
            question.model.pwa, question.ends, question.limits, costs, question.law,
            allowed=least if isfinite(least) else 0.0, parts=parts,
        )  # fmt: skip
    except ArgumentError as error:
        return Fall(Premise(name, Proof.NOT_SETTLED, "", str(error)))
    return _judged(question, name, (least, added, _gap(question, greatest)), _least_end(question, costs[1], clock))


def _gap(question: PlanQuestion, greatest: float) -> float:
    """By how much a plan that counts as optimal may be dearer than the best; the gap is relative to its own cost."""
    settings = question.controller.settings
    dearest = greatest / (1.0 - settings.gap_rel) if settings.gap_rel < 1.0 else inf
    return max(settings.gap_abs, settings.gap_rel * dearest if settings.gap_rel else 0.0)


def _not_shifted(question: PlanQuestion, *, is_kept: bool) -> str:
    """Why a plan without its first step, with one more, need not be a plan whose cost is known."""
    if question.obstacles:
        return "; ".join(question.obstacles)
    return "" if is_kept else "one more step is not proven for each state in which a plan ends"


def _not_bounded(question: PlanQuestion, stage: Squares) -> str:
    if question.formulation.norm is not Norm.SQUARES:
        return "bounds are known for costs of squares only"
    if any(vector == "z" for vector, _ in stage.signals):
        return "weights of real auxiliaries have no bounds here"
    if question.softened():
        return f"the price of softened limits ({', '.join(question.softened())}) at one more step has no bound here"
    return ""


def _judged(question: PlanQuestion, name: str, found: tuple[float, AddedCost, float], floor: float) -> Fall:
    least, added, gap = found
    shown = "(unknown)" if added.bound is None else f"{added.bound:.6g}"
    by = (
        f"a step outside costs {least:.6g} at least, one more step at the end adds {shown} at most "
        f"({added.regions} regions), plans are optimal within {gap:.3g}"
    )
    if added.bound is None:
        message = "what one more step adds is not bounded within the parts"
        return Fall(Premise(name, Proof.NOT_SETTLED, by, message), floor=floor)
    decrease = least - added.bound - gap
    if decrease > 0:
        return Fall(Premise(name, Proof.PROVEN, f"{by}: it falls by {decrease:.6g}"), decrease, floor)
    reals = [v.name for v in question.model.dha.x if not v.is_bool]
    state = None if added.state is None else dict(zip(reals, map(float, added.state), strict=False))
    message = "a step at the end may add more than the first one takes away"
    return Fall(Premise(name, Proof.NOT_SETTLED, by, message, state), floor=floor)


def _least_outside(question: PlanQuestion, wanted: Monitor, stage: Squares, clock: Clock) -> float:
    """What a step costs at least that starts outside of the target."""
    runs = start_runs(question.model.dha, {}, question.limits.inputs, (0.0, DEFAULT_SEARCH_TOLERANCES.apart))
    runs.grow()
    outside = runs.watch(wanted, 0)
    problem = runs.problem.copy()
    problem.fix(outside.result, 0.0)
    step = runs.steps[0]
    places = {"y": step.outputs, "u": runs.inputs[0], "d": step.values, "x": runs.states[1]}
    return least_value(problem, [(stage, [places[w][name] for w, name in stage.signals])], clock).bound


def _least_end(question: PlanQuestion, terminal: Squares, clock: Clock) -> float:
    """What the last state of a plan costs at least."""
    least = inf
    for piece in question.ends.pieces:
        problem = Milp()
        dha = question.model.dha
        places = {v.name: problem.boolean() if v.is_bool else problem.real(v.low, v.high) for v in dha.x}
        demand_piece(problem, places, piece, dha)
        sums = [(terminal, [places[name] for _, name in terminal.signals])]
        least = min(least, least_value(problem, sums, clock).bound)
    return least if isfinite(least) else 0.0
