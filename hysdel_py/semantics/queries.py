"""Queries of the syntax tree to typed queries."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Severity
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.expressions import Expression, Reference, children
from hysdel_py.semantics.infix import infix
from hysdel_py.semantics.symbols import Role, Symbol
from hysdel_py.semantics.typed_model import Query
from hysdel_py.semantics.typing import ExpressionTyper
from hysdel_py.syntax import ast
from hysdel_py.syntax.source import Source
from hysdel_py.systems.signals import Type

__all__ = ["resolve_queries"]


def resolve_queries(system: ast.System, symbols: Mapping[str, Symbol], source: Source, sink: Sink) -> tuple[Query, ...]:
    """Typed queries of a scalar syntax tree in file order; the wrong ones are left out and told to the sink."""
    own = Sink()  # notes about single expressions say nothing more: the original compiler knows no query at all
    resolver = _QueryResolver(symbols, source, own)
    written = list(_written(system))
    found = tuple(query for item in written for query in resolver.query(item))
    sink.include(d for d in own.diagnostics if d.severity is not Severity.NOTE)
    if written:
        sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no QUERIES", written[0].span)
    return found


def _written(system: ast.System) -> Iterator[ast.Query]:
    return (item for section in system.sections for item in section.items if isinstance(item, ast.Query))


class _QueryResolver:
    """Types the parts of a query and checks what they read."""

    def __init__(self, symbols: Mapping[str, Symbol], source: Source, sink: Sink) -> None:
        self._typer = ExpressionTyper(symbols, sink, outputs=True)
        self._source = source
        self._sink = sink

    def query(self, query: ast.Query) -> Iterator[Query]:
        """The typed query, nothing if it is wrong."""
        before = self._sink.error_count
        condition = self._typer.typed(query.condition, Type.BOOL)
        start = None if query.start is None else self._typer.typed(query.start, Type.BOOL)
        steps = self._steps(query)
        self._check_start(start)
        self._check_time(condition, steps)
        if condition is not None and self._sink.error_count == before:
            since = "" if start is None else f" FROM {infix(start)}"
            text = f"{query.kind.value} {infix(condition)} WITHIN {steps}{since}"
            line = self._source.line_of(query.span)
            yield Query(query.kind, condition, steps, start, query.span, line, text)

    def _steps(self, query: ast.Query) -> int:
        assert isinstance(query.steps, ast.Number)  # elaboration leaves a whole number
        if query.steps.value < 0:
            self._sink.error(
                Code.QUERY, f"a query needs a number of steps that is not negative, this is {query.steps.text}",
                query.steps.span,
            )  # fmt: skip
        return int(query.steps.value)

    def _check_start(self, start: Expression | None) -> None:
        wrong = [] if start is None else _other_than_states(start)
        for use in wrong[:1]:
            self._sink.error(
                Code.QUERY, f"FROM is about first states, the {use.symbol.spoken} {use.symbol.name} is none", use.span,
                help="use states and parameters",
            )  # fmt: skip

    def _check_time(self, condition: Expression | None, steps: int) -> None:
        """What is no state has no value after the last step, and so none WITHIN 0."""
        wrong = [] if condition is None else _other_than_states(condition)
        for use in wrong[: steps == 0]:
            self._sink.error(
                Code.QUERY, f"the {use.symbol.spoken} {use.symbol.name} has no value WITHIN 0: there is no step",
                use.span, help="write WITHIN 1",
            )  # fmt: skip


def _other_than_states(expression: Expression) -> list[Reference]:
    """Uses of what is neither a state nor a parameter, in the order in which they are written."""
    found, pending = [], [expression]
    while pending:
        node = pending.pop()
        if isinstance(node, Reference) and node.symbol.role is not Role.STATE and not node.symbol.is_parameter:
            found.append(node)
        pending.extend(reversed(children(node)))
    return found
