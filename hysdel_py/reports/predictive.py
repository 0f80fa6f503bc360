"""Is there a plan at every step, and does the closed loop get where it should? A certificate for a controller."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from math import nan
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.analysis.certificate import PredictiveCertificate, Premise, Proof
from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.counts import counted
from hysdel_py.analysis.hybrid_set import HybridSet, Span, box_of
from hysdel_py.analysis.invariance import feasible_states
from hysdel_py.analysis.monitor import Monitor
from hysdel_py.analysis.start_cover import Cover, at_thresholds, cover_of
from hysdel_py.analysis.terminal_step import kept_by_a_step
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.plan_programs import PlanPrograms
from hysdel_py.control.ranges import onto_range
from hysdel_py.control.references import Reference
from hysdel_py.errors import ArgumentError, HysdelError
from hysdel_py.reports.condition import condition_of
from hysdel_py.reports.plan_cost import fall_of
from hysdel_py.reports.plan_question import PlanQuestion, checked_controller, checked_law, plan_question
from hysdel_py.systems.thresholds import out_of_gaps, state_thresholds

if TYPE_CHECKING:
    from hysdel_py.analysis.start_cover import Progress
    from hysdel_py.geometry.polyhedron import Polyhedron
    from hysdel_py.systems.dha import Dha

    Condition = str | Mapping[str, Span] | Polyhedron | HybridSet

__all__ = ["predictive_certificate"]

Vector = NDArray[np.float64]

MOST_REALS = 2
"""Feasible sets of whole horizons are computed for models with so many real states."""
TRIED_STEPS = 60
"""Runs along plans that may refute a premise go on for so long."""


@dataclass(frozen=True, eq=False, slots=True)
class _Effort:
    """How much may be looked at."""

    boxes: int
    parts: int
    progress: Progress | None


def predictive_certificate(
    controller: HybridMpc,
    start: Mapping[str, Span],
    *,
    ref: Reference = None,
    target: Condition | None = None,
    last_law: tuple[ArrayLike, ArrayLike] | None = None,
    boxes: int = 2000,
    parts: int = 4000,
    seconds: float = 600.0,
    progress: Progress | None = None,
) -> PredictiveCertificate:
    """Prove that a controller always has a plan, keeps its limits and reaches a target, or say what is missing.

    Parameters
    ----------
    controller : HybridMpc
        Of a Model. A terminal limit helps: without one the last state of a plan may be any within the limits.
    start : mapping of name to value or (low, high)
        First states; those that are not named may have any value of their range.
    ref : as for :meth:`HybridMpc.solve`
        Constant references.
    target : text, mapping, Polyhedron or HybridSet, optional
        Condition on states, which the closed loop is to meet.
    last_law : (K, k), optional
        The input ``u = K x + k`` of the step that is added where a plan ends, with K of shape (nu, nx); rows of Boolean
        inputs have no gains. Without it any input will do that keeps the limits and leads back, and the dearest of
        them counts where the cost depends on it.
    boxes : int
        Boxes of first states that are looked at, at most.
    parts : int
        Parts of a region over which a quadratic function is bounded, at most.
    seconds : float
        Time limit.
    progress : callable, optional
        ``progress(settled, pending)`` after each box of first states.

    Returns
    -------
    PredictiveCertificate
        One :class:`~hysdel_py.analysis.certificate.Premise` for each step of the argument, each proven, violated with a
        state, or not settled with a reason. ``print`` shows it.

    Raises
    ------
    ArgumentError
        Wrong arguments; a controller of a form without its source; a first state outside its range.

    Notes
    -----
    The plant is the model itself. `target` is reached if every plan is proven optimal within the gap of the controller;
    that there is a plan and that limits are kept holds for any plan, however good it is. Sets count up to parts without
    inner points, and programs up to the tolerances of their solvers; in the gap that a threshold leaves in the program
    of the controller (its epsilon) there is no plan but by these tolerances.
    """
    clock = Clock(seconds)
    question, box, wanted = _question(controller, start, ref, target, seconds)
    if last_law is not None:
        question = replace(question, law=checked_law(last_law, question.model))
    effort = _Effort(counted(boxes, 1, "boxes"), counted(parts, 1, "parts"), progress)
    limits = _limits(question)
    terminal = _terminal(question, clock)
    programs = PlanPrograms(question.formulation, question.table, controller.tolerances, controller.settings)
    cover = _covered(question, programs, box, clock, effort)
    following = _next_plan(question, programs, terminal, None if cover.without is not None else box, clock)
    fall = None
    if wanted is not None:
        fall = fall_of(question, wanted, cover.cost, effort.parts, clock, is_kept=terminal.holds)
    return PredictiveCertificate(
        question.model.name, controller.horizon, limits, terminal, following, _start_premise(question, cover),
        None if fall is None else fall.premise, "" if wanted is None else wanted.text,
        nan if fall is None else fall.decrease, cover.cost, 0.0 if fall is None else fall.floor, cover.parts,
        clock.elapsed,
    )  # fmt: skip


def _question(
    controller: HybridMpc, start: Mapping[str, Span], ref: Reference, target: Condition | None, seconds: float
) -> tuple[PlanQuestion, tuple[Vector, Vector], Monitor | None]:
    model = checked_controller(controller, seconds)
    low, high = box_of(start, model.dha.x, "start")
    for v, a, b in zip(model.dha.x, low, high, strict=True):
        least, most = (0.0, 1.0) if v.is_bool else (v.low, v.high)
        if a < least or b > most:
            raise ArgumentError(f"start: {v.name} in [{a:g}, {b:g}] leaves its range [{least:g}, {most:g}]")
    wanted = None if target is None else condition_of(target, model, "target")
    if wanted is not None and wanted.needs_step:
        raise ArgumentError(f"target: '{wanted.text}' reads more than states")
    return plan_question(controller, model, controller.references.table(ref)), (low, high), wanted


def _named(question: PlanQuestion, state: Vector | None) -> dict[str, float] | None:
    if state is None:
        return None
    return {v.name: float(value) for v, value in zip(question.model.dha.x, state, strict=True)}


# ---- limits ----------------------------------------------------------------------------------------------------------


def _limits(question: PlanQuestion) -> Premise:
    hard = ", ".join(f"{b.group} {b.name} in {b.text()}" for b in question.hard_bands()) or "declared ranges only"
    soft = question.softened()
    message = f"softened and not kept for sure: {', '.join(soft)}" if soft else ""
    name, by = "limits hold at the next state", f"rows of the plan for its second step: {hard}"
    left_out = question.left_out()
    if left_out:
        said = f"a plan of one step says nothing of {', '.join(left_out)} after it"
        return Premise(name, Proof.NOT_SETTLED, by, said)
    return Premise(name, Proof.PROVEN, by, message)


# ---- one more step ---------------------------------------------------------------------------------------------------


def _terminal(question: PlanQuestion, clock: Clock) -> Premise:
    name = "one more step from where plans end"
    if question.ends.is_empty:
        return Premise(name, Proof.VIOLATED, "linear programs", "there is no state in which a plan could end")
    kept = kept_by_a_step(
        question.model.pwa, question.model.dha, question.ends, question.limits, question.law, clock=clock
    )
    by = f"states with such a step, computed backward in {kept.pieces} pieces, cover those in which plans end"
    if kept.holds:
        return Premise(name, Proof.PROVEN, by)
    message = "no input keeps the limits and leads back to where plans end"
    if not kept.is_confirmed:
        return Premise(name, Proof.NOT_SETTLED, by, "the sets leave a part that a search does not confirm")
    return Premise(name, Proof.VIOLATED, f"{by}; mixed-integer search", message, _named(question, kept.state))


def _next_plan(
    question: PlanQuestion, programs: PlanPrograms, terminal: Premise, box: tuple[Vector, Vector] | None, clock: Clock
) -> Premise:
    name = "the next state has a plan"
    if terminal.holds and not question.obstacles:
        return Premise(name, Proof.PROVEN, "the plan without its first step, and one more step")
    if not question.obstacles and not question.has_end and _is_small(question):
        found = _by_sets(question, name, clock)
        if found.holds:
            return found
    lost = None if box is None else _refuted(programs, question.model.dha, box, clock)
    if lost is not None:
        said = "the next state of a plan, from a corner of the first states on, has none"
        return Premise(name, Proof.VIOLATED, "runs along plans", said, _named(question, lost))
    reasons = question.obstacles or ("one more step is not proven",)
    return Premise(name, Proof.NOT_SETTLED, "the plan without its first step", "; ".join(reasons))


def _is_small(question: PlanQuestion) -> bool:
    return sum(not v.is_bool for v in question.model.dha.x) <= MOST_REALS


def _by_sets(question: PlanQuestion, name: str, clock: Clock) -> Premise:
    """Whether states that can go on for N - 1 steps can do so for N."""
    N, limits, pwa = question.controller.horizon, question.limits, question.model.pwa

    def in_time(_step: int, _pieces: int) -> None:
        if not clock.left:
            raise TimeoutError

    def feasible(steps: int) -> HybridSet:
        return feasible_states(
            pwa, steps, within=question.ends, terminal=question.ends, inputs=limits.inputs, outputs=limits.outputs,
            progress=in_time,
        )  # fmt: skip

    by = f"feasible sets of {N - 1} and {N} steps are the same"
    try:
        holds = feasible(N).covers(feasible(N - 1) & question.ends)
    except TimeoutError:
        holds = False
    return Premise(name, Proof.PROVEN if holds else Proof.NOT_SETTLED, by)


def _refuted(programs: PlanPrograms, dha: Dha, box: tuple[Vector, Vector], clock: Clock) -> Vector | None:
    """A state to which plans lead from a corner of the first states and which has no plan."""
    thresholds, most = state_thresholds(dha), programs.tolerances.measured
    for corner in product(*(sorted({a, b}) for a, b in zip(*box, strict=True))):
        x: Vector = np.array(corner)
        for k in range(TRIED_STEPS if clock.left else 0):
            try:
                u = programs.first_input(x)
                after = x if u is None else dha.step(x, u, check=False)[0]
            except (TimeoutError, HysdelError):
                break
            if u is None:
                return x if k else None
            near, _ = onto_range(after, dha.x, most)  # as the controller moves what it measures
            x = out_of_gaps(near, thresholds, most)
    return None


# ---- first states ----------------------------------------------------------------------------------------------------


def _covered(
    question: PlanQuestion, programs: PlanPrograms, box: tuple[Vector, Vector], clock: Clock, effort: _Effort
) -> Cover:
    logical = [i for i, v in enumerate(question.model.dha.x) if v.is_bool]
    cuts = [part for whole in _words(box, logical) for part in at_thresholds(whole, question.model.dha)]
    return cover_of(programs, box, clock, most=effort.boxes, cuts=cuts, progress=effort.progress)


def _words(box: tuple[Vector, Vector], logical: list[int]) -> list[tuple[Vector, Vector]]:
    """The box with each value of its Boolean states."""
    found = []
    for values in product(*(sorted({box[0][i], box[1][i]}) for i in logical)):
        low, high = box[0].copy(), box[1].copy()
        low[logical] = high[logical] = values
        found.append((low, high))
    return found


def _start_premise(question: PlanQuestion, cover: Cover) -> Premise:
    name = "each first state has a plan"
    by = f"{cover.parts} boxes, in each plans with the same Booleans from all corners"
    if cover.is_complete:
        return Premise(name, Proof.PROVEN, f"{by}; none costs more than {cover.cost:.6g}")
    if cover.without is not None:
        return Premise(
            name, Proof.VIOLATED, "the program of the controller", "no plan", _named(question, cover.without)
        )
    return Premise(name, Proof.NOT_SETTLED, by, "a box around this state is left", _named(question, cover.open))
