"""Items over vectors, and loops, to scalar items."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from hysdel_py.diagnostics.codes import Code
from hysdel_py.elaboration.block import Block
from hysdel_py.elaboration.expressions import ExpressionElaborator
from hysdel_py.elaboration.scope import MAX_ELEMENTS, Scope
from hysdel_py.syntax import ast

__all__ = ["ItemElaborator"]


class ItemElaborator:
    """Elaborates the items of one file."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope
        self._sink = scope.sink
        self._expressions = ExpressionElaborator(scope)
        self._passes = 0

    def items(self, items: tuple[ast.Item, ...]) -> Iterator[ast.Item]:
        """Scalar items of a section; loops are unrolled with an explicit stack."""
        pending: list[Iterator[ast.Item | tuple[str, int | None]]] = [iter(items)]
        while pending:
            item = next(pending[-1], None)
            match item:
                case None:
                    pending.pop()
                case (name, value):
                    self._scope.iterators[name] = value
                case ast.Loop():
                    pending.append(self._unrolled(item))
                case ast.Query():
                    yield from self._query(item)
                case _:
                    yield from self._elements(item)

    def _unrolled(self, loop: ast.Loop) -> Iterator[ast.Item | tuple[str, int | None]]:
        """The items of each pass behind the value that the iterator takes."""
        name = loop.iterator.name
        if name not in self._scope.iterators:
            self._sink.error(
                Code.UNDECLARED, f"the iterator {name} is not declared", loop.iterator.span,
                help=f"declare it in AUX: INDEX {name};",
            )  # fmt: skip
            return
        if self._scope.iterators[name] is not None:
            self._sink.error(Code.INDEX, f"{name} counts the FOR around this one already", loop.iterator.span)
            return
        step = None if loop.step is None else self._expressions.block(loop.step)
        if loop.step is not None and step is None:
            return
        low, high = self._expressions.block(loop.low), self._expressions.block(loop.high)
        values = self._scope.integers(low, step, high, "FOR")
        if values is None:
            return
        self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no FOR", loop.span)
        self._passes += len(values)
        if self._passes > MAX_ELEMENTS:
            self._sink.error(Code.SIZE, f"loops make more than {MAX_ELEMENTS} passes", loop.span)
            return
        for value in values:
            yield (name, value)
            yield from loop.items
        yield (name, None)

    def _elements(self, item: ast.Equation | ast.Choice | ast.Requirement) -> list[ast.Item]:
        """One item for each element."""
        if isinstance(item, ast.Requirement):
            value = self._expressions.block(item.value)
            return [] if value is None else [
                replace(item, value=part, continues=k > 0) for k, part in enumerate(value.elements)
            ]  # fmt: skip
        target = self._expressions.block(item.target)
        parts = [self._expressions.block(part) for part in _parts(item)]
        known = [part for part in parts if part is not None]
        if target is None or len(known) < len(parts) or not self._fit(target, known, item):
            return []
        return [
            _with_parts(item, name, [part.element(k) for part in known], k > 0)
            for k, name in enumerate(target.elements)
            if isinstance(name, ast.Name) or self._iterator_on_the_left(item)
        ]

    def _query(self, query: ast.Query) -> Iterator[ast.Query]:
        """A query over scalars, with a number of steps that is known now."""
        condition, steps = self._scalar(query.condition), self._expressions.block(query.steps)
        start = None if query.start is None else self._scalar(query.start)
        count = self._scope.integer(steps, "the number of steps of a query")
        if condition is None or count is None or (query.start is not None and start is None):
            return
        number = ast.Number(float(count), str(count), query.steps.span)
        yield replace(query, condition=condition, steps=number, start=start)

    def _scalar(self, expression: ast.Expression) -> ast.Expression | None:
        block = self._expressions.block(expression)
        if block is not None and not block.is_scalar:
            self._sink.error(
                Code.SIZE_MISMATCH, f"a query needs one Boolean expression, this is {block.size}", expression.span,
                help="name the elements, as in x(1) <= 1 & x(2) <= 1, or write the query in a FOR",
            )  # fmt: skip
            return None
        return None if block is None else block.elements[0]

    def _fit(self, target: Block, parts: list[Block], item: ast.Equation | ast.Choice) -> bool:
        wrong = [part for part in parts if not part.is_scalar and part.shape != target.shape]
        if wrong:
            self._scope.mismatch([target, wrong[0]], "sizes do not match: left and right side", item.span)
        return not wrong

    def _iterator_on_the_left(self, item: ast.Equation | ast.Choice) -> bool:
        self._sink.error(Code.WRONG_LEFT_SIDE, "an iterator cannot be defined by an item", item.target.span)
        return False


def _parts(item: ast.Equation | ast.Choice) -> list[ast.Expression]:
    """Expressions of the right side, triples included."""
    if isinstance(item, ast.Equation):
        return [item.value, *_entries(item.triple)]
    otherwise = [] if item.otherwise is None else [item.otherwise]
    return [item.condition, item.then, *otherwise, *_entries(item.then_triple), *_entries(item.otherwise_triple)]


def _entries(triple: ast.Triple | None) -> list[ast.Expression]:
    return [] if triple is None else [triple.low, triple.high, triple.epsilon]


def _with_parts(
    item: ast.Equation | ast.Choice, target: ast.Expression, parts: list[ast.Expression], continues: bool
) -> ast.Item:
    assert isinstance(target, ast.Name)
    rest = iter(parts)
    if isinstance(item, ast.Equation):
        return ast.Equation(target, next(rest), _triple(item.triple, rest), item.span, continues)
    condition, then = next(rest), next(rest)
    otherwise = None if item.otherwise is None else next(rest)
    then_triple, otherwise_triple = _triple(item.then_triple, rest), _triple(item.otherwise_triple, rest)
    return ast.Choice(target, condition, then, then_triple, otherwise, otherwise_triple, item.span, continues)


def _triple(triple: ast.Triple | None, parts: Iterator[ast.Expression]) -> ast.Triple | None:
    return None if triple is None else ast.Triple(next(parts), next(parts), next(parts), triple.span)
