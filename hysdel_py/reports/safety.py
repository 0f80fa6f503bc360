"""Can a condition be reached, and must it be? Answers with a run that shows it, or a proof that there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from numbers import Real
from operator import index
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.hybrid_set import HybridSet, Span
from hysdel_py.analysis.monitor import Monitor
from hysdel_py.analysis.safety import Found, Progress, Question, Searcher, Verdict, earliest_meeting, longest_avoidance
from hysdel_py.errors import ArgumentError, SimulationError
from hysdel_py.model import Model
from hysdel_py.reports.condition import condition_of
from hysdel_py.reports.safety_answer import SafetyAnswer, SafetyVerdict
from hysdel_py.systems.signals import as_vector

if TYPE_CHECKING:
    from hysdel_py.geometry.polyhedron import Polyhedron

    Condition = str | Mapping[str, Span] | Polyhedron | HybridSet
    Start = ArrayLike | Condition

__all__ = ["avoidance", "can_reach", "check_model", "meeting", "must_reach"]


def can_reach(
    model: Model,
    x0: Start,
    target: Condition,
    steps: int,
    *,
    inputs: Mapping[str, Span] | None = None,
    seconds: float = 300.0,
    progress: Progress | None = None,
) -> SafetyAnswer:
    """Is there a run from some states that meets a condition within some steps?

    Parameters
    ----------
    model : Model
    x0 : array_like of shape (nx,), mapping of name to value or (low, high), text, Polyhedron or HybridSet
        First states; those that are not named may have any value of their range.
    target : text, mapping of name to value or (low, high), Polyhedron or HybridSet
        A text is a Boolean expression of the language over states, inputs, outputs and auxiliaries, such as
        ``"level(1) >= 0.6 & ~open"``. A mapping names any of these; a set is one of states.
    steps : int
        The target is judged at the times 0 to `steps`; one that reads more than states not after the last step.
    inputs : mapping of name to value or (low, high), optional
        Inputs that are not named may have any value of their range, another one at each step.
    seconds : float
        Time limit.
    progress : callable, optional
        ``progress(k, searches)`` after each time that is settled; a true answer ends the search.

    Returns
    -------
    SafetyAnswer
        ``reachable`` with the earliest run, which the simulator of the model has confirmed, ``unreachable``, proven to
        the tolerance of the solver, ``no run`` where not even one step is possible, or ``not settled``. ``print`` shows
        it.

    Raises
    ------
    ArgumentError
        Wrong arguments, or a variable without the finite range that a definition needs.
    SimulationError
        An auxiliary variable is used but never defined: the model has no step.

    Notes
    -----
    A run keeps declared ranges of states and inputs and all MUST items; where no step is left it ends.

    Examples
    --------
    >>> from hysdel_py import load
    >>> model = load("SYSTEM tank { INTERFACE { STATE { REAL level [0, 1]; } INPUT { REAL q [0, 0.2]; } }"
    ...              " IMPLEMENTATION { CONTINUOUS { level = 0.5*level + q; } } }")
    >>> can_reach(model, {"level": 0.1}, "level >= 0.35", 20).time
    3
    >>> can_reach(model, {"level": 0.1}, "level >= 0.45", 20).verdict
    'unreachable'
    """
    return meeting(model, _searcher(model, x0, target, steps, inputs=inputs, seconds=seconds), progress)


def meeting(model: Model, searcher: Searcher, progress: Progress | None = None) -> SafetyAnswer:
    """The answer of :func:`can_reach` to the question of a searcher."""
    found = earliest_meeting(searcher, progress)
    if found.verdict is Verdict.NONE:
        return _unreachable(model, searcher, found)
    verdict = {
        Verdict.RUN: SafetyVerdict.REACHABLE,
        Verdict.NOT_SETTLED: SafetyVerdict.NOT_SETTLED,
    }[found.verdict]
    return _answer(model, searcher, verdict, found, searcher.question.times[-1])


def must_reach(
    model: Model,
    x0: Start,
    target: Condition,
    steps: int,
    *,
    inputs: Mapping[str, Span] | None = None,
    seconds: float = 300.0,
    progress: Progress | None = None,
) -> SafetyAnswer:
    """Does every run from some states meet a condition within some steps, whatever the inputs are?

    Parameters and errors are those of :func:`can_reach`.

    Returns
    -------
    SafetyAnswer
        ``avoidable`` with a run that never meets the target, ``inevitable``, proven to the tolerance of the solver,
        with the number of steps within which it is met, or ``not settled``. Where there is no run of so many steps at
        all, so that nothing has to meet anything, the answer is ``no run``.

    Notes
    -----
    A run that ends early because no step is left counts for nothing: it avoids the target in no full number of steps.

    Examples
    --------
    >>> from hysdel_py import load
    >>> model = load("SYSTEM tank { INTERFACE { STATE { REAL level [0, 1]; } INPUT { REAL q [0.1, 0.2]; } }"
    ...              " IMPLEMENTATION { CONTINUOUS { level = 0.5*level + q; } } }")
    >>> must_reach(model, {"level": 0}, "level >= 0.15", 8).verdict
    'inevitable'
    >>> must_reach(model, {"level": 0}, "level >= 0.25", 8).verdict
    'avoidable'
    """
    return avoidance(model, _searcher(model, x0, target, steps, inputs=inputs, seconds=seconds), progress)


def avoidance(model: Model, searcher: Searcher, progress: Progress | None = None) -> SafetyAnswer:
    """The answer of :func:`must_reach` to the question of a searcher."""
    found, length = longest_avoidance(searcher, progress)
    if found.verdict is Verdict.NONE:
        return _inevitable(model, searcher, length)
    verdict = SafetyVerdict.AVOIDABLE if found.verdict is Verdict.RUN else SafetyVerdict.NOT_SETTLED
    return _answer(model, searcher, verdict, found, length)


def _unreachable(model: Model, searcher: Searcher, found: Found) -> SafetyAnswer:
    """What no run meets says little where runs end early, and nothing where there is none."""
    question = searcher.question
    if searcher.run(question.steps, (), meets=True).verdict is not Verdict.NONE:
        return _answer(model, searcher, SafetyVerdict.UNREACHABLE, found, question.times[-1])
    first = Searcher(question, searcher.clock).run(min(question.steps, 1), (), meets=True)
    if first.verdict is Verdict.NONE:
        return _answer(model, searcher, SafetyVerdict.NO_RUN, found, min(question.steps, 1))
    ended = replace(found, message=_joined(found.message, f"no run lasts for {question.steps} steps"))
    return _answer(model, searcher, SafetyVerdict.UNREACHABLE, ended, question.times[-1])


def _joined(*parts: str) -> str:
    return "; ".join(part for part in parts if part)


def _inevitable(model: Model, searcher: Searcher, length: int) -> SafetyAnswer:
    """What no run avoids is inevitable only if there is a run."""
    some = searcher.run(length, (), meets=True)
    verdict = {
        Verdict.RUN: SafetyVerdict.INEVITABLE,
        Verdict.NONE: SafetyVerdict.NO_RUN,
        Verdict.NOT_SETTLED: SafetyVerdict.INEVITABLE,
    }[some.verdict]
    return _answer(model, searcher, verdict, Found(Verdict.NONE), length)


def _answer(model: Model, searcher: Searcher, verdict: SafetyVerdict, found: Found, steps: int) -> SafetyAnswer:
    return SafetyAnswer(
        model, searcher.question.target.text, verdict, steps, found.run, found.time, found.borderline, found.message,
        searcher.calls, searcher.clock.elapsed,
    )  # fmt: skip


def _searcher(
    model: Model, x0: Start, target: Condition, steps: int, *, inputs: Mapping[str, Span] | None, seconds: float
) -> Searcher:
    check_model(model, seconds)
    box, start = _start(model, x0)
    wanted = condition_of(target, model, "target")
    question = Question(model.dha, box, start, inputs or {}, wanted, _counted(steps, wanted), model.sample_time)
    return Searcher(question, Clock(seconds))


def check_model(model: Model, seconds: float) -> None:
    """Refuse what is no model, one without a step, and a time limit that is none."""
    if not isinstance(model, Model):
        raise ArgumentError(f"a {type(model).__name__} was given: a Model was expected, as load() returns it")
    if model.dha.undefined_but_used:
        names = ", ".join(model.dha.undefined_but_used)
        raise SimulationError((f"the auxiliary variable {names} is used but never defined: the model has no step",))
    if not isinstance(seconds, Real) or not seconds > 0:
        raise ArgumentError(f"seconds is {seconds!r}: a positive number was expected")


def _counted(steps: int, target: Monitor) -> int:
    try:
        count = -1 if isinstance(steps, bool) else index(steps)
    except TypeError:
        count = -1
    least = 1 if target.needs_step else 0
    if count < least:
        raise ArgumentError(f"steps is {steps!r}: a whole number of at least {least} was expected")
    return count


def _start(model: Model, x0: Start) -> tuple[Mapping[str, Span], Monitor | None]:
    """A box around the first states, and what they have to fulfil besides."""
    if isinstance(x0, str):
        start = condition_of(x0, model, "x0")
        if start.needs_step:
            raise ArgumentError(f"x0 '{x0}' reads more than states")
        return {}, start
    if isinstance(x0, Mapping):
        return x0, None
    if isinstance(x0, HybridSet):
        return x0.ranges(), condition_of(x0, model, "x0")
    if hasattr(x0, "bounding_box"):
        return {}, condition_of(x0, model, "x0")
    values = as_vector(x0, model.dha.x, "state")
    return {v.name: float(value) for v, value in zip(model.dha.x, values, strict=True)}, None
