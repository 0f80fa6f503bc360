"""Propositional formulas over named Boolean variables.

A formula is kept in postfix order, which needs no recursion however deep it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

__all__ = ["Connective", "Formula", "Literal"]


class Connective(Enum):
    """Logic connectives by their spelling."""

    NOT = "~"
    AND = "&"
    OR = "|"
    IMPLIES = "->"
    IMPLIED_BY = "<-"
    IFF = "<->"


@dataclass(frozen=True, slots=True)
class Literal:
    """A variable, or its negation if `positive` is false."""

    name: str
    positive: bool = True

    def __str__(self) -> str:
        return self.name if self.positive else f"~{self.name}"


@dataclass(frozen=True, slots=True)
class Formula:
    """A formula as a postfix sequence of names, truth values and connectives."""

    postfix: tuple[str | bool | Connective, ...]

    @property
    def literal(self) -> Literal | None:
        """The literal if the formula is a variable or its single negation, else None."""
        match self.postfix:
            case (str(name),):
                return Literal(name)
            case (str(name), Connective.NOT):
                return Literal(name, positive=False)
            case _:
                return None

    @property
    def names(self) -> tuple[str, ...]:
        """Variables in the order of first use."""
        return tuple(dict.fromkeys(entry for entry in self.postfix if isinstance(entry, str)))

    def value(self, values: Mapping[str, float]) -> bool:
        """Truth at a point whose Boolean variables are 0 or 1."""
        stack: list[bool] = []
        for entry in self.postfix:
            match entry:
                case str():
                    stack.append(values[entry] > 0.5)
                case bool():
                    stack.append(entry)
                case Connective.NOT:
                    stack.append(not stack.pop())
                case _:
                    right, left = stack.pop(), stack.pop()
                    stack.append(_combine(entry, left, right))
        return stack[0]

    def __str__(self) -> str:
        """Infix text with parentheses around every compound operand."""
        stack: list[str] = []
        for entry in self.postfix:
            if isinstance(entry, bool):
                stack.append("TRUE" if entry else "FALSE")
            elif isinstance(entry, str):
                stack.append(entry)
            elif entry is Connective.NOT:
                stack.append("~" + _wrapped(stack.pop()))
            else:
                right, left = _wrapped(stack.pop()), _wrapped(stack.pop())
                stack.append(f"{left} {entry.value} {right}")
        return stack[0]


def _wrapped(text: str) -> str:
    return f"({text})" if " " in text else text


def _combine(connective: Connective, left: bool, right: bool) -> bool:
    match connective:
        case Connective.AND:
            return left and right
        case Connective.OR:
            return left or right
        case Connective.IMPLIES:
            return not left or right
        case Connective.IMPLIED_BY:
            return left or not right
        case _:
            return left == right
