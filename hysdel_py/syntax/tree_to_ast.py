"""Builds the syntax tree while the parser reduces, so that no intermediate tree exists and depth does not matter."""

# ruff: noqa: D102 -- the methods carry the names of the rules of the grammar, which say what they are

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lark import Token, Transformer

from hysdel_py.syntax import ast
from hysdel_py.syntax.operators import COMPARISONS, FUNCTIONS, Op
from hysdel_py.syntax.source import Span

__all__ = ["TreeToAst"]

_BINARY = {
    "OR": Op.OR, "AND": Op.AND, "IFF": Op.IFF, "IMPLIES": Op.IMPLIES, "IMPLIED_BY": Op.IMPLIED_BY, "LE": Op.LE,
    "GE": Op.GE, "LT": Op.LT, "GT": Op.GT, "EQ": Op.EQ,
    "PLUS": Op.ADD, "MINUS": Op.SUBTRACT, "TIMES": Op.MULTIPLY, "OVER": Op.DIVIDE, "CARET": Op.POWER,
}  # fmt: skip
_UNARY = {"NOT": Op.NOT, "MINUS": Op.NEGATE}
_FUNCTIONS = {op.value: op for op in FUNCTIONS}


def _span(part: Any) -> Span:
    return Span(part.start_pos or 0, part.end_pos or 0) if isinstance(part, Token) else part.span


def _around(parts: list[Any]) -> Span:
    return Span(_span(parts[0]).start, _span(parts[-1]).end)


def _nodes(parts: list[Any]) -> list[Any]:
    """Parts that are not punctuation or keywords."""
    return [part for part in parts if not isinstance(part, Token)]


def _name(token: Token) -> ast.Name:
    return ast.Name(str(token), _span(token))


def _conditional(parts: list[Any]) -> tuple[Any, Any, Any, Any, Any]:
    """Condition, branch and its triple, other branch and its triple."""
    condition, then, *otherwise = _nodes(parts)
    return (condition, *then.fields, *(otherwise[0].fields if otherwise else (None, None)))


@dataclass(frozen=True, slots=True)
class _Parts:
    """What a rule hands to the rule around it when that is not a node of the syntax tree."""

    fields: tuple[Any, ...]
    span: Span


class TreeToAst(Transformer[Token, Any]):
    """One method per rule of the grammar; each gets all tokens of its rule."""

    def file(self, parts: list[Any]) -> ast.System | None:
        return parts[0] if parts else None

    def system(self, parts: list[Any]) -> ast.System:
        interface, implementation = _nodes(parts)
        declarations = tuple(s for s in interface.fields if isinstance(s, ast.DeclarationSection))
        modules = tuple(m for s in interface.fields if isinstance(s, _Parts) for m in s.fields)
        auxiliaries = tuple(s for s in implementation.fields if isinstance(s, ast.DeclarationSection))
        sections = tuple(s for s in implementation.fields if isinstance(s, ast.ItemSection))
        return ast.System(str(parts[1]), declarations + auxiliaries, sections, _around(parts), modules)

    def interface(self, parts: list[Any]) -> _Parts:
        return _Parts(tuple(_nodes(parts)), _around(parts))

    implementation = interface

    def declarations(self, parts: list[Any]) -> ast.DeclarationSection:
        lines = _nodes(parts)
        declared = tuple(declaration for line in lines for declaration in line.fields)
        return ast.DeclarationSection(ast.SectionKind(str(parts[0])), declared, _around(parts))

    def variables(self, parts: list[Any]) -> _Parts:
        kind, *declared = _nodes(parts)
        return _Parts(tuple(ast.Declaration(kind.name, *d.fields) for d in declared), _around(parts))

    parameters = variables

    def variable(self, parts: list[Any]) -> _Parts:
        size = next((part.fields for part in parts if isinstance(part, _Parts)), ())
        interval = next((part for part in parts if isinstance(part, ast.Interval)), None)
        return _Parts((str(parts[0]), interval, None, _around(parts), _span(parts[0]), size), _around(parts))

    def size(self, parts: list[Any]) -> _Parts:
        return _Parts(tuple(_nodes(parts)), _around(parts))

    pair = size
    row = size

    def module_section(self, parts: list[Any]) -> _Parts:
        return _Parts(tuple(module for line in _nodes(parts) for module in line.fields), _around(parts))

    def modules(self, parts: list[Any]) -> _Parts:
        file, *names = [part for part in parts if part.type == "NAME"]
        return _Parts(tuple(ast.Module(_name(file), _name(name)) for name in names), _around(parts))

    def iterators(self, parts: list[Any]) -> _Parts:
        names = [part for part in parts if part.type == "NAME"]
        declared = (ast.Declaration("INDEX", str(n), None, None, _span(n), _span(n)) for n in names)
        return _Parts(tuple(declared), _around(parts))

    def parameter(self, parts: list[Any]) -> _Parts:
        size = next((part.fields for part in parts if isinstance(part, _Parts)), ())
        interval = next((part for part in parts if isinstance(part, ast.Interval)), None)
        value = next((part for part in _nodes(parts) if not isinstance(part, _Parts | ast.Interval)), None)
        return _Parts((str(parts[0]), interval, value, _around(parts), _span(parts[0]), size), _around(parts))

    def interval(self, parts: list[Any]) -> ast.Interval:
        (low, high), *further = (pair.fields for pair in _nodes(parts))
        return ast.Interval(low, high, _around(parts), tuple(further))

    def type(self, parts: list[Any]) -> ast.Name:
        return _name(parts[0])

    def section(self, parts: list[Any]) -> ast.ItemSection:
        return ast.ItemSection(ast.SectionKind(str(parts[0])), tuple(_nodes(parts)), _around(parts))

    def equation(self, parts: list[Any]) -> ast.Equation:
        target, value, *triple = _nodes(parts)
        return ast.Equation(target, value, triple[0] if triple else None, _around(parts))

    def choice(self, parts: list[Any]) -> ast.Choice:
        return ast.Choice(parts[0], *_conditional(parts[1:]), _around(parts))

    def branch(self, parts: list[Any]) -> _Parts:
        value, *triple = parts
        return _Parts((value, triple[0] if triple else None), _around(parts))

    def otherwise(self, parts: list[Any]) -> _Parts:
        return _Parts(parts[1].fields, _around(parts))

    def conditional(self, parts: list[Any]) -> ast.Conditional:
        return ast.Conditional(*_conditional(parts), _around(parts))

    def requirement(self, parts: list[Any]) -> ast.Requirement:
        return ast.Requirement(parts[0], _around(parts))

    def query(self, parts: list[Any]) -> ast.Query:
        condition, steps, *start = _nodes(parts)
        return ast.Query(ast.QueryKind(str(parts[0])), condition, steps, start[0] if start else None, _around(parts))

    def loop(self, parts: list[Any]) -> ast.Loop:
        closing = next(k for k, part in enumerate(parts) if isinstance(part, Token) and part.type == "RPAR")
        low, *step, high = _nodes(parts[:closing])
        items = tuple(_nodes(parts[closing:]))
        return ast.Loop(_name(parts[2]), low, step[0] if step else None, high, items, _around(parts))

    def triple(self, parts: list[Any]) -> ast.Triple:
        low, high, epsilon = _nodes(parts)
        return ast.Triple(low, high, epsilon, _around(parts))

    def binary(self, parts: list[Any]) -> ast.Apply:
        left, operator, right = parts
        return ast.Apply(_BINARY[operator.type], (left, right), _around(parts))

    def comparison(self, parts: list[Any]) -> ast.Apply:
        """A chain ``a <= b <= c`` is the conjunction of its links."""
        left, operator, right = parts
        op, span = _BINARY[operator.type], _around(parts)
        if not isinstance(left, ast.Apply) or left.op not in COMPARISONS | {Op.AND}:
            return ast.Apply(op, (left, right), span)
        # An AND that no parentheses enclose can only be a shorter chain: comparisons bind tighter.
        last: Any = left.args[1] if left.op is Op.AND else left
        middle = last.args[1]
        return ast.Apply(Op.AND, (left, ast.Apply(op, (middle, right), Span(middle.span.start, span.end))), span)

    def unary(self, parts: list[Any]) -> ast.Apply:
        return ast.Apply(_UNARY[parts[0].type], (parts[1],), _around(parts))

    def number(self, parts: list[Any]) -> ast.Number:
        return ast.Number(float(parts[0]), str(parts[0]), _span(parts[0]))

    def name(self, parts: list[Any]) -> ast.Name:
        return _name(parts[0])

    def indexed(self, parts: list[Any]) -> ast.Indexed:
        return ast.Indexed(str(parts[0]), tuple(_nodes(parts)), _around(parts))

    def matrix(self, parts: list[Any]) -> ast.Matrix:
        return ast.Matrix(tuple(row.fields for row in _nodes(parts)), _around(parts))

    def range(self, parts: list[Any]) -> ast.Range:
        low, *step, high = _nodes(parts)
        return ast.Range(low, step[0] if step else None, high, _around(parts))

    def all(self, parts: list[Any]) -> ast.All:
        return ast.All(_around(parts))

    def transpose(self, parts: list[Any]) -> ast.Apply:
        return ast.Apply(Op.TRANSPOSE, (parts[0],), _around(parts))

    def truth(self, parts: list[Any]) -> ast.Truth:
        return ast.Truth(str(parts[0]) == "TRUE", _span(parts[0]))

    def call(self, parts: list[Any]) -> ast.Apply:
        return ast.Apply(_FUNCTIONS[str(parts[0])], (parts[2],), _around(parts))

    def cast(self, parts: list[Any]) -> ast.Apply:
        return ast.Apply(Op.CAST, (parts[2],), _around(parts))

    def group(self, parts: list[Any]) -> ast.Group:
        return ast.Group(parts[1], _around(parts))
