"""Types an expression of the syntax tree: resolves names, checks operands, and keeps only affine arithmetic."""

from __future__ import annotations

from collections.abc import Mapping

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.expressions import Apply, Constant, Expression, Reference, is_constant
from hysdel_py.semantics.symbols import Role, Symbol
from hysdel_py.syntax import ast
from hysdel_py.syntax.operators import ARITHMETIC, COMPARISONS, FUNCTIONS, Op
from hysdel_py.syntax.source import Span
from hysdel_py.syntax.traversal import fold
from hysdel_py.systems.signals import Type

__all__ = ["ExpressionTyper"]

_WORD = {Type.REAL: "a real expression", Type.BOOL: "a Boolean expression"}


class ExpressionTyper:
    """Types expressions against a table of symbols; mistakes go to the sink and give None."""

    def __init__(self, symbols: Mapping[str, Symbol], sink: Sink, *, outputs: bool = False) -> None:
        self._symbols = symbols
        self._sink = sink
        self._outputs = outputs  # whether outputs may be read

    def typed(
        self, expression: ast.Expression, expected: Type | None, *, comparison: bool = False
    ) -> Expression | None:
        """Type an expression.

        A comparison becomes ``<=`` or ``>=``, where need be of the other direction and negated, so that
        ``a < b`` is ``~(a >= b)``.

        Parameters
        ----------
        expected : Type or None
            What its place needs, None if either will do.
        comparison : bool
            Whether the place is one where the original compiler takes a comparison as a whole.
        """
        result: Expression | None = fold(expression, ast.children, self._node)
        if result is None:
            return None
        if not comparison and isinstance(result, Apply) and result.op in (Op.LE, Op.GE):
            self._note_inner_comparison(result)
        return result if expected is None else self._coerced(result, expected)

    def _note_inner_comparison(self, expression: Expression) -> None:
        if isinstance(expression, Apply) and expression.op in (Op.LE, Op.GE):
            self._sink.note(
                Code.EXTENSION, "HYSDEL 2.0.5 takes comparisons only as a whole in AD and MUST", expression.span
            )

    def _node(self, node: ast.Expression, args: list[Expression | None]) -> Expression | None:
        match node:
            case ast.Number(value=value, text=text, span=span):
                if "E" in text:
                    self._sink.note(Code.EXTENSION, f"HYSDEL 2.0.5 misreads the capital exponent in {text}", span)
                return Constant(value, Type.REAL, span)
            case ast.Truth(value=value, span=span):
                return Constant(float(value), Type.BOOL, span)
            case ast.Name(name=name, span=span):
                return self._name(name, span)
            case ast.Group(span=span):
                if isinstance(args[0], Apply) and args[0].op in COMPARISONS:
                    self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 refuses a comparison in parentheses", span)
                return args[0]
            case ast.Apply(op=op, span=span):
                known = [argument for argument in args if argument is not None]
                return self._apply(op, known, span) if len(known) == len(args) else None
            case ast.Conditional():
                known = [argument for argument in args if argument is not None]
                return self._conditional(node, known) if len(known) == len(args) else None
            case ast.Indexed() | ast.Matrix() | ast.Range() | ast.All():
                raise AssertionError(node)  # elaboration leaves scalars

    def _name(self, name: str, span: Span) -> Expression | None:
        symbol = self._symbols.get(name)
        if symbol is None:
            self._sink.error(
                Code.UNDECLARED, f"{name} is not declared", span, help=_similar(name, tuple(self._symbols))
            )
            return None
        if symbol.role is Role.OUTPUT and not self._outputs:
            self._sink.error(
                Code.OUTPUT_USED,
                f"the output {name} cannot be used in an expression",
                span,
                help="use the expression that defines it, or an auxiliary variable",
                labels=(Label(symbol.span, "declared here"),),
            )
            return None
        return Reference(symbol, span)

    def _apply(self, op: Op, args: list[Expression], span: Span) -> Expression | None:
        operand = Type.REAL if op in ARITHMETIC or op in COMPARISONS else Type.BOOL
        coerced = [self._coerced(argument, operand) for argument in args]
        known = tuple(argument for argument in coerced if argument is not None)
        if len(known) < len(args) or not self._affine(op, known, span):
            return None
        if op in COMPARISONS:
            return self._comparison(op, known, span)
        for argument in known:
            self._note_inner_comparison(argument)
        type_ = Type.REAL if op in ARITHMETIC or op is Op.CAST else Type.BOOL
        return Apply(op, known, type_, all(map(is_constant, known)), span)

    def _comparison(self, op: Op, args: tuple[Expression, ...], span: Span) -> Expression | None:
        constant = all(map(is_constant, args))
        if op in (Op.LE, Op.GE):
            return Apply(op, args, Type.BOOL, constant, span)
        if op is Op.EQ:
            self._sink.error(
                Code.NOT_SUPPORTED,
                "an equality of real numbers has to stand alone in MUST",
                span,
                help="a real variable meets a number exactly only by chance; use two thresholds",
            )
            return None
        self._sink.note(Code.EXTENSION, f"HYSDEL 2.0.5 knows only <= and >=, not {op.value}", span)
        opposite = Op.GE if op is Op.LT else Op.LE
        return Apply(Op.NOT, (Apply(opposite, args, Type.BOOL, constant, span),), Type.BOOL, constant, span)

    def _conditional(self, node: ast.Conditional, args: list[Expression]) -> Expression | None:
        """A choice inside a choice; without ELSE it is 0 elsewhere."""
        self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no IF inside an IF", node.span)
        for triple in (node.then_triple, node.otherwise_triple):
            if triple is not None:
                self._sink.error(
                    Code.NOT_SUPPORTED,
                    "[min, max, epsilon] belongs behind the branches of the outer IF only",
                    triple.span,
                )
        condition = self._coerced(args[0], Type.BOOL)
        self._note_inner_comparison(args[0])
        branches = [self._coerced(branch, Type.REAL) for branch in args[1:]]
        if len(branches) == 1:
            branches.append(Constant(0.0, Type.REAL, node.span))
        known = tuple(part for part in (condition, *branches) if part is not None)
        return Apply(Op.IF, known, Type.REAL, constant=False, span=node.span) if len(known) == 3 else None

    def _coerced(self, expression: Expression, expected: Type) -> Expression | None:
        """Check the type; a Boolean parameter counts as a number where one is needed."""
        if expression.type is expected:
            self._note_extension(expression, expected)
            return expression
        if expected is Type.REAL and isinstance(expression, Reference) and expression.symbol.is_parameter:
            return Apply(Op.CAST, (expression,), Type.REAL, True, expression.span)
        self._sink.error(
            Code.WRONG_TYPE,
            f"{_WORD[expected]} is needed here, this is {_described(expression)}",
            expression.span,
            help="(REAL expression) turns a Boolean into 0 or 1"
            if expected is Type.REAL
            else _boolean_help(expression),
        )
        return None

    def _note_extension(self, expression: Expression, expected: Type) -> None:
        if expected is Type.BOOL and isinstance(expression, Reference) and expression.symbol.is_parameter:
            name = expression.symbol.name
            self._sink.note(Code.EXTENSION, f"HYSDEL 2.0.5 refuses the BOOL parameter {name} in logic", expression.span)

    def _affine(self, op: Op, args: tuple[Expression, ...], span: Span) -> bool:
        """Check that no product, quotient, power or function makes a variable non-linear."""
        constant = [is_constant(argument) for argument in args]
        if op is Op.MULTIPLY and not any(constant):
            fault = "a product of two variables is not affine"
        elif op is Op.DIVIDE and not constant[1]:
            fault = "a division by a variable is not affine"
        elif op is Op.POWER and not all(constant):
            fault = "a power of or by a variable is not affine"
        elif op in FUNCTIONS and not constant[0]:
            fault = f"{op.value} of a variable is not affine"
        else:
            return True
        advice = "only sums and multiples of variables are allowed; approximate by thresholds and IF pieces"
        self._sink.error(Code.NOT_AFFINE, fault, span, help=advice)
        return False


def _described(expression: Expression) -> str:
    if isinstance(expression, Reference):
        return f"the {expression.symbol.spoken} {expression.symbol.name}"
    return _WORD[expression.type]


def _boolean_help(expression: Expression) -> str:
    if isinstance(expression, Reference):
        return f"define a Boolean auxiliary in AD, such as d = {expression.symbol.name} >= 0, and use that"
    if isinstance(expression, Constant):
        return "write TRUE or FALSE"
    return "define a Boolean auxiliary by a comparison in AD and use that"


def _similar(name: str, known: tuple[str, ...]) -> str:
    from difflib import get_close_matches

    if name.upper() in ("TRUE", "FALSE"):
        return f"did you mean {name.upper()}?"
    close = [k for k in known if k.lower() == name.lower()] or get_close_matches(name, known, n=1)
    return f"did you mean {close[0]}?" if close else "declare it in INTERFACE or in AUX"
