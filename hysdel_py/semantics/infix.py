"""Typed expressions as texts of the language that mean the same in every dialect."""

from __future__ import annotations

from dataclasses import dataclass

from hysdel_py.semantics.expressions import Apply, Constant, Expression, Reference, children
from hysdel_py.syntax.operators import FUNCTIONS, Op
from hysdel_py.syntax.traversal import fold
from hysdel_py.systems.signals import Type

__all__ = ["infix"]

# From weakest to strongest; parentheses part logic operators that differ, whose order depends on the dialect.
_LOGIC, _NOT, _COMPARISON, _SUM, _PRODUCT, _POWER, _SIGN, _ATOM = range(8)
_RANKS = {
    Op.LE: _COMPARISON, Op.GE: _COMPARISON, Op.ADD: _SUM, Op.SUBTRACT: _SUM, Op.MULTIPLY: _PRODUCT,
    Op.DIVIDE: _PRODUCT, Op.POWER: _POWER,
}  # fmt: skip
_NEGATED = {Op.LE: ">", Op.GE: "<"}
_CHAINS = frozenset({Op.AND, Op.OR})
_TIGHT = frozenset({Op.MULTIPLY, Op.DIVIDE, Op.POWER})


@dataclass(frozen=True, slots=True)
class _Part:
    """The text of a node, how tight it binds, its operator and the texts of the sides of a comparison."""

    text: str
    rank: int = _ATOM
    op: Op | None = None
    sides: tuple[str, str] = ("", "")

    def within(self, least: int) -> str:
        """The text, in parentheses where it binds weaker than its place demands."""
        return self.text if self.rank >= least else f"({self.text})"


def infix(expression: Expression) -> str:
    """The expression as a text of the language; a conditional, which has no place in logic, in its braces."""
    return fold(expression, children, _node).text


def _node(node: Expression, args: list[_Part]) -> _Part:
    match node:
        case Constant(value=value, type=Type.BOOL):
            return _Part("TRUE" if value else "FALSE")
        case Constant(value=value):
            return _Part(_number(value))
        case Reference(symbol=symbol):
            return _Part(symbol.name)
        case Apply(op=Op.IF):
            return _Part(f"{{IF {args[0].text} THEN {args[1].text} ELSE {args[2].text}}}")
        case Apply(op=op):
            return _unary(op, args[0]) if len(args) == 1 else _binary(op, args[0], args[1])


def _number(value: float) -> str:
    return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def _unary(op: Op, inner: _Part) -> _Part:
    if op is Op.CAST:
        return _Part(f"(REAL {inner.text})")
    if op in FUNCTIONS:
        return _Part(f"{op.value}({inner.text})")
    if op is Op.NEGATE:
        return _Part(f"-{inner.within(_SIGN)}", _SIGN)
    if inner.op in _NEGATED:  # a negated comparison is the strict one of the other direction
        return _Part(f"{inner.sides[0]} {_NEGATED[inner.op]} {inner.sides[1]}", _COMPARISON)
    return _Part(f"~{inner.within(_ATOM)}", _NOT)


def _binary(op: Op, left: _Part, right: _Part) -> _Part:
    mark, rank = (op.value if op in _TIGHT else f" {op.value} "), _RANKS.get(op, _LOGIC)
    if rank == _LOGIC:
        first = left.text if left.op is op and op in _CHAINS else left.within(_NOT)
        return _Part(f"{first}{mark}{right.within(_NOT)}", _LOGIC, op)
    sides = left.within(rank + (rank == _COMPARISON)), right.within(rank + 1)
    return _Part(mark.join(sides), rank, op, sides)
