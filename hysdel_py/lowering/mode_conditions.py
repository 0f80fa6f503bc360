"""What the rows of the regions of modes are called: the conditions of the source behind them."""

from __future__ import annotations

from hysdel_py.systems.dha import AffineRequirement, Event, LogicRequirement
from hysdel_py.systems.mode import Condition, RowKind
from hysdel_py.systems.signals import Variable

__all__ = ["of_boolean", "of_event", "of_range", "of_requirement"]


def of_event(event: Event, *, holds: bool = True) -> Condition:
    """One side of a threshold."""
    origin = event.origin
    own = origin.text.removeprefix(f"{event.name} = ")
    text = own if own != origin.text else f"{event.form} <= 0"
    return Condition(RowKind.EVENT, event.name, holds, event.epsilon, text, origin.line)


def of_requirement(requirement: AffineRequirement | LogicRequirement) -> Condition:
    """A requirement."""
    return Condition(RowKind.MUST, "", text=requirement.origin.text, line=requirement.origin.line)


def of_range(variables: tuple[Variable, ...]) -> tuple[Condition, ...]:
    """Greatest values of all variables, then least ones."""
    upper = [Condition(RowKind.RANGE, v.name, text=f"{v.name} <= {v.high:g}", line=v.line) for v in variables]
    lower = [Condition(RowKind.RANGE, v.name, text=f"{v.name} >= {v.low:g}", line=v.line) for v in variables]
    return (*upper, *lower)


def of_boolean(variable: Variable, value: bool | None) -> tuple[Condition, Condition]:
    """Upper and lower end of a Boolean coordinate."""
    low, high = (0, 1) if value is None else (int(value), int(value))
    kind, line = RowKind.BOOLEAN, variable.line
    return (
        Condition(kind, variable.name, text=f"{variable.name} <= {high}", line=line),
        Condition(kind, variable.name, text=f"{variable.name} >= {low}", line=line),
    )
