"""One step of a Dha as mixed-integer rows, written independently of the lowering to the MLD form.

It is the yardstick that lowered models are measured against, so it shares nothing with them: ranges follow the
definitions and never the declared range of an auxiliary or a stated [min, max], logic is encoded connective by
connective (G. Tseitin, "On the complexity of derivation in propositional calculus", 1968) instead of by clauses, and a
threshold keeps away from its false side by a band of its own. Every row carries the item and the time step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from math import inf, isfinite

from hysdel_py.analysis.milp import Milp, Source
from hysdel_py.analysis.tseitin import formula_variable
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
from hysdel_py.systems.signals import Variable

__all__ = [
    "Distance", "Interval", "Places", "Ranges", "Step", "add_terms", "auxiliary_variables", "encode_items",
    "encode_step", "formula_variable", "nothing", "ranges_by_definition", "shared_variables",
]  # fmt: skip

Interval = tuple[float, float]
Places = Mapping[str, int]
Ranges = Mapping[str, Interval]

OUTWARDS = 1e-9
"""By how much ranges are widened, relative to their ends, so that rounding never cuts a point off."""

UPDATES_AND_OUTPUTS = frozenset({"Continuous", "Automata", "Cont_output", "Logic_output"})


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


Distance = Callable[[Event], float]


def _own_epsilon(event: Event) -> float:
    return event.epsilon


def nothing(event: Event) -> float:  # noqa: ARG001
    """No distance: events may lie on their thresholds."""
    return 0.0


def shared_variables(problem: Milp, variables: Iterable[Variable]) -> dict[str, int]:
    """New variables of a problem with the declared ranges."""
    return {v.name: problem.boolean() if v.is_bool else problem.real(v.low, v.high) for v in variables}


def encode_step(
    problem: Milp,
    dha: Dha,
    given: Places,
    *,
    step: int = 0,
    band: Distance = _own_epsilon,
    below: Distance = nothing,
    leave_out: Callable[[DhaItem], bool] = lambda item: False,  # noqa: ARG005
    ranges: Ranges | None = None,
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
    below : callable, optional
        How far it is below zero where the event is true; by default it may be zero.
    leave_out : callable, optional
        Items whose rows are not wanted; a variable that such an item defines is free within its range.
    ranges : mapping of name to interval, optional
        Where the variables are, for the constants of the rows and as bounds of the auxiliaries; the ranges by
        definition by default.

    Raises
    ------
    ArgumentError
        If a variable that needs a finite range has none, or an auxiliary is used and never defined.
    """
    if dha.undefined_but_used:
        names = ", ".join(dha.undefined_but_used)
        raise ArgumentError(f"the auxiliary variable {names} is used but never defined: the model has no step")
    ranges = ranges_by_definition(dha) if ranges is None else ranges
    values = {**given, **auxiliary_variables(problem, (*dha.d, *dha.z), ranges)}
    after = {v.name: problem.boolean() if v.is_bool else problem.real() for v in dha.x}
    outputs = {v.name: problem.boolean() if v.is_bool else problem.real() for v in dha.y}
    chosen = [item for item in dha.items if not leave_out(item)]
    encode_items(problem, chosen, values, ranges, results={**after, **outputs}, step=step, band=band, below=below)
    for variable in (*dha.d, *dha.z, *dha.x, *dha.y):
        if variable.name not in dha.definitions:
            problem.fix({**values, **after, **outputs}[variable.name], 0.0)
    return Step(values, after, outputs)


def auxiliary_variables(problem: Milp, variables: Iterable[Variable], ranges: Ranges) -> dict[str, int]:
    """New variables of a problem with the ranges that follow from the definitions."""
    found = {}
    for variable in variables:
        low, high = _widened(ranges[variable.name])
        found[variable.name] = problem.boolean() if variable.is_bool else problem.real(low, high)
    return found


def encode_items(
    problem: Milp,
    items: Iterable[DhaItem],
    values: Places,
    ranges: Ranges,
    *,
    results: Places | None = None,
    step: int = 0,
    band: Distance = _own_epsilon,
    below: Distance = nothing,
) -> None:
    """Add the rows of some items.

    Parameters
    ----------
    problem : Milp
    items : iterable of DhaItem
    values : mapping of name to number
        Where the variables are that the items read, and the auxiliaries that they define.
    ranges : mapping of name to interval
        As :func:`ranges_by_definition` gives them.
    results : mapping of name to number, optional
        Where updated states and outputs are.
    step, band, below
        As for :func:`encode_step`.
    """
    rows = _StepRows(problem, ranges, values, step, (band, below))
    for item in items:
        rows.add(item, results or {})


class _StepRows:
    """Writes the rows of items over the variables of one step."""

    def __init__(
        self, problem: Milp, ranges: Ranges, values: Places, step: int, distances: tuple[Distance, Distance]
    ) -> None:
        self._problem = problem
        self._ranges = ranges
        self._values = values
        self._step = step
        self._band, self._below = distances

    def add(self, item: DhaItem, results: Places) -> None:
        source = Source(item.origin, self._step)
        match item:
            case Event():
                self._event(item, source)
            case Switch():
                self._switch(item, source)
            case AffineEquation(value=value):
                self._demand(value, {self._target(item, results): -1.0}, 0.0, 0.0, source)
            case AffineRequirement(value=value):
                self._demand(value, {}, -inf, 0.0, source)
            case LogicEquation(value=value):
                root = formula_variable(self._problem, value, self._values, source)
                terms = {root: 1.0}
                add_terms(terms, self._target(item, results), -1.0)
                self._problem.row(terms, 0.0, 0.0, source)
            case LogicRequirement(value=value):
                self._problem.fix(formula_variable(self._problem, value, self._values, source), 1.0, source)

    def _target(self, item: AffineEquation | LogicEquation, results: Places) -> int:
        """A state has its name twice: before the step among the values, after it among the results."""
        return results[item.name] if item.item in UPDATES_AND_OUTPUTS else self._values[item.name]

    def _demand(self, form: Affine, extra: Mapping[int, float], low: float, high: float, source: Source) -> None:
        """``low <= form + extra <= high``."""
        terms = dict(extra)
        for name, coefficient in form.terms:
            add_terms(terms, self._values[name], coefficient)
        self._problem.row(terms, low - form.constant, high - form.constant, source)

    def _range(self, form: Affine, name: str) -> Interval:
        low, high = _widened(form.range(self._ranges.__getitem__))
        if not (isfinite(low) and isfinite(high)):
            endless = [n for n, c in form.terms if c and not all(map(isfinite, self._ranges[n]))]
            raise ArgumentError(f"{', '.join(endless)} has no finite range, which the definition of {name} needs")
        return low, high

    def _event(self, event: Event, source: Source) -> None:
        low, high = self._range(event.form, event.name)
        above, below = self._band(event), self._below(event)
        d = self._values[event.name]
        self._demand(event.form, {d: high + below}, -inf, high, source)
        self._demand(event.form, {d: above - low}, above, inf, source)

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


def add_terms(terms: dict[int, float], variable: int, coefficient: float) -> None:
    """Add to the coefficient of a variable."""
    terms[variable] = terms.get(variable, 0.0) + coefficient


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
