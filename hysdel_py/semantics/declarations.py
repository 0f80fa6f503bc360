"""Declarations to symbols."""

from __future__ import annotations

import re
from dataclasses import replace

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.expressions import Constant, Expression, is_constant, leaves
from hysdel_py.semantics.symbols import PREDEFINED, Role, Symbol
from hysdel_py.semantics.typing import ExpressionTyper
from hysdel_py.syntax import ast
from hysdel_py.syntax.source import Source, Span
from hysdel_py.systems.signals import Type

__all__ = ["declare"]

_ROLE = {
    ast.SectionKind.STATE: Role.STATE,
    ast.SectionKind.INPUT: Role.INPUT,
    ast.SectionKind.OUTPUT: Role.OUTPUT,
    ast.SectionKind.AUX: Role.AUX,
    ast.SectionKind.PARAMETER: Role.PARAMETER,
}
_UNIT = re.compile(r"\[([^\]]*)\]\s*(.*)", re.DOTALL)


def declare(system: ast.System, source: Source, sink: Sink) -> dict[str, Symbol]:
    """Table of all symbols in the order of declaration, the predefined parameters first.

    Bounds and values have to be constant; a name that is declared twice is an error.
    """
    declared = _first_pass(system, source, sink)
    typer = _ConstantTyper({name: symbol for name, (symbol, _) in declared.items()}, sink)
    return {name: _completed(symbol, declaration, typer) for name, (symbol, declaration) in declared.items()}


def _first_pass(system: ast.System, source: Source, sink: Sink) -> dict[str, tuple[Symbol, ast.Declaration | None]]:
    declared: dict[str, tuple[Symbol, ast.Declaration | None]] = {
        symbol.name: (symbol, None) for symbol in _predefined()
    }
    for section in system.declarations:
        for declaration in section.declarations:
            earlier = declared.get(declaration.name)
            if earlier is not None and earlier[1] is not None:
                sink.error(
                    Code.DECLARED_TWICE,
                    f"{declaration.name} is already declared as a {earlier[0].spoken}",
                    declaration.name_span,
                    labels=(Label(earlier[0].span, "declared here"),),
                )
            else:
                # A redeclared predefined name moves to its place in the file.
                declared.pop(declaration.name, None)
                declared[declaration.name] = (_symbol(declaration, _ROLE[section.kind], source), declaration)
    return declared


def _predefined() -> tuple[Symbol, ...]:
    nowhere = Span(0, 0)
    return tuple(
        Symbol(name, Type.REAL, Role.PARAMETER, nowhere, 0, value=Constant(value, Type.REAL, nowhere))
        for name, value in PREDEFINED.items()
    )


def _symbol(declaration: ast.Declaration, role: Role, source: Source) -> Symbol:
    comment = source.comment_after(declaration.span.end)
    match = _UNIT.fullmatch(comment)
    unit, description = match.groups() if match else ("", comment)
    return Symbol(
        declaration.name,
        Type(declaration.type),
        role,
        declaration.name_span,
        source.line_of(declaration.name_span),
        unit=unit.strip(),
        description=description.strip(),
    )


def _completed(symbol: Symbol, declaration: ast.Declaration | None, typer: _ConstantTyper) -> Symbol:
    """The symbol with its bounds or value."""
    if declaration is None:
        return symbol
    if declaration.interval is not None:
        if symbol.role in (Role.OUTPUT, Role.PARAMETER):
            fact = f"HYSDEL 2.0.5 takes no bounds on the {symbol.spoken} {symbol.name}"
            typer.sink.note(Code.EXTENSION, fact, declaration.interval.span)
        symbol = replace(symbol, bounds=typer.bounds(symbol, declaration.interval))
    if declaration.value is not None:
        return replace(symbol, value=typer.value(symbol, declaration.value))
    if symbol.is_parameter and not symbol.is_real:
        typer.sink.note(Code.EXTENSION, f"HYSDEL 2.0.5 wants a value for the BOOL parameter {symbol.name}", symbol.span)
    return symbol


class _ConstantTyper:
    """Types constant expressions and says so when they are not constant."""

    def __init__(self, symbols: dict[str, Symbol], sink: Sink) -> None:
        self.sink = sink
        self._typer = ExpressionTyper(symbols, sink)

    def bounds(self, symbol: Symbol, interval: ast.Interval) -> tuple[Expression, Expression] | None:
        if not symbol.is_real:
            self.sink.error(
                Code.WRONG_TYPE, f"{symbol.name} is Boolean and takes no bounds: it is 0 or 1", interval.span
            )
            return None
        what = f"the bounds of {symbol.name} must be constant"
        low, high = (self._constant(side, Type.REAL, what) for side in (interval.low, interval.high))
        return None if low is None or high is None else (low, high)

    def value(self, symbol: Symbol, value: ast.Expression) -> Expression | None:
        return self._constant(value, symbol.type, f"the value of the parameter {symbol.name} must be constant")

    def _constant(self, expression: ast.Expression, expected: Type, what: str) -> Expression | None:
        typed = self._typer.typed(expression, expected)
        if typed is None:
            return None
        if is_constant(typed):
            self._note_forward_use(typed)
            return typed
        self.sink.error(
            Code.NOT_CONSTANT, f"{what}, this holds a variable", typed.span, help="use numbers and parameters"
        )
        return None

    def _note_forward_use(self, expression: Expression) -> None:
        for symbol in leaves(expression):
            if symbol.span.start > expression.span.start:
                self.sink.note(
                    Code.EXTENSION,
                    f"HYSDEL 2.0.5 wants the parameter {symbol.name} declared before its use",
                    expression.span,
                )
