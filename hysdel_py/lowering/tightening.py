"""Big-M constants by linear programs: the rule ``lp``.

Input: a Dha and its interval ranges. Output: a rule with constants that are never above those of the interval rule.
Preserved: the points inside the ranges of states and inputs that satisfy all rows with Booleans at 0 or 1. Each
constant bounds its form over the relaxation in which the row is switched off, and the rows of that relaxation hold at
all these points, so no point is lost; ``docs/tight-models.md`` has the table.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import EventConstants, Ranges, SwitchConstants
from hysdel_py.lowering.relaxation import DEFAULT_EFFORT, Effort, Greatest, Relaxation
from hysdel_py.lowering.rows import item_rows
from hysdel_py.syntax.source import Span
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Dha, DhaItem, Event, LogicRequirement, Switch

__all__ = ["Tightened", "tighten"]

Interval = tuple[float, float]
Constants = EventConstants | SwitchConstants


@dataclass(frozen=True, eq=False, slots=True)
class Tightened:
    """Constants of rows and ranges of variables.

    Attributes
    ----------
    constants : mapping of name to EventConstants or SwitchConstants
        By the variable that an event or switch defines.
    narrowed : mapping of name to (low, high)
        Ranges of auxiliaries that are narrower than those of the interval rule; a Boolean that has only one value has
        it as both ends.
    ranges : Ranges
        The interval rule.
    programs : int
        Linear programs that were solved; equal ones count once.
    """

    constants: Mapping[str, Constants]
    narrowed: Mapping[str, Interval]
    ranges: Ranges
    programs: int

    def event(self, event: Event) -> EventConstants:
        """Constants of the two rows of an event."""
        found = self.constants[event.name]
        assert isinstance(found, EventConstants)
        return found

    def switch(self, switch: Switch) -> SwitchConstants:
        """Constants of the four rows of a switch."""
        found = self.constants[switch.name]
        assert isinstance(found, SwitchConstants)
        return found

    def of_variable(self, name: str) -> Interval:
        """Range of a variable, infinite where it is not known."""
        return self.narrowed.get(name) or self.ranges.of_variable(name)


def tighten(dha: Dha, ranges: Ranges, sink: Sink, effort: Effort = DEFAULT_EFFORT) -> Tightened:
    """Compute the constants of all events and switches.

    The result is meaningful only if the sink has not failed: without ranges there is nothing to start from.
    """
    constants: dict[str, Constants] = {}
    for item in dha.items:
        if isinstance(item, Event):
            constants[item.name] = ranges.event(item)
        elif isinstance(item, Switch):
            constants[item.name] = ranges.switch(item)
    if sink.failed:
        return Tightened(constants, {}, ranges, 0)
    work = _Tightening(dha, ranges, constants, sink, effort)
    for _ in range(effort.passes):
        for item in _in_order(dha):
            work.item(item)
    return work.result


def _in_order(dha: Dha) -> list[DhaItem]:
    """Definitions of auxiliaries, each after those that it reads where there is no loop."""
    names = dha.evaluation_order or tuple(v.name for v in (*dha.d, *dha.z))
    return [dha.definitions[name] for name in names if name in dha.definitions]


class _Tightening:
    """The constants while they are computed, and the relaxation that follows them."""

    def __init__(self, dha: Dha, ranges: Ranges, constants: dict[str, Constants], sink: Sink, effort: Effort) -> None:
        self._constants = constants
        self._narrowed: dict[str, Interval] = {}
        self.result = Tightened(constants, self._narrowed, ranges, 0)
        self._sink = sink
        self._effort = effort
        self._row_tolerance = dha.tolerances.row
        self._booleans = frozenset(v.name for v in dha.d)
        self._reals = frozenset(v.name for v in dha.z)
        self._demanded = _demanded(dha)
        self._boxes = _boxes(dha, ranges)
        self._relaxation = Relaxation(dha, self._boxes, self._rows, effort)

    def _rows(self, item: DhaItem) -> tuple[Affine, ...]:
        return tuple(row.form for row in item_rows(item, self.result, Sink()))

    def item(self, item: DhaItem) -> None:
        """Compute what one item needs and replace its rows by the tighter ones."""
        match item:
            case Event():
                self._constants[item.name] = self._event(item)
            case Switch():
                self._constants[item.name] = self._switch(item)
            case AffineEquation(item="Linear", name=name, value=value):
                self._narrow(name, [self._span(value, {}, name)])
                return
            case _:
                return
        self._relaxation.tighten(item, self._rows(item))
        self.result = replace(self.result, programs=self._relaxation.programs)

    def _event(self, event: Event) -> EventConstants:
        """``f >= eps`` is needed where d = 0 and ``f <= 0`` where d = 1; a form that never gets there decides d."""
        old = self._constants[event.name]
        assert isinstance(old, EventConstants)
        off = self._greatest(event.form, {event.name: 0.0}, event.name)
        on = self._greatest(-event.form, {event.name: 1.0}, event.name)
        never_off = off.empty or off.bound < event.epsilon - self._row_tolerance
        never_on = on.empty or -on.bound > self._row_tolerance
        if never_off and never_on:
            return old
        if never_off or never_on:
            self._decide(event.name, 1.0 if never_off else 0.0, event)
        high = self._least(old.high, _held(off, 0.0) if never_off else off.bound)
        low = -self._least(-old.low, _held(on, -event.epsilon) if never_on else on.bound)
        return EventConstants(low, high)

    def _switch(self, switch: Switch) -> SwitchConstants:
        old = self._constants[switch.name]
        assert isinstance(old, SwitchConstants)
        (f1, _), (f2, _) = switch.branches
        s, z = switch.condition.name, switch.name
        forms = ((f1 - f2, 0.0), (f2 - f1, 0.0), (f2 - f1, 1.0), (f1 - f2, 1.0))
        found = [self._greatest(form, {s: value}, z) for form, value in forms]
        dead = [value for value, pair in ((0.0, found[:2]), (1.0, found[2:])) if any(g.empty for g in pair)]
        if len(dead) == 2:
            return old
        if dead:
            self._decide(s, 1.0 - dead[0], switch)
        live = [(form, {s: value}) for form, value in ((f1, 1.0), (f2, 0.0)) if value not in dead]
        self._narrow(z, [self._span(form, fixed, z) for form, fixed in live])
        bounds = [_held(g, 0.0) if value in dead else g.bound for g, (_, value) in zip(found, forms, strict=True)]
        c1, c2, b3, b4 = (self._least(before, bound) for before, bound in zip(old.bounds, bounds, strict=True))
        return SwitchConstants(c1, c2, -b3 + 0.0, -b4 + 0.0)

    def _greatest(self, form: Affine, fixed: Mapping[str, float], without: str) -> Greatest:
        return self._relaxation.greatest(form, fixed, without)

    def _span(self, form: Affine, fixed: Mapping[str, float], without: str) -> Interval:
        return (
            -self._greatest(-form, fixed, without).bound,
            self._greatest(form, fixed, without).bound,
        )

    def _least(self, old: float, new: float) -> float:
        """The new bound where it is an improvement, else the old one to the last digit."""
        return new if new < old - self._effort.gain * max(1.0, abs(old)) else old

    def _decide(self, name: str, value: float, item: Event | Switch) -> None:
        """Note that a Boolean has one value only."""
        if name in self._booleans and name not in self._narrowed:
            self._narrowed[name] = (value, value)
            self._relaxation.narrow(name, (value, value))
        if isinstance(item, Switch) or self._is_news(item):
            span = Span(item.origin.start, item.origin.end)
            self._sink.note(Code.DEAD_BRANCH, _dead(value, item), span, help=_DEAD_HELP)

    def _is_news(self, event: Event) -> bool:
        """Whether neither MUST demands the value outright nor the ranges alone decide it, of which HYS521 tells."""
        low, high = event.form.range(self.result.ranges.of_variable)
        decided = high <= 0 or low > self._row_tolerance
        return not (decided or event.origin.subgroup > 1 or event.name in self._demanded)

    def _narrow(self, name: str, spans: Iterable[Interval]) -> None:
        """Keep the hull of spans as the range of a real auxiliary where it is an improvement."""
        if name not in self._reals:
            return
        lows, highs = zip(*spans, strict=True)
        box = self._within(self._boxes[name], (min(lows), max(highs)))
        self._boxes[name] = box
        self._relaxation.narrow(name, box)
        before = self.result.of_variable(name)
        after = self._within(before, box)
        if after != before:
            self._narrowed[name] = after

    def _within(self, old: Interval, new: Interval) -> Interval:
        low, high = -self._least(-old[0], -new[0]) + 0.0, self._least(old[1], new[1])
        return (low, high) if low <= high else old


def _held(found: Greatest, most: float) -> float:
    """Constant of a row that is never switched off: any does, so one with which the row holds outright."""
    return most if found.empty else min(found.bound, most)


def _demanded(dha: Dha) -> frozenset[str]:
    """Booleans to which a requirement gives a value."""
    literals = (item.value.literal for item in dha.requirements if isinstance(item, LogicRequirement))
    return frozenset(literal.name for literal in literals if literal is not None)


def _boxes(dha: Dha, ranges: Ranges) -> dict[str, Interval]:
    """Ranges that hold whatever the author has promised about auxiliaries."""
    x, u = (
        tuple(replace(v, low=low, high=high) for v in group for low, high in [ranges.of_variable(v.name)])
        for group in (dha.x, dha.u)
    )
    unstated = replace(
        dha,
        x=x,
        u=u,
        z=tuple(replace(v, low=-math.inf, high=math.inf) for v in dha.z),
        items=tuple(map(_without_limits, dha.items)),
    )
    implied = Ranges(unstated, Sink())
    return {v.name: implied.of_variable(v.name) for v in (*dha.x, *dha.u, *dha.d, *dha.z)}


def _without_limits(item: DhaItem) -> DhaItem:
    match item:
        case Event():
            return replace(item, limits=None)
        case Switch():
            return replace(item, then_limits=None, otherwise_limits=None)
        case _:
            return item


_DEAD_HELP = "hysdel audit shows the ranges from which this follows"


def _dead(value: float, item: Event | Switch) -> str:
    """What to say of a Boolean that has one value only."""
    if isinstance(item, Event):
        return f"{item.name} is always {'true' if value else 'false'}: definitions and MUST leave no other value"
    used = "THEN" if bool(value) == item.condition.positive else "ELSE"
    return f"only the {used} branch is ever used: definitions and MUST leave no other"
