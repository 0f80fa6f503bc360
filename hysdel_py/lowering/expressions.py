"""Typed expressions with parameter values to affine forms and formulas."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.arithmetic import apply, evaluate, fault
from hysdel_py.semantics.expressions import Apply, Constant, Expression, Reference, children
from hysdel_py.syntax.operators import Op
from hysdel_py.syntax.traversal import fold
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.formula import Connective, Formula

__all__ = ["ExpressionLowering", "mentions_constant"]

_CONNECTIVE = {
    Op.NOT: Connective.NOT,
    Op.AND: Connective.AND,
    Op.OR: Connective.OR,
    Op.IMPLIES: Connective.IMPLIES,
    Op.IMPLIED_BY: Connective.IMPLIED_BY,
    Op.IFF: Connective.IFF,
}


@dataclass(frozen=True, slots=True)
class ExpressionLowering:
    """Lowers expressions with the given parameter values; faulty arithmetic is reported to the sink."""

    values: Mapping[str, float]
    sink: Sink

    def constant(self, expression: Expression) -> float:
        """Value of a constant expression outside an item, where division by zero gives infinity."""
        return evaluate(expression, self.values)

    def affine(self, expression: Expression, name_of: Callable[[Formula], str]) -> Affine:
        """Affine form of a real expression.

        Parameters
        ----------
        name_of : callable
            Gives the name of a new Boolean that is equal to the formula inside a cast.
        """

        def node(node: Expression, args: list[Affine]) -> Affine:
            match node:
                case Constant(value=value):
                    return Affine(value)
                case Reference(symbol=symbol):
                    if symbol.is_parameter:
                        return Affine(self.values[symbol.name])
                    return Affine(0.0, ((symbol.name, 1.0),))
                case Apply(op=Op.CAST):
                    return self._cast(node.args[0], name_of)
                case Apply():
                    return self._apply(node, args)

        return fold(expression, _arithmetic_children, node)

    def _cast(self, argument: Expression, name_of: Callable[[Formula], str]) -> Affine:
        formula = self.formula(argument)
        match formula.postfix:
            case (bool(value),):
                return Affine(float(value))
            case (str(name),):
                return Affine(0.0, ((name, 1.0),))
            case _:
                return Affine(0.0, ((name_of(formula), 1.0),))

    def _apply(self, node: Apply, args: list[Affine]) -> Affine:
        match node.op:
            case Op.ADD:
                return args[0] + args[1]
            case Op.SUBTRACT:
                return args[0] - args[1]
            case Op.NEGATE:
                return -args[0]
            case Op.MULTIPLY:
                factor, form = args if args[0].is_constant else (args[1], args[0])
                return form * factor.constant
            case Op.DIVIDE if args[1].constant != 0 and not args[0].is_constant:
                return Affine(
                    args[0].constant / args[1].constant,
                    tuple((name, value / args[1].constant) for name, value in args[0].terms),
                )
            case _:
                return Affine(self._number(node, [argument.constant for argument in args]))

    def _number(self, node: Apply, args: list[float]) -> float:
        problem = fault(node.op, args)
        if problem:
            self.sink.error(Code.BAD_ARITHMETIC, problem, node.span)
            return 0.0
        return apply(node.op, args)

    def formula(self, expression: Expression) -> Formula:
        """Formula of a Boolean expression; one without variables becomes a truth value."""
        postfix: list[str | bool | Connective] = []

        def node(node: Expression, _: list[None]) -> None:
            match node:
                case Constant(value=value):
                    postfix.append(bool(value))
                case Reference(symbol=symbol):
                    postfix.append(bool(self.values[symbol.name]) if symbol.is_parameter else symbol.name)
                case Apply(op=op):
                    postfix.append(_CONNECTIVE[op])

        fold(expression, children, node)
        formula = Formula(tuple(postfix))
        return formula if formula.names else Formula((formula.value({}),))


def _arithmetic_children(expression: Expression) -> tuple[Expression, ...]:
    """Sub-expressions of arithmetic; what is inside a cast is logic and handled apart."""
    return () if isinstance(expression, Apply) and expression.op is Op.CAST else children(expression)


def mentions_constant(expression: Expression) -> bool:
    """Whether a constant stands as a term of the sum, even one that is zero or cancels."""

    def node(node: Expression, args: list[bool]) -> bool:
        match node:
            case Apply(op=Op.CAST):
                return isinstance(node.args[0], Constant)
            case Apply(constant=True) | Constant():
                return True
            case Reference(symbol=symbol):
                return symbol.is_parameter
            case Apply(op=Op.MULTIPLY):
                return all(args)
            case Apply(op=Op.DIVIDE):
                return args[0]
            case _:
                return any(args)

    return fold(expression, _arithmetic_children, node)
