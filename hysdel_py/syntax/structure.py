"""Looks at the outside of an expression: parentheses around it, conjunctions at its top."""

from __future__ import annotations

from collections.abc import Iterator

from hysdel_py.syntax import ast
from hysdel_py.syntax.operators import Op

__all__ = ["conjuncts", "names_in", "ungrouped"]


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
