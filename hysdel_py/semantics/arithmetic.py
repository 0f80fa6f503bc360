"""Values of constant expressions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from hysdel_py.semantics.expressions import Constant, Expression, Reference, children
from hysdel_py.syntax.operators import Op
from hysdel_py.syntax.traversal import fold
from hysdel_py.systems.symbolic import Symbolic, apply_symbolic

__all__ = ["apply", "evaluate", "fault"]


def evaluate(expression: Expression, values: Mapping[str, float]) -> float:
    """Value of a constant expression; Boolean results are 0 and 1.

    Follows IEEE rules where the result is not a finite number, so it never raises for arithmetic.

    Raises
    ------
    KeyError
        A parameter has no value.
    """

    def node(expression: Expression, args: list[float]) -> float:
        match expression:
            case Constant(value=value):
                return value
            case Reference(symbol=symbol):
                return values[symbol.name]
            case _:
                return apply(expression.op, args)

    return fold(expression, children, node)


def fault(op: Op, args: list[float]) -> str:
    """What is wrong with applying an operator to these numbers, empty if nothing is."""
    if op is Op.DIVIDE and args[1] == 0:
        return "division by zero"
    if op is Op.SQRT and args[0] < 0:
        return f"square root of the negative number {args[0]:g}"
    if op is Op.LOG and args[0] <= 0:
        return f"logarithm of {args[0]:g}, which is not positive"
    if op is Op.POWER and args[0] < 0 and not float(args[1]).is_integer():
        return f"power of the negative number {args[0]:g} with the fractional exponent {args[1]:g}"
    return ""


def apply(op: Op, args: list[float]) -> float:
    """Apply an operator to numbers; a real power is a real power."""
    try:
        result = float(_OPERATIONS[op](*args))
        if result != result and any(isinstance(arg, Symbolic) for arg in args):  # noqa: PLR0124 -- not a number
            return apply_symbolic("neg" if op is Op.NEGATE else op.value, args)
        return result  # noqa: TRY300
    except ZeroDivisionError:
        return math.nan if args[0] == 0 or math.isnan(args[0]) else math.copysign(math.inf, args[0])
    except OverflowError:
        return math.inf
    except ValueError:
        return -math.inf if op is Op.LOG and args[0] == 0 else math.nan


_OPERATIONS: Mapping[Op, Callable[..., float]] = {
    Op.NEGATE: lambda a: -a,
    Op.ADD: lambda a, b: a + b,
    Op.SUBTRACT: lambda a, b: a - b,
    Op.MULTIPLY: lambda a, b: a * b,
    Op.DIVIDE: lambda a, b: a / b,
    Op.POWER: math.pow,
    Op.SIN: math.sin,
    Op.COS: math.cos,
    Op.EXP: math.exp,
    Op.LOG: math.log,
    Op.SQRT: math.sqrt,
    Op.CAST: lambda a: a,
    Op.LE: lambda a, b: a <= b,
    Op.GE: lambda a, b: a >= b,
    Op.LT: lambda a, b: a < b,
    Op.GT: lambda a, b: a > b,
    Op.EQ: lambda a, b: a == b,
    Op.IF: lambda condition, then, otherwise: then if condition else otherwise,
    Op.NOT: lambda a: not a,
    Op.AND: lambda a, b: a and b,
    Op.OR: lambda a, b: a or b,
    Op.IMPLIES: lambda a, b: (not a) or b,
    Op.IMPLIED_BY: lambda a, b: a or (not b),
    Op.IFF: lambda a, b: bool(a) == bool(b),
}
