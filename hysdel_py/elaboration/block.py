"""Blocks: matrices of scalar expressions, and what arithmetic makes of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from hysdel_py.syntax import ast
from hysdel_py.syntax.operators import Op
from hysdel_py.syntax.source import Span

__all__ = ["Block", "beside", "elementwise", "product", "scalar", "transposed"]


@dataclass(frozen=True, slots=True)
class Block:
    """A matrix of scalar expressions, row by row, and where it was written."""

    rows: int
    columns: int
    elements: tuple[ast.Expression, ...]
    span: Span

    @property
    def is_scalar(self) -> bool:
        """Whether there is one element."""
        return self.rows == self.columns == 1

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns."""
        return self.rows, self.columns

    @property
    def size(self) -> str:
        """Rows and columns in words."""
        return "a scalar" if self.is_scalar else f"{self.rows}-by-{self.columns}"

    def element(self, index: int) -> ast.Expression:
        """An element, counted row by row from 0; a scalar stands for every one."""
        return self.elements[0] if self.is_scalar else self.elements[index]


def scalar(expression: ast.Expression) -> Block:
    """A block of one element."""
    return Block(1, 1, (expression,), expression.span)


def elementwise(
    parts: list[Block], build: Callable[[tuple[ast.Expression, ...]], ast.Expression], span: Span
) -> Block | None:
    """Combine blocks of one size, or scalars with it; None if the sizes differ."""
    shapes = {part.shape for part in parts if not part.is_scalar}
    if len(shapes) > 1:
        return None
    rows, columns = next(iter(shapes), (1, 1))
    elements = tuple(build(tuple(part.element(k) for part in parts)) for k in range(rows * columns))
    return Block(rows, columns, elements, span)


def product(left: Block, right: Block, span: Span) -> Block | None:
    """The matrix product; None if the inner sizes differ."""
    if left.columns != right.rows:
        return None
    elements = tuple(_inner(left, right, i, j, span) for i in range(left.rows) for j in range(right.columns))
    return Block(left.rows, right.columns, elements, span)


def _inner(left: Block, right: Block, row: int, column: int, span: Span) -> ast.Expression:
    total: ast.Expression | None = None
    for k in range(left.columns):
        factors = (left.elements[row * left.columns + k], right.elements[k * right.columns + column])
        term = ast.Apply(Op.MULTIPLY, factors, span)
        total = term if total is None else ast.Apply(Op.ADD, (total, term), span)
    assert total is not None  # no size is 0
    return total


def beside(parts: list[Block], span: Span) -> Block | None:
    """Blocks side by side; None if they differ in height."""
    if len({part.rows for part in parts}) > 1:
        return None
    rows, columns = parts[0].rows, sum(part.columns for part in parts)
    elements = tuple(e for i in range(rows) for p in parts for e in p.elements[i * p.columns : (i + 1) * p.columns])
    return Block(rows, columns, elements, span)


def transposed(block: Block, span: Span) -> Block:
    """Rows as columns."""
    elements = tuple(block.elements[i * block.columns + j] for j in range(block.columns) for i in range(block.rows))
    return Block(block.columns, block.rows, elements, span)
