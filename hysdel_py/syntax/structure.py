"""Looks at the outside of expressions: where they stand, parentheses around them, conjunctions at their top."""

from __future__ import annotations

from collections.abc import Iterator

from hysdel_py.syntax import ast
from hysdel_py.syntax.operators import Op

__all__ = ["conjuncts", "expressions_in", "names_in", "ungrouped"]


def ungrouped(expression: ast.Expression) -> ast.Expression:
    """The expression without the parentheses around it."""
    while isinstance(expression, ast.Group):
        expression = expression.inner
    return expression


def conjuncts(expression: ast.Expression) -> list[ast.Expression]:
    """Parts that the top of an expression joins by AND, left to right, without parentheses around them."""
    found: list[ast.Expression] = []
    pending = [expression]
    while pending:
        part = ungrouped(pending.pop())
        if isinstance(part, ast.Apply) and part.op is Op.AND:
            pending.extend(reversed(part.args))
        else:
            found.append(part)
    return found


def names_in(expression: ast.Expression) -> Iterator[str]:
    """Names that an expression uses, repeats included."""
    pending = [expression]
    while pending:
        part = pending.pop()
        if isinstance(part, ast.Name | ast.Indexed):
            yield part.name
        pending.extend(ast.children(part))


def expressions_in(system: ast.System) -> Iterator[ast.Expression]:
    """All whole expressions of a file: of declarations and of items, also in loops."""
    for declaration in (d for section in system.declarations for d in section.declarations):
        yield from declaration.size
        if declaration.value is not None:
            yield declaration.value
        if declaration.interval is not None:
            interval = declaration.interval
            yield from (end for pair in ((interval.low, interval.high), *interval.further) for end in pair)
    pending: list[ast.Item] = [item for section in system.sections for item in section.items]
    while pending:
        item = pending.pop()
        yield from _of_item(item)
        if isinstance(item, ast.Loop):
            pending.extend(item.items)


def _of_item(item: ast.Item) -> tuple[ast.Expression, ...]:
    match item:
        case ast.Loop(low=low, step=step, high=high):
            return (low, high) if step is None else (low, step, high)
        case ast.Requirement(value=value):
            return (value,)
        case ast.Query(condition=condition, steps=steps, start=start):
            return (condition, steps) if start is None else (condition, steps, start)
        case ast.Equation(value=value, triple=triple):
            return (value, *_of_triple(triple))
        case ast.Choice():
            otherwise = () if item.otherwise is None else (item.otherwise,)
            triples = (*_of_triple(item.then_triple), *_of_triple(item.otherwise_triple))
            return (item.condition, item.then, *otherwise, *triples)


def _of_triple(triple: ast.Triple | None) -> tuple[ast.Expression, ...]:
    return () if triple is None else (triple.low, triple.high, triple.epsilon)
