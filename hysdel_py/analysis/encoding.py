"""One step of a Dha as mixed-integer rows, written independently of the lowering to the MLD form.

It is the yardstick that lowered models are measured against, so it shares nothing with them: ranges follow the
definitions and never the declared range of an auxiliary or a stated [min, max], logic is encoded connective by
connective (G. Tseitin, "On the complexity of derivation in propositional calculus", 1968) instead of by clauses, and a
threshold keeps away from its false side by a band of its own. Every row carries the item and the time step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, isfinite

from hysdel_py.analysis.milp import Milp, Source
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import (
    AffineEquation,
    AffineRequirement,
    Dha,
    DhaItem,
    Event,
    LogicEquation,
    LogicRequirement,
    Switch,
)
from hysdel_py.systems.formula import Connective, Formula
from hysdel_py.systems.signals import Variable

__all__ = ["Places", "Step", "encode_step", "formula_variable", "ranges_by_definition", "shared_variables"]

Interval = tuple[float, float]
Places = Mapping[str, int]

OUTWARDS = 1e-9
"""By how much ranges are widened, relative to their ends, so that rounding never cuts a point off."""


@dataclass(frozen=True, slots=True)
class Step:
    """Where the variables of one step are in a problem.

    Attributes
    ----------
    values : mapping of name to number
        States, inputs and auxiliaries.
    next : mapping of name to number
        States after the step.
    outputs : mapping of name to number
    """

    values: Places
    next: Places
    outputs: Places


def shared_variables(problem: Milp, variables: tuple[Variable, ...]) -> dict[str, int]:
    """New variables of a problem with the declared ranges."""
    return {v.name: problem.boolean() if v.is_bool else problem.real(v.low, v.high) for v in variables}


def encode_step(
    problem: Milp,
    dha: Dha,
    given: Places,
    *,
    step: int = 0,
    band: Callable[[Event], float] | None = None,
    leave_out: Callable[[DhaItem], bool] = lambda item: False,  # noqa: ARG005
    ranges: Mapping[str, Interval] | None = None,
) -> Step:
    """Add the rows of one step.

    Parameters
    ----------
    problem : Milp
        Gets new variables and rows.
    dha : Dha
    given : mapping of name to number
        Where the states and inputs of the step are.
    step : int
        Time, for the sources of the rows.
    band : callable, optional
        How far the form of an event is above zero where the event is false; its own epsilon by default.
    leave_out : callable, optional
        Items whose rows are not wanted; a variable that such an item defines is free within its range.
    ranges : mapping of name to interval, optional
        Where the variables are, for the constants of the rows and as bounds of the auxiliaries; the ranges by
        definition by default.

    Raises
    ------
    ArgumentError
        If a variable that needs a finite range has none.
    """
    ranges = ranges_by_definition(dha) if ranges is None else ranges
    values = dict(given)
    for variable in (*dha.d, *dha.z):
        low, high = _widened(ranges[variable.name])
        values[variable.name] = problem.boolean() if variable.is_bool else problem.real(low, high)
    after = {v.name: problem.boolean() if v.is_bool else problem.real() for v in dha.x}
    outputs = {v.name: problem.boolean() if v.is_bool else problem.real() for v in dha.y}
    targets = {**values, **after, **outputs}
    rows = _StepRows(problem, ranges, values, step, band or (lambda event: event.epsilon))
    for item in dha.items:
        if not leave_out(item):
            rows.add(item, targets)
    for variable in (*dha.x, *dha.y):
        if variable.name not in dha.definitions:
            problem.fix(targets[variable.name], 0.0)
    return Step(values, after, outputs)


class _StepRows:
    """Writes the rows of items over the variables of one step."""

    def __init__(
        self,
        problem: Milp,
        ranges: Mapping[str, Interval],
        values: Places,
        step: int,
        band: Callable[[Event], float],
    ) -> None:
        self._problem = problem
        self._ranges = ranges
        self._values = values
        self._step = step
        self._band = band

    def add(self, item: DhaItem, targets: Places) -> None:
        source = Source(item.origin, self._step)
        match item:
            case Event():
                self._event(item, self._band(item), source)
            case Switch():
                self._switch(item, source)
            case AffineEquation(name=name, value=value):
                self._demand(value, {targets[name]: -1.0}, 0.0, 0.0, source)
            case AffineRequirement(value=value):
                self._demand(value, {}, -inf, 0.0, source)
            case LogicEquation(name=name, value=value):
                root = formula_variable(self._problem, value, self._values, source)
                self._problem.row({root: 1.0, targets[name]: -1.0}, 0.0, 0.0, source)
            case LogicRequirement(value=value):
                self._problem.fix(formula_variable(self._problem, value, self._values, source), 1.0, source)

    def _demand(self, form: Affine, extra: Mapping[int, float], low: float, high: float, source: Source) -> None:
        """``low <= form + extra <= high``."""
        terms = dict(extra)
        for name, coefficient in form.terms:
            place = self._values[name]
            terms[place] = terms.get(place, 0.0) + coefficient
        self._problem.row(terms, low - form.constant, high - form.constant, source)

    def _range(self, form: Affine, name: str) -> Interval:
        low, high = _widened(form.range(self._ranges.__getitem__))
        if not (isfinite(low) and isfinite(high)):
            endless = [n for n, c in form.terms if c and not all(map(isfinite, self._ranges[n]))]
            raise ArgumentError(f"{', '.join(endless)} has no finite range, which the definition of {name} needs")
        return low, high

    def _event(self, event: Event, band: float, source: Source) -> None:
        low, high = self._range(event.form, event.name)
        d = self._values[event.name]
        self._demand(event.form, {d: high}, -inf, high, source)
        self._demand(event.form, {d: band - low}, band, inf, source)

    def _switch(self, switch: Switch, source: Source) -> None:
        z, s = self._values[switch.name], self._values[switch.condition.name]
        own = self._ranges[switch.name]
        for form, active in (
            (switch.then, switch.condition.positive),
            (switch.otherwise, not switch.condition.positive),
        ):
            low, high = self._range(form, switch.name)
            least, most = low - own[1], high - own[0]
            if active:  # the difference may be anything where s = 0
                self._demand(form, {z: -1.0, s: most}, -inf, most, source)
                self._demand(form, {z: -1.0, s: least}, least, inf, source)
            else:
                self._demand(form, {z: -1.0, s: -most}, -inf, 0.0, source)
                self._demand(form, {z: -1.0, s: -least}, 0.0, inf, source)


def formula_variable(problem: Milp, formula: Formula, values: Places, source: Source) -> int:
    """A variable that is 1 where a formula over Booleans holds and 0 elsewhere."""
    stack: list[int] = []
    for entry in formula.postfix:
        match entry:
            case str():
                stack.append(values[entry])
            case bool():
                stack.append(problem.real(float(entry), float(entry)))
            case Connective.NOT:
                stack.append(_negation(problem, stack.pop(), source))
            case _:
                right, left = stack.pop(), stack.pop()
                stack.append(_connected(problem, entry, left, right, source))
    return stack[0]


def _negation(problem: Milp, a: int, source: Source) -> int:
    c = problem.real(0.0, 1.0)
    problem.row({c: 1.0, a: 1.0}, 1.0, 1.0, source)
    return c


def _connected(problem: Milp, connective: Connective, left: int, right: int, source: Source) -> int:
    match connective:
        case Connective.AND:
            return _conjunction(problem, left, right, source)
        case Connective.OR:
            return _disjunction(problem, left, right, source)
        case Connective.IMPLIES:
            return _disjunction(problem, _negation(problem, left, source), right, source)
        case Connective.IMPLIED_BY:
            return _disjunction(problem, left, _negation(problem, right, source), source)
        case _:
            return _equivalence(problem, left, right, source)


def _add(terms: Mapping[int, float], variable: int, coefficient: float) -> dict[int, float]:
    return {**terms, variable: terms.get(variable, 0.0) + coefficient}


def _conjunction(problem: Milp, a: int, b: int, source: Source) -> int:
    c = problem.real(0.0, 1.0)
    problem.row({c: 1.0, a: -1.0}, high=0.0, source=source)
    problem.row({c: 1.0, b: -1.0}, high=0.0, source=source)
    problem.row(_add({c: 1.0, a: -1.0}, b, -1.0), low=-1.0, source=source)
    return c


def _disjunction(problem: Milp, a: int, b: int, source: Source) -> int:
    c = problem.real(0.0, 1.0)
    problem.row({c: 1.0, a: -1.0}, low=0.0, source=source)
    problem.row({c: 1.0, b: -1.0}, low=0.0, source=source)
    problem.row(_add({c: 1.0, a: -1.0}, b, -1.0), high=0.0, source=source)
    return c


def _equivalence(problem: Milp, a: int, b: int, source: Source) -> int:
    c = problem.real(0.0, 1.0)
    if a == b:
        problem.fix(c, 1.0, source)
        return c
    problem.row({c: 1.0, a: -1.0, b: -1.0}, low=-1.0, source=source)
    problem.row({c: 1.0, a: 1.0, b: 1.0}, low=1.0, source=source)
    problem.row({c: 1.0, a: 1.0, b: -1.0}, high=1.0, source=source)
    problem.row({c: 1.0, a: -1.0, b: 1.0}, high=1.0, source=source)
    return c


def ranges_by_definition(dha: Dha) -> dict[str, Interval]:
    """Ranges of states and inputs as declared, of auxiliaries by interval arithmetic over their definitions.

    In an algebraic loop there is no order; there the declared range of an auxiliary is taken.
    """
    ranges = {v.name: (v.low, v.high) for v in (*dha.x, *dha.u, *dha.d, *dha.z)}
    for name in dha.evaluation_order:
        match dha.definitions.get(name):
            case Switch(then=then, otherwise=otherwise):
                ends = [then.range(ranges.__getitem__), otherwise.range(ranges.__getitem__)]
                ranges[name] = (min(low for low, _ in ends), max(high for _, high in ends))
            case AffineEquation(value=value):
                ranges[name] = value.range(ranges.__getitem__)
    return ranges


def _widened(interval: Interval) -> Interval:
    low, high = interval
    slack = OUTWARDS * max(1.0, *(abs(end) for end in interval if isfinite(end)), 0.0)
    return low - slack, high + slack
