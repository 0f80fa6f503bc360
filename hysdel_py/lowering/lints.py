"""Warnings about a Dha whose items compile and are still not what they seem.

Everything here follows by interval arithmetic over the declared ranges, or by the truth table of the logic: nothing is
said that is not true of every state and input inside the ranges.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic, Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import Ranges
from hysdel_py.lowering.truth import constant_truth
from hysdel_py.semantics.expressions import Expression, leaves
from hysdel_py.semantics.typed_model import Choice, Equation, Item, Requirement, Threshold, TypedModel
from hysdel_py.syntax.source import Span
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, AffineRequirement, Dha, Event, LogicRequirement, Switch
from hysdel_py.systems.formula import Formula
from hysdel_py.systems.origin import Origin

__all__ = ["BIG_M_LIMIT", "EPSILON_LIMIT", "lint"]

Interval = tuple[float, float]

BIG_M_LIMIT = 1e6
"""Big-M constants above this leave a solver with 1e-6 as tolerance no room: d = 1e-6 moves a row by one unit."""

EPSILON_LIMIT = 1e-7
"""A gap below this is within what solvers call satisfied, so both sides of a threshold are."""

_LOOSE_FACTOR = 10.0  # a declared range is called loose if it is that many times wider than the computed one


def lint(model: TypedModel, dha: Dha, sink: Sink) -> None:
    """Report what is suspicious in a model that has been lowered without an error."""
    checks = _Checks(model, dha, sink)
    for item in dha.items:
        if item.origin.subgroup > 1:  # generated definitions say nothing that their item does not
            continue
        match item:
            case Event():
                checks.event(item)
            case Switch():
                checks.switch(item)
            case AffineRequirement():
                checks.comparison(item)
            case LogicRequirement():
                checks.requirement(item)
            case AffineEquation(item="Linear"):
                checks.definition(item)
    checks.conditions()
    checks.missing_bounds()
    _drop_repetitions(sink)


def _drop_repetitions(sink: Sink) -> None:
    """A condition that is constant by its form explains why a branch is dead."""
    conditions = [d.span for d in sink.diagnostics if d.code is Code.CONSTANT_CONDITION and d.span]

    def explained(found: Diagnostic) -> bool:
        span = found.span
        return (
            found.code is Code.DEAD_BRANCH
            and span is not None
            and any(span.start <= inner.start and inner.end <= span.end for inner in conditions)
        )

    sink.forget(explained)


class _Checks:
    """The checks of single items, with the ranges that they share."""

    def __init__(self, model: TypedModel, dha: Dha, sink: Sink) -> None:
        self._model = model
        self._sink = sink
        self._ranges = Ranges(dha, Sink())  # what the ranges themselves report has been reported before
        self._symbols = {symbol.name: symbol for symbol in model.symbols}
        self._items = {item.number: item for item in model.items}

    def event(self, event: Event) -> None:
        """A threshold that never switches, is constant, has a huge range or a tiny gap."""
        low, high = self._range(event.form)
        always = "true" if high <= 0 else "false" if low > _slack(low) else ""
        if always and not _variables(event.form):
            if not self._with_parameters(event.origin):
                self._warn(
                    Code.CONSTANT_COMPARISON, f"{event.name} is always {always}: no variable is compared", event.origin
                )
        elif always:
            fact = f"{event.name} is always {always} inside the declared ranges: {_bounds(event.form, low, high)}"
            self._warn(Code.NEVER_SWITCHES, fact, event.origin, labels=self._sources(event.form))
        if event.epsilon < EPSILON_LIMIT:
            self._warn(
                Code.SMALL_EPSILON,
                f"the gap {event.epsilon:g} of {event.name} is smaller than the tolerance {EPSILON_LIMIT:g} of solvers",
                event.origin,
                help="make MLD_epsilon larger, or scale the variables",
            )
        self._size(event.limits or (low, high), [event.form], event.origin)

    def switch(self, switch: Switch) -> None:
        """A choice whose branches have huge ranges, or one whose declared range is loose."""
        for form, limits in ((switch.then, switch.then_limits), (switch.otherwise, switch.otherwise_limits)):
            self._size(limits or self._range(form), [form], switch.origin)
        ends = [self._range(switch.then), self._range(switch.otherwise)]
        self._loose(switch.name, (min(low for low, _ in ends), max(high for _, high in ends)))

    def definition(self, equation: AffineEquation) -> None:
        """A real auxiliary whose declared range is loose."""
        self._loose(equation.name, self._range(equation.value))

    def comparison(self, requirement: AffineRequirement) -> None:
        """A comparison in MUST that never or always holds."""
        form = requirement.value
        low, high = self._range(form)
        if low > _slack(low):
            what = _bounds(form, low, high) if _variables(form) else "no variable is compared"
            self._never(requirement.origin, what, self._sources(form))
        elif high <= 0 and _variables(form):
            # Repeating a declared range is common and makes it a row of the MLD form.
            self._always(requirement.origin, "inside the declared ranges", self._sources(form))
        elif high <= 0 and not self._with_parameters(requirement.origin):
            self._warn(Code.CONSTANT_COMPARISON, "this always holds: no variable is compared", requirement.origin)

    def requirement(self, requirement: LogicRequirement) -> None:
        """A formula in MUST that is a contradiction or a tautology."""
        truth = constant_truth(requirement.value)
        if truth is False:
            self._never(requirement.origin, "the formula is false for all values", ())
        elif truth is True and not self._with_parameters(requirement.origin):
            self._always(requirement.origin, "for all values", ())

    def conditions(self) -> None:
        """IF conditions that are constant by their form; those that parameters decide are meant to be."""
        for item in self._model.items:
            if isinstance(item.body, Choice) and not _has_parameters(item.body.condition):
                truth = constant_truth(_formula(item.body.condition))
                if truth is not None:
                    self._sink.warning(
                        Code.CONSTANT_CONDITION,
                        f"this condition is always {'true' if truth else 'false'}",
                        item.body.condition.span,
                        help=f"only the {'THEN' if truth else 'ELSE'} branch is ever used",
                    )

    def missing_bounds(self) -> None:
        """Real states and inputs without a range."""
        assumed = {d.span for d in self._sink.diagnostics if d.code is Code.ASSUMED_BOUNDS}
        for symbol in self._model.symbols:
            if symbol.span in assumed:
                continue
            if symbol.is_real and symbol.bounds is None and symbol.role.name in ("STATE", "INPUT"):
                self._sink.note(
                    Code.MISSING_BOUNDS,
                    f"the {symbol.spoken} {symbol.name} has no range: simulation cannot check it",
                    symbol.span,
                )

    def _range(self, form: Affine) -> Interval:
        """Range of a form, infinite where it is not known."""
        return form.range(self._ranges.of_variable)

    def _size(self, limits: Interval, forms: list[Affine], origin: Origin) -> None:
        size = max(map(abs, limits))
        if not BIG_M_LIMIT < size < math.inf:
            return
        self._warn(
            Code.LARGE_BIG_M,
            f"the big-M constant {size:g} of this item is so large that the tolerances of solvers blur it",
            origin,
            help="declare tighter ranges or scale the variables",
            labels=tuple(label for form in forms for label in self._sources(form)),
        )

    def _loose(self, name: str, computed: Interval) -> None:
        symbol = self._symbols.get(name)
        if symbol is None or symbol.bounds is None:
            return
        low, high = self._ranges.of_variable(name)
        wide, narrow = high - low, computed[1] - computed[0]
        if math.isfinite(wide) and narrow > 0 and wide > _LOOSE_FACTOR * narrow:
            self._sink.warning(
                Code.LOOSE_BOUNDS,
                f"the declared range [{low:g}, {high:g}] of {name} is much wider than [{computed[0]:g}, "
                f"{computed[1]:g}], which follows from its definition",
                symbol.span,
                help="without a declared range the computed one is used, which gives tighter relaxations",
            )

    def _never(self, origin: Origin, reason: str, labels: tuple[Label, ...]) -> None:
        self._warn(Code.MUST_NEVER_HOLDS, f"this can never hold: {reason}", origin, labels=labels)

    def _always(self, origin: Origin, reason: str, labels: tuple[Label, ...]) -> None:
        span = Span(origin.start, origin.end)
        self._sink.note(Code.MUST_ALWAYS_HOLDS, f"this always holds {reason}", span, labels=labels)

    def _warn(
        self, code: Code, message: str, origin: Origin, *, help: str = "", labels: tuple[Label, ...] = ()
    ) -> None:
        self._sink.warning(code, message, Span(origin.start, origin.end), help=help, labels=labels)

    def _sources(self, form: Affine) -> tuple[Label, ...]:
        """Where the ranges of the variables of a form are declared."""
        return tuple(self._declarations(form))

    def _declarations(self, form: Affine) -> Iterator[Label]:
        for name in _variables(form):
            symbol = self._symbols.get(name)
            if symbol is not None and symbol.line and symbol.is_real:
                origin = "its range comes from here" if symbol.bounds else "its range follows from its definition"
                yield Label(symbol.span, origin)

    def _with_parameters(self, origin: Origin) -> bool:
        """Whether parameters take part in an item; what they decide is not the fault of the text."""
        item = self._items.get(origin.group)
        return item is not None and any(map(_has_parameters, _sides(item)))


def _slack(end: float) -> float:
    """Room for rounding at the end of a range."""
    return 1e-9 * max(1.0, abs(end)) if math.isfinite(end) else 0.0


def _sides(item: Item) -> tuple[Expression, ...]:
    match item.body:
        case Threshold(left=left, right=right):
            return left, right
        case Equation(value=value) | Requirement(value=value):
            return (value,)
        case _:
            return ()


def _has_parameters(expression: Expression) -> bool:
    return any(symbol.is_parameter for symbol in leaves(expression))


def _variables(form: Affine) -> list[str]:
    return [name for name, coefficient in form.terms if coefficient]


def _bounds(form: Affine, low: float, high: float) -> str:
    return f"{form} lies between {low:g} and {high:g}"


def _formula(expression: Expression) -> Formula:
    from hysdel_py.lowering.expressions import ExpressionLowering

    return ExpressionLowering({}, Sink()).formula(expression, _Placeholders())


class _Placeholders:
    """Names for what an expression would generate, the same for the same; nothing is generated."""

    def __init__(self) -> None:
        self._names: dict[object, str] = {}

    def _name(self, *key: object) -> str:
        return self._names.setdefault(key, f"({len(self._names) + 1})")

    def cast(self, formula: Formula) -> str:
        return self._name(formula)

    def event(self, form: Affine) -> str:
        return self._name(form)

    def switch(self, condition: Formula, then: Affine, otherwise: Affine) -> str:
        return self._name(condition, then, otherwise)
