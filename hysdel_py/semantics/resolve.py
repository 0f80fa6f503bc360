"""Syntax tree to typed model.

Input: an ast.System. Output: a TypedModel whose names are resolved, whose expressions are typed and affine, and whose
left sides are of the right kind. Preserved: the order of declarations and items, and every position.
"""

from __future__ import annotations

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.declarations import declare
from hysdel_py.semantics.expressions import Apply, Expression, is_constant, leaves
from hysdel_py.semantics.older_notes import note_what_the_original_refuses
from hysdel_py.semantics.queries import resolve_queries
from hysdel_py.semantics.symbols import Role, Symbol
from hysdel_py.semantics.typed_model import (
    Body,
    Branch,
    Choice,
    Equation,
    Item,
    Requirement,
    Threshold,
    Triple,
    TypedModel,
)
from hysdel_py.semantics.typing import ExpressionTyper
from hysdel_py.syntax import ast
from hysdel_py.syntax.ast import SectionKind
from hysdel_py.syntax.operators import COMPARISONS, Op
from hysdel_py.syntax.source import Source
from hysdel_py.syntax.structure import conjuncts, ungrouped
from hysdel_py.systems.signals import Type

__all__ = ["resolve"]

_TARGETS: dict[SectionKind, tuple[Role, Type | None]] = {
    SectionKind.AD: (Role.AUX, Type.BOOL),
    SectionKind.DA: (Role.AUX, Type.REAL),
    SectionKind.LOGIC: (Role.AUX, Type.BOOL),
    SectionKind.LINEAR: (Role.AUX, Type.REAL),
    SectionKind.CONTINUOUS: (Role.STATE, Type.REAL),
    SectionKind.AUTOMATA: (Role.STATE, Type.BOOL),
    SectionKind.OUTPUT: (Role.OUTPUT, None),
}
_RECURSIVE = frozenset({SectionKind.AD, SectionKind.DA, SectionKind.LOGIC, SectionKind.LINEAR})


def resolve(system: ast.System, source: Source, sink: Sink) -> TypedModel:
    """Resolve a syntax tree; the result is meaningful only if the sink has not failed."""
    symbols = declare(system, source, sink)
    resolver = _ItemResolver(symbols, source, sink)
    items = [r for section in system.sections for item in section.items for r in resolver.items(section.kind, item)]
    queries = resolve_queries(system, symbols, source, sink)
    model = TypedModel(system.name, source, tuple(symbols.values()), tuple(items), queries)
    _check_defined_once(model, sink)
    if not sink.failed:
        _warn_unused_and_undefined(model, sink)
    note_what_the_original_refuses(system, source, sink)
    return model


class _ItemResolver:
    """Resolves one item after the other and numbers them; a conjunction of comparisons in MUST becomes several."""

    def __init__(self, symbols: dict[str, Symbol], source: Source, sink: Sink) -> None:
        self._symbols = symbols
        self._source = source
        self._sink = sink
        self._typer = ExpressionTyper(symbols, sink)
        self._number = 0

    def items(self, section: SectionKind, item: ast.Item) -> list[Item]:
        if isinstance(item, ast.Query):
            return []  # they have no number among the items
        if isinstance(item, ast.Requirement):
            return [self._item(section, None, body, item) for body in self._requirements(item.value)]
        assert not isinstance(item, ast.Loop)  # elaboration leaves scalars
        assert isinstance(item.target, ast.Name)
        target = self._target(section, item.target)
        body = self._body(section, item, target)
        if body is None or target is None:
            return []
        resolved = self._item(section, target, body, item)
        self._check_recursion(resolved)
        return [resolved]

    def _item(
        self, section: SectionKind, target: Symbol | None, body: Body, item: ast.Equation | ast.Choice | ast.Requirement
    ) -> Item:
        self._number += 1
        line, text = self._source.line_of(item.span), self._source.excerpt(item.span)
        return Item(section, self._number, target, body, item.span, line, text, item.continues)

    def _target(self, section: SectionKind, name: ast.Name) -> Symbol | None:
        symbol = self._symbols.get(name.name)
        role, type_ = _TARGETS[section]
        wanted = f"{'an' if type_ is None else _word(type_)} {role.value}"
        if symbol is None:
            self._sink.error(
                Code.UNDECLARED, f"{name.name} is not declared", name.span, help=f"{section.value} defines {wanted}"
            )
            return None
        if symbol.role is not role or type_ not in (None, symbol.type):
            self._sink.error(
                Code.WRONG_LEFT_SIDE,
                f"{section.value} defines {wanted}, {name.name} is a {symbol.spoken}",
                name.span,
                labels=(Label(symbol.span, "declared here"),) if symbol.line else (),
            )
            return None
        return symbol

    def _body(self, section: SectionKind, item: ast.Equation | ast.Choice, target: Symbol | None) -> Body | None:
        match item:
            case ast.Choice():
                return self._choice(item)
            case ast.Equation() if section is SectionKind.AD:
                return self._threshold(item)
            case ast.Equation(value=value, triple=triple):
                if triple is not None:
                    place = "behind a comparison in AD or a branch in DA"
                    message = f"[min, max, epsilon] belongs {place}, not in {section.value}"
                    self._sink.error(Code.NOT_SUPPORTED, message, triple.span)
                typed = self._typer.typed(value, target.type if target else None)
                return None if typed is None else Equation(typed)

    def _threshold(self, item: ast.Equation) -> Threshold | Equation | None:
        typed = self._typer.typed(item.value, None, comparison=True)
        triple = self._triple(item.triple)
        if typed is None or (item.triple is not None and triple is None):
            return None
        written = ungrouped(item.value)
        if not (isinstance(written, ast.Apply) and written.op in COMPARISONS):
            self._sink.error(
                Code.NOT_A_COMPARISON,
                "AD needs a comparison, this is "
                + ("a Boolean" if typed.type is Type.BOOL else "a real")
                + " expression",
                typed.span,
                help="write name = left <= right or name = left >= right; Boolean definitions belong into LOGIC",
            )
            return None
        threshold = _comparison(typed, triple)
        if triple is not None and (threshold is None or threshold.at_least):
            self._sink.error(
                Code.NOT_SUPPORTED, "[min, max, epsilon] goes with <= only", triple.span,
                help="write the condition as expression <= 0",
            )  # fmt: skip
        return threshold or Equation(typed)

    def _choice(self, item: ast.Choice) -> Choice | None:
        condition = self._typer.typed(item.condition, Type.BOOL)
        then = self._branch(item.then, item.then_triple)
        otherwise = None if item.otherwise is None else self._branch(item.otherwise, item.otherwise_triple)
        if condition is None or then is None or (item.otherwise is not None and otherwise is None):
            return None
        return Choice(condition, then, otherwise)

    def _branch(self, value: ast.Expression, triple: ast.Triple | None) -> Branch | None:
        typed = self._typer.typed(value, Type.REAL)
        limits = self._triple(triple)
        return None if typed is None or (triple is not None and limits is None) else Branch(typed, limits)

    def _requirements(self, expression: ast.Expression) -> list[Body]:
        """What has to hold; a conjunction with comparisons in it holds part by part."""
        parts = conjuncts(expression)
        if len(parts) == 1 or not any(isinstance(part, ast.Apply) and part.op in COMPARISONS for part in parts):
            parts = [ungrouped(expression)]
        else:
            self._sink.note(
                Code.EXTENSION, "HYSDEL 2.0.5 takes comparisons only as a whole in AD and MUST", expression.span
            )
        return [body for part in parts for body in self._requirement(part)]

    def _requirement(self, expression: ast.Expression) -> list[Body]:
        if isinstance(expression, ast.Apply) and expression.op is Op.EQ:
            return self._equality(expression)
        typed = self._typer.typed(expression, Type.BOOL, comparison=True)
        if typed is None:
            return []
        return [_comparison(typed, None) or Requirement(typed)]

    def _equality(self, expression: ast.Apply) -> list[Body]:
        """An equality between real expressions: two inequalities."""
        self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no equality in MUST", expression.span)
        left, right = (self._typer.typed(side, Type.REAL) for side in expression.args)
        if left is None or right is None:
            return []
        return [Threshold(left, right, at_least=False), Threshold(left, right, at_least=True)]

    def _triple(self, triple: ast.Triple | None) -> Triple | None:
        if triple is None:
            return None
        parts = [self._typer.typed(part, Type.REAL) for part in (triple.low, triple.high, triple.epsilon)]
        known = [part for part in parts if part is not None]
        for part in known:
            if not is_constant(part):
                self._sink.error(
                    Code.NOT_CONSTANT, "[min, max, epsilon] must be constant, this holds a variable", part.span
                )
        if len(known) < 3 or not all(map(is_constant, known)):
            return None
        return Triple(known[0], known[1], known[2], triple.span)

    def _check_recursion(self, item: Item) -> None:
        if item.section in _RECURSIVE and item.target in item.depends():
            name = item.target.name if item.target else ""
            self._sink.error(
                Code.DEFINED_BY_ITSELF,
                f"{name} is defined by itself",
                item.span,
                labels=(Label(item.target.span, "declared here"),) if item.target else (),
                help="only states have a value from the step before; use a state",
            )


def _word(type_: Type) -> str:
    return "a real" if type_ is Type.REAL else "a Boolean"


def _comparison(typed: Expression, triple: Triple | None) -> Threshold | None:
    if isinstance(typed, Apply) and typed.op in (Op.LE, Op.GE):
        return Threshold(typed.args[0], typed.args[1], typed.op is Op.GE, triple)
    return None


def _check_defined_once(model: TypedModel, sink: Sink) -> None:
    first: dict[str, Item] = {}
    for item in model.items:
        if item.target is None:
            continue
        earlier = first.setdefault(item.target.name, item)
        if earlier is not item:
            sink.error(
                Code.DEFINED_TWICE,
                f"{item.target.name} is already defined",
                item.span,
                labels=(Label(earlier.span, "defined here"),),
            )


def _warn_unused_and_undefined(model: TypedModel, sink: Sink) -> None:
    used = {symbol.name for item in model.items for symbol in item.depends()}
    used |= {leaf.name for query in model.queries for part in query.expressions() for leaf in leaves(part)}
    defined = {item.target.name for item in model.items if item.target}
    for symbol in model.symbols:
        if symbol.role in (Role.STATE, Role.OUTPUT, Role.AUX) and symbol.name not in defined:
            effect = "its value is free" if symbol.role is Role.AUX else "it is zero"
            sink.warning(
                Code.NEVER_DEFINED, f"the {symbol.spoken} {symbol.name} is never defined: {effect}", symbol.span
            )
        elif symbol.role in (Role.INPUT, Role.AUX) and symbol.name not in used:
            sink.warning(Code.UNUSED, f"the {symbol.spoken} {symbol.name} is never used", symbol.span)
