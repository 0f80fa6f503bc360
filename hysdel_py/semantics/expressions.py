"""Typed expressions: every name resolved, every node real or Boolean, parentheses gone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from hysdel_py.semantics.symbols import Symbol
from hysdel_py.syntax.operators import Op
from hysdel_py.syntax.source import Span
from hysdel_py.systems.signals import Type

__all__ = ["Apply", "Constant", "Expression", "Reference", "children", "leaves"]


@dataclass(frozen=True, slots=True)
class Constant:
    """A number, or TRUE and FALSE as 1 and 0 of Boolean type."""

    value: float
    type: Type
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Reference:
    """The use of a variable or parameter."""

    symbol: Symbol
    span: Span = field(compare=False)

    @property
    def type(self) -> Type:
        """Type of the symbol."""
        return self.symbol.type


@dataclass(frozen=True, slots=True)
class Apply:
    """An operator with its typed arguments.

    `constant` says that no variable occurs below.
    """

    op: Op
    args: tuple[Expression, ...]
    type: Type
    constant: bool
    span: Span = field(compare=False)


Expression = Constant | Reference | Apply


def children(expression: Expression) -> tuple[Expression, ...]:
    """Direct sub-expressions."""
    return expression.args if isinstance(expression, Apply) else ()


def is_constant(expression: Expression) -> bool:
    """Whether no variable occurs, so that parameter values alone give the value."""
    match expression:
        case Constant():
            return True
        case Reference(symbol=symbol):
            return symbol.is_parameter
        case Apply(constant=constant):
            return constant


def leaves(expression: Expression) -> Iterator[Symbol]:
    """Symbols in the order in which they are written, repeats included."""
    pending: list[Expression] = [expression]
    while pending:
        node = pending.pop()
        if isinstance(node, Reference):
            yield node.symbol
        else:
            pending.extend(reversed(children(node)))
