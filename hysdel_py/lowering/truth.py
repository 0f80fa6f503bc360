"""Truth tables of formulas with few variables."""

from __future__ import annotations

from hysdel_py.systems.formula import Connective, Formula

__all__ = ["MAX_NAMES", "constant_truth"]

MAX_NAMES = 12
"""A formula over more variables is not decided."""


def constant_truth(formula: Formula) -> bool | None:
    """The value of a formula that has the same at all points, None if it varies or has too many variables.

    The table is one integer: bit k is the value at the k-th point.
    """
    names = formula.names
    if len(names) > MAX_NAMES:
        return None
    every = (1 << (1 << len(names))) - 1
    column = {name: _column(index, every) for index, name in enumerate(names)}
    stack: list[int] = []
    for entry in formula.postfix:
        match entry:
            case bool():
                stack.append(every if entry else 0)
            case str():
                stack.append(column[entry])
            case Connective.NOT:
                stack.append(every ^ stack.pop())
            case _:
                right, left = stack.pop(), stack.pop()
                stack.append(_combined(entry, left, right, every))
    return {0: False, every: True}.get(stack[0])


def _column(index: int, every: int) -> int:
    """Points at which the variable of this number is true: 2**index zeros, as many ones, and so on."""
    return every // ((1 << (1 << index)) + 1) << (1 << index)


def _combined(connective: Connective, left: int, right: int, every: int) -> int:
    match connective:
        case Connective.AND:
            return left & right
        case Connective.OR:
            return left | right
        case Connective.IMPLIES:
            return (every ^ left) | right
        case Connective.IMPLIED_BY:
            return left | (every ^ right)
        case _:
            return every ^ left ^ right
