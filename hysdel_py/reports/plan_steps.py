"""What no plan of a predictive controller does at its second state, whatever it weighs and however good it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hysdel_py.analysis.certificate import Premise, Proof
from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.monitor import Monitor
from hysdel_py.analysis.safety import Found, Question, Searcher, Verdict
from hysdel_py.analysis.terminal_step import Limited, limited_dha
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.reports.condition import condition_of
from hysdel_py.reports.plan_question import PlanQuestion, checked_controller, plan_question

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hysdel_py.analysis.hybrid_set import HybridSet, Span
    from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["plans_never"]


def plans_never(
    controller: HybridMpc,
    condition: str | Mapping[str, Span] | Polyhedron | HybridSet,
    *,
    softened: bool = False,
    seconds: float = 300.0,
) -> Premise:
    """Does the first step of no plan lead to a condition, from whatever state?

    What holds for the second state of every plan holds for every state of the closed loop but the first one, as long as
    there is a plan. Its steps are those of the model under the hard limits of the controller, in mixed-integer rows
    whose thresholds are closed: first two of them, then as many as the controller plans.

    Parameters
    ----------
    controller : HybridMpc
        Of a Model. Its references, weights and prices do not matter, nor whether its plans are optimal.
    condition : text, mapping, Polyhedron or HybridSet
        Over states, inputs, outputs and auxiliaries, as for :func:`hysdel_py.can_reach`.
    softened : bool
        Whether plans with all limits of states and outputs softened count as well, as the fallback ``"soft"`` makes
        them; what is left are declared ranges, MUST items and limits of inputs.
    seconds : float
        Time limit.

    Returns
    -------
    Premise
        ``violated`` with the state before a step that leads there.

    Raises
    ------
    ArgumentError
        Wrong arguments, or a controller of a form without its source.

    Notes
    -----
    States count from within the hard limits of states. Limits that a call changes are those of the call.

    Examples
    --------
    >>> from hysdel_py import Cost, HybridMpc, Limits, load
    >>> model = load("SYSTEM s { INTERFACE { STATE { REAL v [-10, 10]; } INPUT { REAL u [-1, 1]; } }"
    ...              " IMPLEMENTATION { CONTINUOUS { v = 1.5*v + u; } } }")
    >>> mpc = HybridMpc(model, 4, Cost(x={"v": 1}), Limits(x={"v": (-2, 3)}))
    >>> plans_never(mpc, "v <= -2.1").verdict, plans_never(mpc, "v >= 2.5").verdict
    ('proven', 'violated')
    """
    model = checked_controller(controller, seconds)
    question = plan_question(controller, model, {})
    monitor = condition_of(condition, model, "condition")
    name = f"no plan meets '{monitor.text}' after its first step"
    limits = Limited({}, question.limits.inputs, {}) if softened else _held(question)
    clock, found, steps = Clock(seconds), Found(Verdict.NONE), 0
    for steps in _lengths(controller, monitor):
        found = _searched(question, monitor, limits, steps, clock)
        if found.verdict is not Verdict.RUN:
            break
    by = f"mixed-integer search over {steps} steps under the {'limits of inputs' if softened else 'hard limits'}"
    if found.verdict is Verdict.NONE:
        return Premise(name, Proof.PROVEN, by, found.message)
    if found.run is None:
        return Premise(name, Proof.NOT_SETTLED, by, found.message)
    state = {v.name: float(value) for v, value in zip(model.dha.x, found.run.x[0], strict=True)}
    return Premise(name, Proof.VIOLATED, by, f"the step to {found.run.x[1].round(6).tolist()} leads there", state)


def _held(question: PlanQuestion) -> Limited:
    """Limits that hold at every state of a closed loop but the first one."""
    own, left_out = question.limits, question.left_out()
    return Limited(own.states, own.inputs, {name: span for name, span in own.outputs.items() if name not in left_out})


def _lengths(controller: HybridMpc, monitor: Monitor) -> tuple[int, ...]:
    """Two steps are few rows; the whole horizon refutes less."""
    least = 1 + monitor.needs_step
    return tuple(dict.fromkeys((max(least, min(2, controller.horizon)), max(least, controller.horizon))))


def _searched(question: PlanQuestion, monitor: Monitor, limits: Limited, steps: int, clock: Clock) -> Found:
    model = question.model
    asked = Question(limited_dha(model.dha, limits), {}, None, limits.inputs, monitor, steps, model.sample_time)
    return Searcher(asked, clock).run(steps, (1,), meets=True)
