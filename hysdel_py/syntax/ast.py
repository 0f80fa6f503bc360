"""The syntax tree: what was written, and where.

Spans do not take part in equality. Expressions can be nested thousands of levels deep, so nothing here or downstream
walks them by recursion; use :func:`hysdel_py.syntax.traversal.fold`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from hysdel_py.syntax.dialect import Dialect
from hysdel_py.syntax.operators import Op
from hysdel_py.syntax.source import Span

__all__ = [
    "All", "Apply", "Choice", "Conditional", "Declaration", "DeclarationSection", "Equation", "Expression", "Group",
    "Indexed", "Interval", "Item", "ItemSection", "Loop", "Matrix", "Module", "Name", "Number", "Query", "QueryKind",
    "Range", "Requirement", "SectionKind", "System", "Triple", "Truth", "children",
]  # fmt: skip


class SectionKind(Enum):
    """Sections of the language by their keyword."""

    STATE = "STATE"
    INPUT = "INPUT"
    OUTPUT = "OUTPUT"
    PARAMETER = "PARAMETER"
    AUX = "AUX"
    AD = "AD"
    DA = "DA"
    LOGIC = "LOGIC"
    LINEAR = "LINEAR"
    CONTINUOUS = "CONTINUOUS"
    AUTOMATA = "AUTOMATA"
    MUST = "MUST"
    QUERIES = "QUERIES"


class QueryKind(Enum):
    """What a query says about its condition, by its keyword."""

    NEVER = "NEVER"
    ALWAYS = "ALWAYS"
    EVENTUALLY = "EVENTUALLY"


@dataclass(frozen=True, slots=True)
class Number:
    """A numeric literal."""

    value: float
    text: str
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Truth:
    """TRUE or FALSE."""

    value: bool
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Name:
    """The use of a name."""

    name: str
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Range:
    """``low:high`` or ``low:step:high`` as an index."""

    low: Expression
    step: Expression | None
    high: Expression
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class All:
    """``:`` as an index."""

    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Indexed:
    """Elements of a vector or matrix, as in ``x(2)`` and ``W(1, 1:2)``."""

    name: str
    indices: tuple[Expression, ...]
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Matrix:
    """``[a, b; c, d]``."""

    rows: tuple[tuple[Expression, ...], ...]
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Group:
    """An expression in parentheses."""

    inner: Expression
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Apply:
    """An operator or function applied to one or two arguments."""

    op: Op
    args: tuple[Expression, ...]
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Conditional:
    """``{IF condition THEN then ELSE otherwise}`` as a branch of another one."""

    condition: Expression
    then: Expression
    then_triple: Triple | None
    otherwise: Expression | None
    otherwise_triple: Triple | None
    span: Span = field(compare=False)


Expression = Number | Truth | Name | Range | All | Indexed | Matrix | Group | Apply | Conditional


def children(expression: Expression) -> tuple[Expression, ...]:  # noqa: PLR0911 -- a table
    """Direct sub-expressions."""
    match expression:
        case Apply(args=args):
            return args
        case Group(inner=inner):
            return (inner,)
        case Indexed(indices=indices):
            return indices
        case Matrix(rows=rows):
            return tuple(entry for row in rows for entry in row)
        case Range(low=low, step=step, high=high):
            return (low, high) if step is None else (low, step, high)
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            return (condition, then) if otherwise is None else (condition, then, otherwise)
        case _:
            return ()


@dataclass(frozen=True, slots=True)
class Interval:
    """``[low, high]`` behind a declared variable; ``[low, high; low, high]`` has `further` rows."""

    low: Expression
    high: Expression
    span: Span = field(compare=False)
    further: tuple[tuple[Expression, Expression], ...] = ()


@dataclass(frozen=True, slots=True)
class Declaration:
    """One declared variable or parameter.

    `type` is ``"REAL"`` or ``"BOOL"``, in AUX also ``"INDEX"``; variables may have an interval, parameters a value;
    `size` holds no, one or two expressions.
    """

    type: str
    name: str
    interval: Interval | None
    value: Expression | None
    span: Span = field(compare=False)
    name_span: Span = field(compare=False)
    size: tuple[Expression, ...] = ()


@dataclass(frozen=True, slots=True)
class DeclarationSection:
    """STATE, INPUT, OUTPUT or PARAMETER of the interface, or AUX of the implementation."""

    kind: SectionKind
    declarations: tuple[Declaration, ...]
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Triple:
    """``[min, max, epsilon]`` behind a threshold or a branch."""

    low: Expression
    high: Expression
    epsilon: Expression
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Equation:
    """``target = value``; a threshold in AD may carry a triple.

    `continues` marks the second and later elements of an item over vectors.
    """

    target: Name | Indexed
    value: Expression
    triple: Triple | None
    span: Span = field(compare=False)
    continues: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Choice:
    """``target = {IF condition THEN then ELSE otherwise}``."""

    target: Name | Indexed
    condition: Expression
    then: Expression
    then_triple: Triple | None
    otherwise: Expression | None
    otherwise_triple: Triple | None
    span: Span = field(compare=False)
    continues: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Requirement:
    """An item of MUST."""

    value: Expression
    span: Span = field(compare=False)
    continues: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Query:
    """An item of QUERIES: ``NEVER condition WITHIN steps FROM start``."""

    kind: QueryKind
    condition: Expression
    steps: Expression
    start: Expression | None
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class Loop:
    """``FOR (iterator = low:step:high) { items }``; the step may be missing."""

    iterator: Name
    low: Expression
    step: Expression | None
    high: Expression
    items: tuple[Item, ...]
    span: Span = field(compare=False)


Item = Equation | Choice | Requirement | Query | Loop


@dataclass(frozen=True, slots=True)
class Module:
    """A sub-system: the name of its file without ``.hys``, and its own name."""

    file: Name
    name: Name


@dataclass(frozen=True, slots=True)
class ItemSection:
    """A section of the implementation with its items in file order."""

    kind: SectionKind
    items: tuple[Item, ...]
    span: Span = field(compare=False)


@dataclass(frozen=True, slots=True)
class System:
    """A whole file."""

    name: str
    declarations: tuple[DeclarationSection, ...]
    sections: tuple[ItemSection, ...]
    span: Span = field(compare=False)
    modules: tuple[Module, ...] = ()
    dialect: Dialect = Dialect.HYSDEL_2
