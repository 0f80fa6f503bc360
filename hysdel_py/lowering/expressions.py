"""Typed expressions with parameter values to affine forms and formulas."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.arithmetic import apply, evaluate, fault
from hysdel_py.semantics.expressions import Apply, Constant, Expression, Reference, children
from hysdel_py.syntax.operators import Op
from hysdel_py.syntax.traversal import fold
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.formula import Connective, Formula
from hysdel_py.systems.signals import Type
from hysdel_py.systems.symbolic import Symbolic

__all__ = ["ExpressionLowering", "Generator", "mentions_constant"]

_CONNECTIVE = {
    Op.NOT: Connective.NOT,
    Op.AND: Connective.AND,
    Op.OR: Connective.OR,
    Op.IMPLIES: Connective.IMPLIES,
    Op.IMPLIED_BY: Connective.IMPLIED_BY,
    Op.IFF: Connective.IFF,
}
_Postfix = deque[str | bool | Connective]


class Generator(Protocol):
    """Makes the auxiliaries that an expression needs."""

    def cast(self, formula: Formula) -> str:
        """Name of a new Boolean that is equal to the formula inside a cast."""

    def event(self, form: Affine) -> str:
        """Name of a new Boolean that is true exactly where the form is at most 0."""

    def switch(self, condition: Formula, then: Affine, otherwise: Affine) -> str:
        """Name of a new real that is one of two forms."""


@dataclass(frozen=True, slots=True)
class ExpressionLowering:
    """Lowers expressions with the given parameter values; faulty arithmetic is reported to the sink."""

    values: Mapping[str, float]
    sink: Sink

    def constant(self, expression: Expression) -> float:
        """Value of a constant expression outside an item, where division by zero gives infinity."""
        return evaluate(expression, self.values)

    def affine(self, expression: Expression, generator: Generator) -> Affine:
        """Affine form of a real expression."""
        result = self._lowered(expression, generator)
        assert isinstance(result, Affine)  # the typer has seen to it
        return result

    def formula(self, expression: Expression, generator: Generator) -> Formula:
        """Formula of a Boolean expression; one without variables becomes a truth value."""
        result = self._lowered(expression, generator)
        assert not isinstance(result, Affine)
        return _formula(result)

    def _lowered(self, expression: Expression, generator: Generator) -> Affine | _Postfix:
        """Reals become affine forms and Booleans postfix sequences, in one walk however they are nested."""

        def node(node: Expression, args: list[Affine | _Postfix]) -> Affine | _Postfix:
            if isinstance(node, Apply):
                return self._apply(node, args, generator)
            return self._leaf(node)

        return fold(expression, children, node)

    def _leaf(self, leaf: Constant | Reference) -> Affine | _Postfix:
        value: float | str = leaf.value if isinstance(leaf, Constant) else self._value_or_name(leaf)
        if leaf.type is Type.BOOL:
            return deque([value if isinstance(value, str) else bool(value)])
        return Affine(0.0, ((value, 1.0),)) if isinstance(value, str) else Affine(value)

    def _value_or_name(self, reference: Reference) -> float | str:
        symbol = reference.symbol
        return self.values[symbol.name] if symbol.is_parameter else symbol.name

    def _apply(self, node: Apply, args: list[Affine | _Postfix], generator: Generator) -> Affine | _Postfix:
        forms = [argument for argument in args if isinstance(argument, Affine)]
        formulas = [argument for argument in args if not isinstance(argument, Affine)]
        match node.op:
            case Op.CAST:
                return _cast(_formula(formulas[0]), generator)
            case Op.IF:
                return Affine(0.0, ((generator.switch(_formula(formulas[0]), forms[0], forms[1]), 1.0),))
            case Op.LE | Op.GE:
                form = forms[0] - forms[1] if node.op is Op.LE else forms[1] - forms[0]
                known = form.is_constant and not isinstance(form.constant, Symbolic)
                return deque([form.constant <= 0 if known else generator.event(form)])
            case op if op in _CONNECTIVE:
                return _joined(formulas, _CONNECTIVE[op])
            case _:
                return self._arithmetic(node, forms)

    def _arithmetic(self, node: Apply, args: list[Affine]) -> Affine:
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


def _joined(parts: list[_Postfix], connective: Connective) -> _Postfix:
    """Operands and connective in postfix order; the shorter operand is moved, so that depth costs little."""
    joined = parts[0]
    if len(parts) == 2:
        left, right = parts
        if len(left) >= len(right):
            left.extend(right)
        else:
            right.extendleft(reversed(left))
            joined = right
    joined.append(connective)
    return joined


def _formula(postfix: _Postfix) -> Formula:
    formula = Formula(tuple(postfix))
    return formula if formula.names else Formula((formula.value({}),))


def _cast(formula: Formula, generator: Generator) -> Affine:
    match formula.postfix:
        case (bool(value),):
            return Affine(float(value))
        case (str(name),):
            return Affine(0.0, ((name, 1.0),))
        case _:
            return Affine(0.0, ((generator.cast(formula), 1.0),))


def _arithmetic_children(expression: Expression) -> tuple[Expression, ...]:
    """Sub-expressions of arithmetic; what is inside a cast is logic."""
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
