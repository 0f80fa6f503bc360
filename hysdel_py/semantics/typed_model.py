"""The typed model: what a source text means, before any parameter has a value."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hysdel_py.semantics.expressions import Expression, leaves
from hysdel_py.semantics.symbols import Role, Symbol
from hysdel_py.syntax.ast import QueryKind, SectionKind
from hysdel_py.syntax.source import Source, Span
from hysdel_py.systems.signals import Type

__all__ = ["Branch", "Choice", "Equation", "Item", "Query", "Requirement", "Threshold", "Triple", "TypedModel"]


@dataclass(frozen=True, slots=True)
class Triple:
    """Constant expressions for least and greatest value and epsilon."""

    low: Expression
    high: Expression
    epsilon: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Threshold:
    """``target = left <= right`` or ``>=``; in MUST there is no target."""

    left: Expression
    right: Expression
    at_least: bool
    triple: Triple | None = None


@dataclass(frozen=True, slots=True)
class Branch:
    """One alternative of a choice."""

    value: Expression
    triple: Triple | None


@dataclass(frozen=True, slots=True)
class Choice:
    """``target = {IF condition THEN then ELSE otherwise}``; a missing ELSE is None and means 0."""

    condition: Expression
    then: Branch
    otherwise: Branch | None


@dataclass(frozen=True, slots=True)
class Equation:
    """``target = value``."""

    value: Expression


@dataclass(frozen=True, slots=True)
class Requirement:
    """A Boolean expression that has to hold."""

    value: Expression


Body = Threshold | Choice | Equation | Requirement


@dataclass(frozen=True, slots=True)
class Item:
    """One item of the implementation.

    Attributes
    ----------
    section : SectionKind
    number : int
        Position among all items of the file, from 1.
    target : Symbol or None
        The variable that it defines; None in MUST.
    body : Threshold, Choice, Equation or Requirement
    span : Span
    line : int
        Line of the first token.
    text : str
        The item on one line.
    continues : bool
        Whether this is the second or a later element of an item over vectors.
    """

    section: SectionKind
    number: int
    target: Symbol | None
    body: Body
    span: Span
    line: int
    text: str
    continues: bool = False

    def expressions(self) -> Iterator[Expression]:
        """Expressions of the right side in the order in which they are written."""
        match self.body:
            case Threshold(left=left, right=right):
                yield from (left, right)
            case Choice(condition=condition, then=then, otherwise=otherwise):
                yield from (condition, then.value)
                if otherwise is not None:
                    yield otherwise.value
            case Equation(value=value) | Requirement(value=value):
                yield value

    def depends(self) -> tuple[Symbol, ...]:
        """Variables on the right side, once each, in the order in which they appear."""
        found = (symbol for expression in self.expressions() for symbol in leaves(expression))
        return tuple(dict.fromkeys(symbol for symbol in found if not symbol.is_parameter))


@dataclass(frozen=True, slots=True)
class Query:
    """What a model is asked: does a condition never, always or eventually hold on its runs?

    Attributes
    ----------
    kind : QueryKind
    condition : Expression
        Boolean, over states, inputs, outputs, auxiliaries and parameters.
    steps : int
    start : Expression or None
        Boolean, over states and parameters; None for all states within their ranges.
    span : Span
    line : int
    text : str
        The query over scalars, in the language.
    """

    kind: QueryKind
    condition: Expression
    steps: int
    start: Expression | None
    span: Span
    line: int
    text: str

    def expressions(self) -> Iterator[Expression]:
        """The condition, and where runs start."""
        yield self.condition
        if self.start is not None:
            yield self.start


@dataclass(frozen=True, slots=True)
class TypedModel:
    """A whole model, free of type errors; parameters are still names.

    Attributes
    ----------
    name : str
    source : Source
    symbols : tuple of Symbol
        In the order of declaration, predefined parameters first.
    items : tuple of Item
        In file order.
    queries : tuple of Query
        In file order; they change nothing in the forms.
    """

    name: str
    source: Source
    symbols: tuple[Symbol, ...]
    items: tuple[Item, ...]
    queries: tuple[Query, ...] = ()

    def select(self, role: Role, type: Type | None = None) -> tuple[Symbol, ...]:
        """Symbols of a role, in the order of declaration."""
        return tuple(s for s in self.symbols if s.role is role and type in (None, s.type))

    def vector(self, role: Role) -> tuple[Symbol, ...]:
        """Symbols of a role as they stand in a vector: reals first, then Booleans."""
        return self.select(role, Type.REAL) + self.select(role, Type.BOOL)

    @property
    def parameters(self) -> tuple[Symbol, ...]:
        """All parameters, predefined ones included."""
        return self.select(Role.PARAMETER)
