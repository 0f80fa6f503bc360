"""Numbers that wait for the values of parameters.

A :class:`Symbolic` stands where a form holds a number and remembers how it is computed. It is a float whose value is
not a number, so that everything written for numbers takes it, and a plain float is as fast as ever; operations between
plain numbers never make one. Where code compares numbers it has to know about them: :func:`is_finite`, :func:`least`
and :func:`greatest` do.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator, Mapping
from functools import reduce
from typing import NoReturn

from hysdel_py.errors import ArgumentError

__all__ = [
    "Symbolic", "apply_symbolic", "evaluate", "greatest", "is_finite", "is_undefined", "least", "parameter",
    "parameters_of", "postorder",
]  # fmt: skip


class Symbolic(float):
    """A number that depends on parameters; immutable.

    Attributes
    ----------
    op : str
        ``name`` for a parameter, ``neg``, one of ``+ - * / ^``, a function of the language, ``min`` or ``max``.
    args : tuple of float
        Operands, plain numbers or symbolic ones.
    name : str
        Name of the parameter, empty for an operation.
    size : int
        Number of names, numbers and operations in the written form.
    """

    __slots__ = ("args", "name", "op", "size")
    op: str
    args: tuple[float, ...]
    name: str
    size: int

    def __new__(cls, op: str, args: tuple[float, ...] = (), name: str = "") -> Symbolic:  # noqa: D102 -- as the class says
        made = super().__new__(cls, math.nan)
        size = 1 + sum(arg.size if isinstance(arg, Symbolic) else 1 for arg in args)
        for slot, value in (("op", op), ("args", args), ("name", name), ("size", size)):
            object.__setattr__(made, slot, value)
        return made

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"a symbolic number is immutable: {name} cannot be set")

    def __reduce__(self) -> tuple[type[Symbolic], tuple[str, tuple[float, ...], str]]:
        return Symbolic, (self.op, self.args, self.name)

    def __add__(self, other: float) -> float:
        return _sum(self, other)

    def __radd__(self, other: float) -> float:
        return _sum(other, self)

    def __sub__(self, other: float) -> float:
        return _sum(self, -other)

    def __rsub__(self, other: float) -> float:
        return _sum(other, -self)

    def __neg__(self) -> float:
        if self.op == "neg":
            return self.args[0]
        return Symbolic("-", self.args[::-1]) if self.op == "-" else Symbolic("neg", (self,))

    def __mul__(self, other: float) -> float:
        return _product(self, other)

    def __rmul__(self, other: float) -> float:
        return _product(other, self)

    def __truediv__(self, other: float) -> float:
        return self if other == 1.0 else Symbolic("/", (self, other))

    def __rtruediv__(self, other: float) -> float:
        return 0.0 if other == 0.0 else Symbolic("/", (other, self))

    def __bool__(self) -> bool:
        return True

    def __repr__(self) -> str:
        return (
            f"Symbolic({self.op!r}, {self.args!r}, {self.name!r})" if self.size < 30 else f"<Symbolic of {self.size}>"
        )


def _sum(left: float, right: float) -> float:
    if right == 0.0:
        return left
    if left == 0.0:
        return right
    if isinstance(right, Symbolic):
        return Symbolic("-", (left, right.args[0])) if right.op == "neg" else Symbolic("+", (left, right))
    return Symbolic("-", (left, -right)) if right < 0 else Symbolic("+", (left, right))


def _product(left: float, right: float) -> float:
    for factor, other in ((left, right), (right, left)):
        if factor == 0.0:
            return 0.0
        if factor == 1.0:
            return other
        if factor == -1.0:
            return -other
    return Symbolic("*", (left, right))


def parameter(name: str) -> Symbolic:
    """The number that a parameter will have."""
    return Symbolic("name", (), name)


def is_finite(number: float) -> bool:
    """Whether a number is finite, as far as can be known before the parameters have values."""
    return math.isfinite(number) or isinstance(number, Symbolic)


def is_undefined(number: float) -> bool:
    """Whether arithmetic went wrong, which an open parameter is not."""
    return math.isnan(number) and not isinstance(number, Symbolic)


def least(*numbers: float) -> float:
    """Smallest of some numbers."""
    return _extreme("min", min, numbers)


def greatest(*numbers: float) -> float:
    """Greatest of some numbers."""
    return _extreme("max", max, numbers)


def _extreme(op: str, choose: Callable[..., float], numbers: tuple[float, ...]) -> float:
    """Plain numbers are decided at once; the rest becomes a chain of choices between two."""
    plain = [number for number in numbers if not isinstance(number, Symbolic)]
    if len(plain) == len(numbers):
        return choose(numbers)
    distinct = list({id(n): n for n in numbers if isinstance(n, Symbolic)}.values())
    return reduce(lambda left, right: Symbolic(op, (left, right)), [*([choose(plain)] if plain else []), *distinct])


def apply_symbolic(op: str, args: list[float]) -> float:
    """An operation with a symbolic operand: arithmetic is simplified, a function is kept."""
    if op in _ARITHMETIC:
        result: float = _ARITHMETIC[op](*args)
        return result
    return Symbolic(op, tuple(args))


_ARITHMETIC: Mapping[str, Callable[..., float]] = {
    "neg": operator.neg,
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}
_FUNCTIONS: Mapping[str, Callable[..., float]] = {
    **_ARITHMETIC,
    "^": math.pow, "sin": math.sin, "cos": math.cos, "exp": math.exp, "log": math.log, "sqrt": math.sqrt,
    "min": min, "max": max,
}  # fmt: skip


def postorder(root: Symbolic) -> Iterator[Symbolic]:
    """All distinct parts of a number, operands before operations; a part that is used twice comes once."""
    seen: set[int] = set()
    pending: list[tuple[Symbolic, bool]] = [(root, False)]
    while pending:
        node, ready = pending.pop()
        if ready:
            yield node
        elif id(node) not in seen:
            seen.add(id(node))
            pending.append((node, True))
            pending.extend((arg, False) for arg in reversed(node.args) if isinstance(arg, Symbolic))


def parameters_of(number: float) -> tuple[str, ...]:
    """Names of the parameters that a number waits for, in the order of first use."""
    if not isinstance(number, Symbolic):
        return ()
    return tuple(dict.fromkeys(node.name for node in postorder(number) if node.op == "name"))


def evaluate(number: float, values: Mapping[str, float]) -> float:
    """Number for given parameters.

    Raises
    ------
    ArgumentError
        A parameter has no value, or the arithmetic fails for these values.
    """
    if not isinstance(number, Symbolic):
        return float(number)
    known: dict[int, float] = {}
    for node in postorder(number):
        args = [known[id(arg)] if isinstance(arg, Symbolic) else arg for arg in node.args]
        known[id(node)] = _value(node, args, values)
    return known[id(number)]


def _value(node: Symbolic, args: list[float], values: Mapping[str, float]) -> float:
    if node.op == "name":
        if node.name not in values:
            raise ArgumentError(f"no value for the parameter {node.name}")
        return float(values[node.name])
    try:
        return float(_FUNCTIONS[node.op](*args))
    except (ArithmeticError, ValueError) as error:
        raise ArgumentError(f"{node.op} of {', '.join(f'{arg:g}' for arg in args)}: {error}") from None
