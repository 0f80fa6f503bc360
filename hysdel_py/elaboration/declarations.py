"""Declarations of vectors and matrices to those of their elements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.elaboration.block import Block
from hysdel_py.elaboration.expressions import ExpressionElaborator
from hysdel_py.elaboration.given import entries_of
from hysdel_py.elaboration.scope import MAX_ELEMENTS, Scope, Shape, element
from hysdel_py.syntax import ast
from hysdel_py.syntax.ast import SectionKind
from hysdel_py.syntax.source import Span
from hysdel_py.syntax.structure import names_in

__all__ = ["DeclarationElaborator"]


class DeclarationElaborator:
    """Elaborates the declarations of one file into its scope.

    Parameters
    ----------
    given : mapping
        Values of parameters from the caller, by full name; those of matrices are replaced by those of their elements.
    """

    def __init__(self, scope: Scope, given: dict[str, object]) -> None:
        self._scope = scope
        self._sink = scope.sink
        self._given = given
        self._expressions = ExpressionElaborator(scope)
        self._values: dict[str, Block] = {}

    def sections(self, sections: tuple[ast.DeclarationSection, ...]) -> tuple[ast.DeclarationSection, ...]:
        """Sections whose declarations are scalar; iterators are gone."""
        self._check_names(sections)
        parameters = [d for s in sections if s.kind is SectionKind.PARAMETER for d in s.declarations]
        variables = [d for s in sections if s.kind is not SectionKind.PARAMETER for d in s.declarations]
        for declaration in _in_order_of_use(parameters):
            self._declare_parameter(declaration)
        for declaration in variables:
            self._declare_variable(declaration)
        return tuple(
            replace(s, declarations=tuple(flat for d in s.declarations for flat in self._flat(d, s.kind)))
            for s in sections
        )

    def _check_names(self, sections: tuple[ast.DeclarationSection, ...]) -> None:
        first: dict[str, ast.Declaration] = {}
        for declaration in (d for s in sections for d in s.declarations):
            dot = declaration.name.find(".")
            if dot >= 0:
                place = declaration.name_span.start + dot
                self._sink.error(
                    Code.BAD_CHARACTER, "the character '.' cannot stand in a declared name", Span(place, place + 1),
                    help="names hold letters, digits and underscores only; a dot leads into a module",
                )  # fmt: skip
            earlier = first.setdefault(declaration.name, declaration)
            if earlier is not declaration and (
                earlier.size or declaration.size or "INDEX" in (earlier.type, declaration.type)
            ):
                self._sink.error(
                    Code.DECLARED_TWICE, f"{declaration.name} is already declared", declaration.name_span,
                    labels=(Label(earlier.name_span, "declared here"),),
                )  # fmt: skip

    # ---- sizes and values ----

    def _declare_parameter(self, declaration: ast.Declaration) -> None:
        value = None if declaration.value is None else self._expressions.block(declaration.value)
        shape = self._shape(declaration)
        if shape is None and value is not None and not value.is_scalar:
            shape = Shape(value.rows, value.columns, 1 if value.columns == 1 else 2, declaration.name_span)
        self._register(declaration, shape)
        if value is not None:
            if shape is not None and not value.is_scalar and value.shape != (shape.rows, shape.columns):
                declared = Block(shape.rows, shape.columns, (), declaration.name_span)
                self._scope.mismatch(
                    [declared, value], "sizes do not match: a parameter and its value", declaration.span
                )
                return
            self._values[declaration.name] = value
        self._bind(declaration, shape, value)

    def _bind(self, declaration: ast.Declaration, shape: Shape | None, value: Block | None) -> None:
        """Note the numbers that are known already."""
        full = self._scope.prefix + declaration.name
        if full in self._given and shape is not None:
            entries = entries_of(self._given.pop(full), shape, full, declaration.name_span, self._sink)
            for place, entry in zip(_places(shape), entries, strict=False):
                self._given[element(full, shape, place)] = entry
        for k, name in enumerate(_names(full, shape)):
            number = _as_number(self._given[name]) if name in self._given else None
            if number is None and value is not None and name not in self._given:
                number = self._scope.value(value.element(k))
            if number is not None:
                self._scope.numbers[name] = number

    def _declare_variable(self, declaration: ast.Declaration) -> None:
        if declaration.type == "INDEX":
            self._scope.iterators[declaration.name] = None
            self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no INDEX", declaration.name_span)
        else:
            self._register(declaration, self._shape(declaration))

    def _shape(self, declaration: ast.Declaration) -> Shape | None:
        """Declared size, None for a scalar."""
        if not declaration.size:
            return None
        numbers = []
        for expression in declaration.size:
            number = self._scope.integer(self._expressions.block(expression), f"the size of {declaration.name}")
            if number is not None and not 1 <= number <= MAX_ELEMENTS:
                self._sink.error(
                    Code.SIZE,
                    f"the size of {declaration.name} is {number}: 1 to {MAX_ELEMENTS} was expected",
                    expression.span,
                )
                number = None
            numbers.append(number or 1)
        rows, columns = numbers[0], numbers[1] if len(numbers) == 2 else 1
        if rows * columns > MAX_ELEMENTS:
            self._sink.error(Code.SIZE, f"{declaration.name} has more than {MAX_ELEMENTS} elements", declaration.span)
            rows = columns = 1
        return Shape(rows, columns, len(numbers), declaration.name_span)

    def _register(self, declaration: ast.Declaration, shape: Shape | None) -> None:
        full = self._scope.prefix + declaration.name
        if shape is None:
            self._scope.scalars.add(full)
            return
        self._scope.shapes[full] = shape
        self._sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no vectors and matrices", declaration.span)

    # ---- flat declarations ----

    def _flat(self, declaration: ast.Declaration, kind: SectionKind) -> Iterator[ast.Declaration]:
        if declaration.type == "INDEX":
            return
        full = self._scope.prefix + declaration.name
        names = _names(full, self._scope.shapes.get(full))
        value = self._values.get(declaration.name) if kind is SectionKind.PARAMETER else None
        intervals = self._intervals(declaration, len(names))
        for k, name in enumerate(names):
            entry = None if value is None else value.element(k)
            yield replace(declaration, name=name, interval=intervals[k], value=entry, size=())

    def _intervals(self, declaration: ast.Declaration, count: int) -> list[ast.Interval | None]:
        """The interval of each element: one for all, or as many rows as elements."""
        interval = declaration.interval
        if interval is None:
            return [None] * count
        pairs = [(interval.low, interval.high), *interval.further]
        low, high = (self._column([pair[side] for pair in pairs]) for side in (0, 1))
        if low is None or high is None:
            return [None] * count
        if {len(low), len(high)} - {1, count}:
            self._sink.error(
                Code.SIZE_MISMATCH,
                f"{declaration.name} has size {count} and {max(len(low), len(high))} pairs of bounds",
                interval.span,
                help="give one pair for all, or one for each element, separated by semicolons",
            )
            return [None] * count
        return [ast.Interval(low[k % len(low)], high[k % len(high)], interval.span) for k in range(count)]

    def _column(self, expressions: list[ast.Expression]) -> list[ast.Expression] | None:
        blocks = [self._expressions.block(expression) for expression in expressions]
        known = [block for block in blocks if block is not None]
        return [e for block in known for e in block.elements] if len(known) == len(blocks) else None


def _places(shape: Shape) -> list[tuple[int, int]]:
    return [(i, j) for i in range(1, shape.rows + 1) for j in range(1, shape.columns + 1)]


def _names(full: str, shape: Shape | None) -> list[str]:
    return [full] if shape is None else [element(full, shape, place) for place in _places(shape)]


def _as_number(value: object) -> float | None:
    """A value from the caller as a number; whether it is a proper one is checked when parameters are bound."""
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None


def _in_order_of_use(parameters: list[ast.Declaration]) -> list[ast.Declaration]:
    """Parameters such that each comes after those that it needs; as they stand if there is a circle."""
    by_name: Mapping[str, ast.Declaration] = {declaration.name: declaration for declaration in parameters}
    graph = {
        d.name: [n for e in (d.value, *d.size) if e is not None for n in names_in(e) if n in by_name]
        for d in parameters
    }
    try:
        return [by_name[name] for name in TopologicalSorter(graph).static_order()]
    except CycleError:
        return parameters
