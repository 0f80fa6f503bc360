"""What the names of one file mean while it is elaborated: sizes, numbers, iterators."""

from __future__ import annotations

from dataclasses import dataclass, field

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.elaboration.block import Block
from hysdel_py.semantics.arithmetic import apply
from hysdel_py.semantics.symbols import PREDEFINED
from hysdel_py.syntax import ast
from hysdel_py.syntax.source import Span
from hysdel_py.syntax.traversal import fold

__all__ = ["MAX_ELEMENTS", "Scope", "Shape"]

MAX_ELEMENTS = 200_000
"""Most elements of one vector, and most passes of all loops together."""


@dataclass(frozen=True, slots=True)
class Shape:
    """Size of a declared vector or matrix; a vector has one index."""

    rows: int
    columns: int
    indices: int
    span: Span

    @property
    def size(self) -> str:
        """Rows and columns in words."""
        return f"{self.rows}-by-{self.columns}"


@dataclass(slots=True)
class Scope:
    """Names of one file.

    Attributes
    ----------
    prefix : str
        What is put before them: empty, or the name of the module with a dot.
    shapes : dict
        Of all vectors and matrices of the whole model, by their full name.
    scalars : set
        Full names of all other variables and parameters.
    numbers : dict
        Values of scalar parameters and of elements, as far as they are known now.
    iterators : dict
        Value of each declared iterator, None outside its loop.
    """

    prefix: str
    sink: Sink
    shapes: dict[str, Shape]
    scalars: set[str]
    numbers: dict[str, float]
    iterators: dict[str, int | None] = field(default_factory=dict)

    def full(self, name: str) -> str:
        """Name in the whole model."""
        full = self.prefix + name
        known = full in self.scalars or full in self.shapes
        return name if name in PREDEFINED and not known else full

    def whole(self, name: str, span: Span) -> Block | None:
        """All elements behind a name; None for an iterator outside its loop."""
        if name in self.iterators:
            value = self.iterators[name]
            if value is None:
                self.sink.error(
                    Code.INDEX, f"the iterator {name} has a value only inside its FOR", span, help="use it in a FOR"
                )
                return None
            return Block(1, 1, (ast.Number(float(value), str(value), span),), span)
        full = self.full(name)
        shape = self.shapes.get(full)
        if shape is None:
            return Block(1, 1, (ast.Name(full, span),), span)
        places = [(i, j) for i in range(1, shape.rows + 1) for j in range(1, shape.columns + 1)]
        return Block(shape.rows, shape.columns, tuple(ast.Name(element(full, shape, p), span) for p in places), span)

    def value(self, expression: ast.Expression) -> float | None:
        """Value of a scalar expression over parameters, None if it holds anything else or one without a value."""

        def node(node: ast.Expression, args: list[float | None]) -> float | None:
            match node:
                case ast.Number(value=value) | ast.Truth(value=value):
                    return float(value)
                case ast.Name(name=name):
                    return self.numbers.get(name)
                case ast.Group():
                    return args[0]
                case ast.Apply(op=op):
                    known = [a for a in args if a is not None]
                    return apply(op, known) if len(known) == len(args) else None
                case _:
                    return None

        return fold(expression, ast.children, node)

    def integer(self, block: Block | None, what: str) -> int | None:
        """A whole number, with an error if it is none or not known yet."""
        if block is None:
            return None
        value = self.value(block.elements[0]) if block.is_scalar else None
        if value is not None and value.is_integer():
            return int(value)
        found = "" if value is None else f", this is {value:g}"
        self.sink.error(
            Code.SIZE,
            f"{what} has to be a whole number{found}",
            block.span,
            help="use numbers, iterators and parameters that have a value in the file or are given when it is loaded",
        )
        return None

    def integers(self, low: Block | None, step: Block | None, high: Block | None, what: str) -> range | None:
        """The numbers from one end to the other, both included; None after an error, also for a step of 0."""
        first, last = self.integer(low, f"an end of {what}"), self.integer(high, f"an end of {what}")
        stride = 1 if step is None else self.integer(step, f"the step of {what}")
        if stride == 0:
            assert step is not None
            self.sink.error(Code.INDEX, f"the step of {what} is 0", step.span, help="write 1, or -1 to go down")
        if first is None or last is None or not stride:
            return None
        return range(first, last + (1 if stride > 0 else -1), stride)

    def mismatch(self, blocks: list[Block], what: str, span: Span) -> None:
        """Report blocks whose sizes do not go together."""
        sizes = " and ".join(dict.fromkeys(block.size for block in blocks))
        labels = tuple(Label(block.span, f"{block.size} here") for block in blocks)
        self.sink.error(
            Code.SIZE_MISMATCH, f"{what} of {sizes}", span, labels=labels,
            help="commas separate the entries of a row, semicolons separate rows; vectors are columns: [1; 2]",
        )  # fmt: skip


def element(name: str, shape: Shape, place: tuple[int, int]) -> str:
    """Name of an element, as it is written."""
    return f"{name}({place[0]})" if shape.indices == 1 else f"{name}({place[0]},{place[1]})"
