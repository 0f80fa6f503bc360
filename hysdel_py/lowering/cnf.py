"""Conjunctive normal form by distribution, without new variables.

Reproduces the set and the order of clauses of the original compiler: a conjunction keeps all its clauses, a
disjunction distributes with tautologies dropped and subsumed clauses removed.
"""

from __future__ import annotations

from dataclasses import dataclass

from hysdel_py.systems.formula import Connective, Formula, Literal

__all__ = ["MAX_CLAUSES", "Clause", "TooManyClauses", "cnf"]

MAX_CLAUSES = 4096
"""A disjunction that would distribute into more clauses than this is refused."""

Clause = tuple[Literal, ...]
"""Literals joined by OR; the empty clause is false."""


class TooManyClauses(Exception):  # noqa: N818 -- internal signal, turned into a diagnostic by its only caller
    """Distribution would explode."""


@dataclass(frozen=True, slots=True)
class _Masked:
    """A clause over numbered variables, +k or -k for the k-th, with bit masks for fast tests of inclusion."""

    literals: tuple[int, ...]
    positive: int
    negative: int

    def within(self, other: _Masked) -> bool:
        return not (self.positive & ~other.positive or self.negative & ~other.negative)

    @property
    def is_tautology(self) -> bool:
        return bool(self.positive & self.negative)


_Clauses = list[_Masked]
_FALSE = _Masked((), 0, 0)


def cnf(formula: Formula) -> tuple[Clause, ...]:
    """Clauses of a formula: none if it is a tautology, one empty clause if it is found contradictory.

    Raises
    ------
    TooManyClauses
        More than MAX_CLAUSES clauses came out of a disjunction.
    """
    names = formula.names
    number = {name: index for index, name in enumerate(names, start=1)}
    stack: list[_Clauses] = []
    for entry in formula.postfix:
        if isinstance(entry, bool):
            stack.append([] if entry else [_FALSE])
        elif isinstance(entry, str):
            stack.append([_unit(number[entry])])
        elif entry is Connective.NOT:
            stack.append(_not(stack.pop()))
        else:
            right, left = stack.pop(), stack.pop()
            stack.append(_combine(entry, left, right))
    return tuple(tuple(Literal(names[abs(n) - 1], n > 0) for n in clause.literals) for clause in stack[0])


def _unit(literal: int) -> _Masked:
    bit = 1 << abs(literal)
    return _Masked((literal,), bit if literal > 0 else 0, 0 if literal > 0 else bit)


def _combine(connective: Connective, left: _Clauses, right: _Clauses) -> _Clauses:
    match connective:
        case Connective.AND:
            return _and(left, right)
        case Connective.OR:
            return _or(left, right)
        case Connective.IMPLIES:
            return _or(_not(left), right)
        case Connective.IMPLIED_BY:
            return _or(_not(right), left)
        case _:
            return _or(_and(left, right), _and(_not(left), _not(right)))


def _and(left: _Clauses, right: _Clauses) -> _Clauses:
    """Both lists in order; an empty clause in either makes the whole false."""
    if any(not clause.literals for clause in (*left, *right)):
        return [_FALSE]
    return left + right


def _or(left: _Clauses, right: _Clauses) -> _Clauses:
    if len(left) * len(right) > MAX_CLAUSES * 4:
        raise TooManyClauses
    kept: _Clauses = []
    for first in left:
        for second in right:
            _insert(_union(first, second), kept)
        if len(kept) > MAX_CLAUSES:
            raise TooManyClauses
    return kept


def _insert(clause: _Masked, kept: _Clauses) -> None:
    if clause.is_tautology or any(other.within(clause) for other in kept):
        return
    kept[:] = [other for other in kept if not clause.within(other)]
    kept.append(clause)


def _union(first: _Masked, second: _Masked) -> _Masked:
    new = tuple(literal for literal in second.literals if literal not in first.literals)
    return _Masked(first.literals + new, first.positive | second.positive, first.negative | second.negative)


def _not(clauses: _Clauses) -> _Clauses:
    """Fold the disjunction over the clauses, each negated into a list of unit clauses."""
    result: _Clauses = [_FALSE]
    for index, clause in enumerate(clauses):
        units = [_unit(-literal) for literal in clause.literals]
        result = units if index == 0 else _or(result, units)
    return result
