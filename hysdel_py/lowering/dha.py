"""TypedModel to Dha.

Input: a TypedModel and values for its parameters. Output: a Dha whose conditions are literals and whose affine forms
are over variables only; every compound condition and compound cast got a Boolean of its own. Preserved: the order of
items, and for each item its place in the source.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.cnf import TooManyClauses, cnf
from hysdel_py.lowering.constants import Constants
from hysdel_py.lowering.expressions import ExpressionLowering, mentions_constant
from hysdel_py.lowering.generated import Generated, check_finite
from hysdel_py.lowering.truth import MAX_NAMES, constant_truth
from hysdel_py.semantics.expressions import Expression
from hysdel_py.semantics.symbols import BIG_M_BOUND, EPSILON, Role, Symbol
from hysdel_py.semantics.typed_model import Branch, Choice, Equation, Item, Requirement, Threshold, Triple, TypedModel
from hysdel_py.syntax.ast import SectionKind
from hysdel_py.syntax.source import Span
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
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.signals import Kind, Type, Variable
from hysdel_py.systems.symbolic import greatest, is_finite, is_undefined, least

__all__ = ["to_dha"]

_AFFINE_ITEM = {
    SectionKind.LINEAR: "Linear",
    SectionKind.CONTINUOUS: "Continuous",
    SectionKind.OUTPUT: "Cont_output",
}
_LOGIC_ITEM = {
    SectionKind.AD: "Logic",  # a strict comparison is the negation of an event
    SectionKind.LOGIC: "Logic",
    SectionKind.AUTOMATA: "Automata",
    SectionKind.OUTPUT: "Logic_output",
}
_UPDATES = frozenset({SectionKind.CONTINUOUS, SectionKind.AUTOMATA, SectionKind.OUTPUT})


def to_dha(model: TypedModel, values: Mapping[str, float], constants: Constants, sink: Sink) -> Dha:
    """Lower a typed model; the result is meaningful only if the sink has not failed.

    Parameters
    ----------
    values : mapping
        A value for every parameter that is used.
    constants : Constants
        What becomes of constant terms in updates and outputs.
    """
    expressions = ExpressionLowering(values, sink)
    lowering = _ItemLowering(model, expressions, constants, sink)
    items = tuple(lowered for item in model.items for lowered in lowering.item(item))

    def vector(role: Role, kind: Kind) -> tuple[Variable, ...]:
        return tuple(_variable(symbol, kind, expressions, sink) for symbol in model.vector(role))

    auxiliaries = model.select(Role.AUX)
    d = tuple(_variable(s, Kind.BOOLEAN_AUX, expressions, sink) for s in auxiliaries if not s.is_real)
    z = tuple(_variable(s, Kind.REAL_AUX, expressions, sink) for s in auxiliaries if s.is_real)
    dha = Dha(
        model.name,
        vector(Role.STATE, Kind.STATE),
        vector(Role.INPUT, Kind.INPUT),
        vector(Role.OUTPUT, Kind.OUTPUT),
        d + tuple(lowering.generated.booleans),
        z + tuple(lowering.generated.reals),
        items + tuple(lowering.generated.items),
        model.source.name,
        default_bound=_default_bound(model, values),
    )
    _warn_of_loop(dha, sink)
    return dha


def _default_bound(model: TypedModel, values: Mapping[str, float]) -> float:
    """Bound of variables without a range; infinite, which is none, where the parameter for it is not declared."""
    declared = any(s.name == BIG_M_BOUND and s.is_parameter for s in model.symbols)
    return values.get(BIG_M_BOUND, math.inf) if declared else math.inf


def _warn_of_loop(dha: Dha, sink: Sink) -> None:
    loop = dha.algebraic_loop
    if loop:
        first = dha.definitions[loop[0]].origin
        sink.warning(
            Code.ALGEBRAIC_LOOP,
            f"algebraic loop {' -> '.join(loop)}: a step exists where exactly one solution does",
            Span(first.start, first.end),
            help="break the loop by a state",
            labels=tuple(_defined_by(dha, name, needed) for name, needed in pairwise(loop))[1:],
        )


def _defined_by(dha: Dha, name: str, needed: str) -> Label:
    origin = dha.definitions[name].origin
    return Label(Span(origin.start, origin.end), f"{name} needs {needed} here")


def _variable(symbol: Symbol, kind: Kind, expressions: ExpressionLowering, sink: Sink) -> Variable:
    low, high = _range(symbol, expressions, sink)
    return Variable(
        symbol.name, symbol.type, kind, low, high, symbol.unit, symbol.description, symbol.line
    )  # fmt: skip


def _range(symbol: Symbol, expressions: ExpressionLowering, sink: Sink) -> tuple[float, float]:
    if not symbol.is_real:
        return 0.0, 1.0
    if symbol.bounds is None:
        return -math.inf, math.inf
    low, high = (expressions.constant(bound) for bound in symbol.bounds)
    if is_undefined(low) or is_undefined(high):
        sink.error(Code.BAD_ARITHMETIC, f"a bound of {symbol.name} is not a number", symbol.span)
    if low > high:
        sink.warning(
            Code.SWAPPED_BOUNDS,
            f"the lower bound {low:g} of {symbol.name} lies above its upper bound {high:g}: they are swapped",
            symbol.span,
        )
    return least(low, high), greatest(low, high)


class _ItemLowering:
    """Lowers items in file order and collects what they generate."""

    def __init__(self, model: TypedModel, expressions: ExpressionLowering, constants: Constants, sink: Sink) -> None:
        self._expressions = expressions
        self._constants = constants
        self._sink = sink
        self._epsilon_is_parameter = any(s.name == EPSILON and s.is_parameter for s in model.symbols)
        self.generated = Generated(self._epsilon, sink)
        self._origin = Origin()

    def item(self, item: Item) -> list[DhaItem]:
        """Lower one item; the list is empty where all of it moved to the generated definitions."""
        depends = tuple(symbol.name for symbol in item.depends())
        self._origin = Origin(
            item.section.value, item.number, 1, item.line, depends, item.text, item.span.start, item.span.end
        )
        self.generated.start(self._origin, continues=item.continues)
        lowered: DhaItem | None
        match item.body:
            case Threshold() as threshold:
                lowered = self._threshold(item, threshold)
            case Choice() as choice:
                lowered = self._choice(item, choice)
            case Equation() as equation:
                lowered = self._equation(item, equation)
            case Requirement(value=value):
                lowered = LogicRequirement(self._formula(value), self._origin)
        if lowered is None:
            return []
        check_finite(lowered, item.span, self._sink)
        return [lowered]

    def _affine(self, expression: Expression) -> Affine:
        return self._expressions.affine(expression, self.generated)

    def _formula(self, expression: Expression) -> Formula:
        return self._expressions.formula(expression, self.generated)

    def _threshold(self, item: Item, threshold: Threshold) -> DhaItem:
        left, right = self._affine(threshold.left), self._affine(threshold.right)
        form = right - left if threshold.at_least else left - right
        if item.target is None:
            return AffineRequirement(form, self._origin)
        limits, epsilon = None, self._epsilon(item.span)
        if threshold.triple is not None:
            limits, epsilon = self._triple(threshold.triple)
            if right.terms or right.constant != 0:
                self._sink.error(
                    Code.TRIPLE_NEEDS_ZERO,
                    "with [min, max, epsilon] the right side of <= must be 0",
                    threshold.right.span,
                    help="move everything to the left side",
                )
        return Event(item.target.name, form, limits, epsilon, self._origin)

    def _epsilon(self, span: Span) -> float:
        if not self._epsilon_is_parameter:
            self._sink.error(
                Code.EPSILON_NOT_PARAMETER,
                f"a comparison needs the parameter {EPSILON}, which is declared as a variable here",
                span,
                help="rename the variable",
            )
            return 0.0
        return self._expressions.values[EPSILON]

    def _triple(self, triple: Triple) -> tuple[tuple[float, float], float]:
        low, high, epsilon = map(self._expressions.constant, (triple.low, triple.high, triple.epsilon))
        if not all(map(is_finite, (low, high, epsilon))) or epsilon < 0:
            self._sink.error(
                Code.BAD_ARITHMETIC,
                f"[min, max, epsilon] is [{low:g}, {high:g}, {epsilon:g}]: finite numbers and epsilon >= 0 are needed",
                triple.span,
            )
        return (least(low, high), greatest(low, high)), epsilon

    def _choice(self, item: Item, choice: Choice) -> DhaItem | None:
        name = item.target.name if item.target else ""
        condition = self.generated.condition(self._formula(choice.condition))
        then, then_limits = self._branch(choice.then)
        otherwise, otherwise_limits = self._branch(choice.otherwise)
        if then.is_constant and otherwise.is_constant:
            self.generated.choose(name, condition, then.constant, otherwise.constant)
            return None
        return Switch(name, condition, then, otherwise, then_limits, otherwise_limits, self._origin)

    def _branch(self, branch: Branch | None) -> tuple[Affine, tuple[float, float] | None]:
        if branch is None:
            return Affine(), None
        limits = None if branch.triple is None else self._triple(branch.triple)[0]
        return self._affine(branch.value), limits

    def _equation(self, item: Item, equation: Equation) -> DhaItem:
        name = item.target.name if item.target else ""
        if equation.value.type is Type.BOOL:
            return self._logic_equation(item, name, self._formula(equation.value))
        value = self._affine(equation.value)
        if item.section in _UPDATES and mentions_constant(equation.value):
            value = self._without_constant(value, item.span)
        return AffineEquation(_AFFINE_ITEM[item.section], name, value, self._origin)

    def _without_constant(self, value: Affine, span: Span) -> Affine:
        if self._constants is Constants.AFFINE:
            return value
        if self._constants is Constants.FORBID:
            self._refuse_constant("a constant term", span)
            return value
        if self.generated.has_made_any:
            self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 crashes at -a with a constant beside (REAL ...)", span)
        return Affine(0.0, (*value.terms, (self.generated.constant(value.constant), 1.0)))

    def _refuse_constant(self, what: str, span: Span) -> None:
        self._sink.error(
            Code.CONSTANT_TERM,
            f"{what} in an update or output is refused by the option for constants",
            span,
            help='use constants="affine" (option -5) or constants="aux" (option -a)',
        )

    def _logic_equation(self, item: Item, name: str, formula: Formula) -> DhaItem:
        kind = _LOGIC_ITEM[item.section]
        if item.section in _UPDATES and _is_tautology(formula):
            formula = Formula((True,))
        if item.section not in _UPDATES or self._fits_row(formula):
            return LogicEquation(kind, name, formula, self._origin)
        if formula.postfix == (True,) and self._constants is Constants.FORBID:
            self._refuse_constant("the constant TRUE", item.span)
        return LogicEquation(kind, name, Formula((self.generated.boolean(formula),)), self._origin)

    def _fits_row(self, formula: Formula) -> bool:
        """Whether a Boolean update can be a row of the update or output matrices as it is."""
        match formula.postfix:
            case (str(),) | (False,):
                return True
            case (True,) | (str(), Connective.NOT):
                return self._constants is Constants.AFFINE
            case _:
                return False


def _is_tautology(formula: Formula) -> bool:
    """Whether a formula is always true; one over many names that has too many clauses counts as not."""
    if len(formula.names) <= MAX_NAMES:
        return constant_truth(formula) is True
    try:
        return not cnf(formula)
    except TooManyClauses:
        return False
