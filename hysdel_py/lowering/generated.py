"""The auxiliaries that items generate, and the definitions of these.

They are numbered through in the order in which the items need them. Elements of one item over vectors share the
Booleans of equal conditions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import takewhile

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.source import Span
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, DhaItem, Event, LogicEquation, Switch
from hysdel_py.systems.formula import Formula, Literal
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.signals import Kind, Type, Variable
from hysdel_py.systems.symbolic import is_finite

__all__ = ["Generated", "check_finite"]


class Generated:
    """Collects what the item that is being lowered generates.

    Parameters
    ----------
    epsilon_at : callable
        Gap of a threshold, with an error at the given place if there is none.
    """

    def __init__(self, epsilon_at: Callable[[Span], float], sink: Sink) -> None:
        self.booleans: list[Variable] = []
        self.reals: list[Variable] = []
        self.items: list[DhaItem] = []
        self._epsilon_at = epsilon_at
        self._sink = sink
        self._origin = Origin()
        self._shared: dict[Formula | Affine, str] = {}
        self._continues = False

    def start(self, origin: Origin, *, continues: bool) -> None:
        """Begin with an item; one that continues the vector item before it shares its conditions."""
        self._origin = origin
        if not continues:
            self._shared.clear()
        self._continues = continues

    @property
    def has_made_any(self) -> bool:
        """Whether the item has generated something."""
        return bool(self.items) and self.items[-1].origin.group == self._origin.group

    @property
    def _span(self) -> Span:
        return Span(self._origin.start, self._origin.end)

    def cast(self, formula: Formula) -> str:
        """A new Boolean for the inside of a compound cast."""
        if self._origin.section in ("AD", "DA"):
            self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 crashes at a compound (REAL ...) in AD and DA", self._span)
        return self.boolean(formula)

    def boolean(self, formula: Formula) -> str:
        """A new Boolean that is equal to a formula."""
        name = self._new(Type.BOOL, 0.0, 1.0)
        self._define(LogicEquation("Logic", name, formula, self._next_origin()))
        return name

    def condition(self, formula: Formula) -> Literal:
        """A literal that is equal to a formula: itself, or a new Boolean."""
        if formula.literal is not None:
            return formula.literal
        if not (self._continues and formula in self._shared):
            self._shared[formula] = self.boolean(formula)
        return Literal(self._shared[formula])

    def event(self, form: Affine) -> str:
        """A new Boolean that is true exactly where a form is at most 0."""
        if not (self._continues and form in self._shared):
            name = self._shared[form] = self._new(Type.BOOL, 0.0, 1.0)
            self._define(Event(name, form, None, self._epsilon_at(self._span), self._next_origin()))
        return self._shared[form]

    def switch(self, condition: Formula, then: Affine, otherwise: Affine) -> str:
        """A new real that is one of two forms."""
        literal = self.condition(condition)
        name = self._new(Type.REAL, -math.inf, math.inf)
        if then.is_constant and otherwise.is_constant:
            self.choose(name, literal, then.constant, otherwise.constant)
        else:
            self._define(Switch(name, literal, then, otherwise, None, None, self._next_origin()))
        return name

    def choose(self, name: str, condition: Literal, then: float, otherwise: float) -> None:
        """Define a real by a choice between two numbers, which is affine in the condition."""
        if not condition.positive:
            then, otherwise = otherwise, then
        value = Affine(otherwise, ((condition.name, then - otherwise),))
        # The original counts it as 2 even behind the definition of a compound condition, which is 2 as well.
        self._define(AffineEquation("Linear", name, value, replace(self._origin, subgroup=2)))

    def constant(self, value: float) -> str:
        """A new real that is a number."""
        name = self._new(Type.REAL, value, value)
        self._define(AffineEquation("Linear", name, Affine(value), self._next_origin()))
        return name

    def _define(self, item: DhaItem) -> None:
        check_finite(item, self._span, self._sink)
        self.items.append(item)

    def _new(self, type_: Type, low: float, high: float) -> str:
        name = f"__additional_{len(self.booleans) + len(self.reals) + 1}"
        kind, group = (Kind.BOOLEAN_AUX, self.booleans) if type_ is Type.BOOL else (Kind.REAL_AUX, self.reals)
        origin = self._origin
        group.append(Variable(name, type_, kind, low, high, description=origin.text, line=origin.line, generated=True))
        return name

    def _next_origin(self) -> Origin:
        origin = self._origin
        before = sum(1 for _ in takewhile(lambda item: item.origin.group == origin.group, self.items[::-1]))
        return replace(origin, subgroup=2 + before)


def check_finite(item: DhaItem, span: Span, sink: Sink) -> None:
    """Report an item with a coefficient that is not finite."""
    forms = [getattr(item, field, None) for field in ("form", "then", "otherwise", "value")]
    numbers = [n for form in forms if isinstance(form, Affine) for n in (form.constant, *(c for _, c in form.terms))]
    if not all(map(is_finite, numbers)):
        sink.error(Code.BAD_ARITHMETIC, "this item has a coefficient that is not a finite number", span)
