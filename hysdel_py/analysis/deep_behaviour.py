"""Events that never change, branches that are never taken, states that leave their range."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from hysdel_py.analysis.deep import ANY_POINT, Deep, Finding, Hunt, Point, span_of
from hysdel_py.analysis.margins import largest
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.systems.dha import AffineEquation, Event, Switch
from hysdel_py.systems.signals import Variable

__all__ = ["constant_events", "dead_branches", "left_ranges"]


# ---- events and branches ------------------------------------------------------------------------------------------


def constant_events(deep: Deep) -> Iterator[Finding]:
    """Events that are never true or never false; those that the ranges decide are warned of by the compiler."""
    for event in deep.comparison.dha.items:
        if not isinstance(event, Event) or _is_decided(deep, event):
            continue
        for value in (True, False):
            if _never(deep, event.name, value=value):
                yield deep.finding(
                    Code.EVENT_CONSTANT,
                    f"{_shown(event.name)} is never {'true' if value else 'false'} in any step of the model",
                    span_of(event.origin),
                    help="no state and input within the ranges that MUST allows gets there",
                )


def _shown(name: str) -> str:
    return "this comparison" if name.startswith("__") else name


def _is_decided(deep: Deep, event: Event) -> bool:
    low, high = event.form.range(deep.comparison.ranges.__getitem__)
    return high <= 0.0 or low > 0.0


def _never(deep: Deep, name: str, *, value: bool) -> bool:
    """Whether a Boolean auxiliary has a value in no step."""

    def has_value(point: Point) -> bool:
        return dict(point.outcome.auxiliaries).get(name) == float(value)

    if any(map(has_value, deep.samples)):
        return False
    question = f"whether {_shown(name)} is ever {'true' if value else 'false'}"

    def ask(clear: bool) -> Hunt:
        problem, step = deep.comparison.whole(clear=clear)
        problem.fix(step.values[name], float(value))
        return Hunt(problem, step, {}, ANY_POINT)

    return deep.search(ask, has_value, question)[0]


def dead_branches(deep: Deep) -> Iterator[Finding]:
    """Branches of IF that are never taken, where the condition is no event that has been reported itself."""
    comparison = deep.comparison
    for switch in comparison.dha.items:
        if not isinstance(switch, Switch):
            continue
        condition = switch.condition
        definition = comparison.dha.definitions.get(condition.name)
        if isinstance(definition, Event) or condition.name not in comparison.rows_of:
            continue
        for holds in (True, False):
            if _never(deep, condition.name, value=holds == condition.positive):
                yield deep.finding(
                    Code.BRANCH_UNREACHABLE,
                    f"the {'THEN' if holds else 'ELSE'} branch is never taken in any step of the model",
                    span_of(switch.origin),
                    help="no state and input within the ranges that MUST allows gets there",
                )


# ---- ranges of states ---------------------------------------------------------------------------------------------


def left_ranges(deep: Deep) -> Iterator[Finding]:
    """Real states whose next value can lie outside of their declared range."""
    for state in deep.comparison.dha.x:
        definition = deep.comparison.dha.definitions.get(state.name)
        if isinstance(definition, AffineEquation) and not state.is_bool:
            yield from _left_range(deep, state, definition)


def _left_range(deep: Deep, state: Variable, update: AffineEquation) -> Iterator[Finding]:
    low, high = update.value.range(deep.comparison.ranges.__getitem__)
    slack = deep.comparison.margins.tolerance * max(largest(update.value, deep.comparison.ranges), 1e-300)
    for sign, end, reached in ((1.0, state.high, high), (-1.0, state.low, -low)):
        if not isfinite(end) or reached <= sign * end + slack:
            continue
        point = _beyond(deep, state, sign, sign * end + slack)
        if point is not None:
            value = dict(point.outcome.next)[state.name]
            yield deep.finding(
                Code.LEAVES_RANGE,
                f"the next value of {state.name} is {value:.6g}, outside [{state.low:g}, {state.high:g}], at {point}",
                span_of(update.origin),
                help="a simulation ends there; widen the range, or forbid such steps by MUST",
                labels=(Label(deep.declared[state.name], "its range comes from here"),) * (state.name in deep.declared),
                point=point,
            )


def _beyond(deep: Deep, state: Variable, sign: float, limit: float) -> Point | None:
    """A step after which a state, with the sign turned or not, is above a limit."""

    def is_beyond(point: Point) -> bool:
        return point.outcome.exists and sign * dict(point.outcome.next)[state.name] > limit

    def ask(clear: bool) -> Hunt:
        problem, step = deep.comparison.whole(clear=clear)
        return Hunt(problem, step, {step.next[state.name]: sign}, limit)

    end = "upper" if sign > 0 else "lower"
    question = f"whether {state.name} leaves its range at the {end} end"
    return deep.search(ask, is_beyond, question)[1]
