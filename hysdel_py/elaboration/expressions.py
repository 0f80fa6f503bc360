"""Expressions over vectors to blocks of scalar expressions."""

from __future__ import annotations

from dataclasses import replace

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.elaboration.block import Block, beside, elementwise, product, scalar, transposed
from hysdel_py.elaboration.scope import MAX_ELEMENTS, Scope, Shape, element
from hysdel_py.syntax import ast
from hysdel_py.syntax.operators import Op
from hysdel_py.syntax.source import Span
from hysdel_py.syntax.traversal import fold

__all__ = ["ExpressionElaborator"]


class ExpressionElaborator:
    """Elaborates expressions in a scope; mistakes go to its sink and give None."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope
        self._sink = scope.sink

    def block(self, expression: ast.Expression) -> Block | None:
        """Elements of an expression; a scalar one that mentions no vector stays as it is."""
        return fold(expression, ast.children, self._node)

    def _node(self, node: ast.Expression, args: list[Block | None]) -> Block | None:  # noqa: PLR0911 -- a table
        known = [argument for argument in args if argument is not None]
        if len(known) < len(args):
            return None
        match node:
            case ast.Name(name=name, span=span):
                return self._scope.whole(name, span)
            case ast.Indexed():
                return self._indexed(node, known)
            case ast.Range():
                return self._range(node, known)
            case ast.Matrix():
                return self._matrix(node, known)
            case ast.Group():
                return self._mapped(node, known)
            case ast.Apply(op=Op.MULTIPLY) if not known[0].is_scalar and not known[1].is_scalar:
                result = product(known[0], known[1], node.span)
                if result is None:
                    self._scope.mismatch(known, "there is no product", node.span)
                return result
            case ast.Apply(op=Op.TRANSPOSE):
                self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no transposes", node.span)
                return transposed(known[0], node.span)
            case ast.Apply() | ast.Conditional():
                return self._mapped(node, known)
            case _:
                return scalar(node)

    def _mapped(self, node: ast.Group | ast.Apply | ast.Conditional, parts: list[Block]) -> Block | None:
        """Apply an operator to each element."""
        if isinstance(node, ast.Apply) and not self._scalar_operand(node, parts):
            return None
        result = elementwise(parts, lambda elements: _rebuilt(node, elements), node.span)
        if result is None:
            self._scope.mismatch([p for p in parts if not p.is_scalar], "sizes do not match: an operation", node.span)
        return result

    def _scalar_operand(self, node: ast.Apply, parts: list[Block]) -> bool:
        """A divisor, an exponent and its base are scalars."""
        wrong = parts if node.op is Op.POWER else parts[1:] if node.op is Op.DIVIDE else []
        if all(part.is_scalar for part in wrong):
            return True
        self._scope.mismatch(parts, f"there is no {node.op.value}", node.span)
        return False

    def _matrix(self, node: ast.Matrix, entries: list[Block]) -> Block | None:
        self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no vectors and matrices", node.span)
        rows = []
        for row in node.rows:
            parts, entries = entries[: len(row)], entries[len(row) :]
            joined = beside(parts, Span(parts[0].span.start, parts[-1].span.end))
            if joined is None:
                self._scope.mismatch(parts, "one row cannot hold blocks", node.span)
                return None
            rows.append(joined)
        if len({row.columns for row in rows}) > 1:
            self._scope.mismatch(rows, "one matrix cannot hold rows", node.span)
            return None
        elements = tuple(e for row in rows for e in row.elements)
        return Block(sum(row.rows for row in rows), rows[0].columns, elements, node.span)

    def _range(self, node: ast.Range, ends: list[Block]) -> Block | None:
        low, *step, high = ends
        places = self._scope.integers(low, step[0] if step else None, high, "a range")
        if places is None:
            return None
        if not 0 < len(places) <= MAX_ELEMENTS:
            written = ":".join(str(self._scope.integer(end, "an end")) for end in ends)
            self._sink.error(Code.INDEX, f"the range {written} is empty or too long", node.span)
            return None
        numbers = tuple(ast.Number(float(k), str(k), node.span) for k in places)
        return Block(1, len(numbers), numbers, node.span)

    # ---- indexing ----

    def _indexed(self, node: ast.Indexed, indices: list[Block]) -> Block | None:
        full = self._scope.full(node.name)
        shape = self._scope.shapes.get(full)
        if shape is None:
            self._report_no_vector(node, full)
            return None
        if len(indices) == 1 and isinstance(node.indices[0], ast.All):
            whole = self._scope.whole(node.name, node.span)
            return whole and _stacked(whole, node.span)
        places = self._places(node, shape, indices)
        if places is None:
            return None
        rows, columns = places
        elements = tuple(ast.Name(element(full, shape, (i, j)), node.span) for i in rows for j in columns)
        return Block(len(rows), len(columns), elements, node.span)

    def _report_no_vector(self, node: ast.Indexed, full: str) -> None:
        if full in self._scope.scalars or node.name in self._scope.iterators:
            message, advice = f"{node.name} is a scalar and has no elements", "declare a size, as in REAL x(3)"
        else:
            message, advice = f"{node.name} is not declared", "declare it in INTERFACE or in AUX"
        code = Code.INDEX if full in self._scope.scalars else Code.UNDECLARED
        self._sink.error(code, message, node.span, help=advice)

    def _places(self, node: ast.Indexed, shape: Shape, indices: list[Block]) -> tuple[list[int], list[int]] | None:
        """Rows and columns that are meant, from 1."""
        if len(indices) == 1 and shape.rows > 1 and shape.columns > 1:
            self._sink.error(
                Code.INDEX,
                f"{node.name} is {shape.size} and takes two indices",
                node.span,
                labels=(Label(shape.span, "declared here"),),
            )
            return None
        if len(indices) == 1 and shape.rows == 1 and shape.columns > 1:
            columns = self._numbers(node, indices[0], shape.columns, shape)
            return None if columns is None else ([1], columns)
        rows = self._numbers(node, indices[0], shape.rows, shape)
        columns = [1] if len(indices) == 1 else self._numbers(node, indices[1], shape.columns, shape)
        return None if rows is None or columns is None else (rows, columns)

    def _numbers(self, node: ast.Indexed, index: Block, limit: int, shape: Shape) -> list[int] | None:
        if isinstance(index.elements[0], ast.All):
            return list(range(1, limit + 1))
        found = []
        for entry in index.elements:
            number = self._scope.integer(Block(1, 1, (entry,), entry.span), "an index")
            if number is None:
                return None
            if not 1 <= number <= limit:
                self._sink.error(
                    Code.INDEX,
                    f"{node.name} has no element {number}: it is {shape.size} and indices start at 1",
                    node.span,
                    labels=(Label(shape.span, "declared here"),),
                )
                return None
            found.append(number)
        return found


def _stacked(block: Block, span: Span) -> Block:
    """All elements in one column, column after column."""
    return Block(block.rows * block.columns, 1, transposed(block, span).elements, span)


def _rebuilt(node: ast.Group | ast.Apply | ast.Conditional, parts: tuple[ast.Expression, ...]) -> ast.Expression:
    """The node over other operands, itself if they are its own."""
    if all(new is old for new, old in zip(parts, ast.children(node), strict=True)):
        return node
    match node:
        case ast.Group():
            return ast.Group(parts[0], node.span)
        case ast.Apply():
            return ast.Apply(node.op, parts, node.span)
        case ast.Conditional():
            return replace(node, condition=parts[0], then=parts[1], otherwise=parts[2] if len(parts) == 3 else None)
