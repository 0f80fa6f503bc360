"""The box that a condition on single states draws around the first states, so that the rows behind it are tighter."""

from __future__ import annotations

from hysdel_py.analysis.monitor import RESULT, Monitor
from hysdel_py.systems.dha import Event, LogicEquation
from hysdel_py.systems.formula import Connective, Formula

__all__ = ["box_around"]

Interval = tuple[float, float]


def box_around(condition: Monitor) -> dict[str, Interval]:
    """Intervals outside of which a condition on states does not hold, as far as its top shows them.

    Read are the parts that the condition joins by AND: a Boolean state, and a threshold of one state.
    """
    box: dict[str, Interval] = {}
    for name, holds in _literals(condition):
        for state, interval in _bounds(condition, name, holds):
            low, high = box.get(state, (-float("inf"), float("inf")))
            box[state] = max(low, interval[0]), min(high, interval[1])
    return {name: interval for name, interval in box.items() if interval[0] <= interval[1]}


def _literals(condition: Monitor) -> list[tuple[str, bool]]:
    """Names that must be true or false wherever the condition holds."""
    definition = condition.dha.definitions[RESULT]
    return _of_formula(definition.value) if isinstance(definition, LogicEquation) else []


def _of_formula(formula: Formula) -> list[tuple[str, bool]]:
    """Literals of a conjunction; a part that is anything else says nothing here."""
    stack: list[list[tuple[str, bool]]] = []
    plain: list[bool] = []  # whether the part is a single literal
    for entry in formula.postfix:
        match entry:
            case bool():
                stack.append([])
                plain.append(False)
            case str():
                stack.append([(entry, True)])
                plain.append(True)
            case Connective.NOT:
                stack[-1] = [(name, not holds) for name, holds in stack[-1]] if plain[-1] else []
            case _:
                right, left = stack.pop(), stack.pop()
                plain.pop()
                plain[-1] = False
                stack.append(left + right if entry is Connective.AND else [])
    return stack[0]


def _bounds(condition: Monitor, name: str, holds: bool) -> list[tuple[str, Interval]]:
    if name in condition.signals:
        return [(condition.signals[name].variable.name, (float(holds), float(holds)))]
    event = condition.dha.definitions.get(name)
    if not isinstance(event, Event) or len(event.form.terms) != 1:
        return []
    (place, slope), *_ = event.form.terms
    end = -event.form.constant / slope
    below = (slope > 0) == holds
    state = condition.signals[place].variable
    return [] if state.is_bool else [(state.name, (-float("inf"), end) if below else (end, float("inf")))]
