"""Logic as rows, connective by connective: each inner node of a formula gets a variable of its own.

After G. Tseitin, "On the complexity of derivation in propositional calculus", 1968. The new variables are real ones in
[0, 1] that are whole wherever the Booleans are, so that only the Booleans of the model are branched on.
"""

from __future__ import annotations

from collections.abc import Mapping

from hysdel_py.analysis.milp import Milp, Source
from hysdel_py.systems.formula import Connective, Formula

__all__ = ["formula_variable"]

Places = Mapping[str, int]


def formula_variable(problem: Milp, formula: Formula, values: Places, source: Source) -> int:
    """A variable that is 1 where a formula over Booleans holds and 0 elsewhere."""
    stack: list[int] = []
    for entry in formula.postfix:
        match entry:
            case str():
                stack.append(values[entry])
            case bool():
                stack.append(problem.real(float(entry), float(entry)))
            case Connective.NOT:
                stack.append(_negation(problem, stack.pop(), source))
            case _:
                right, left = stack.pop(), stack.pop()
                stack.append(_connected(problem, entry, left, right, source))
    return stack[0]


def _negation(problem: Milp, a: int, source: Source) -> int:
    c = problem.real(0.0, 1.0)
    problem.row({c: 1.0, a: 1.0}, 1.0, 1.0, source)
    return c


def _connected(problem: Milp, connective: Connective, left: int, right: int, source: Source) -> int:
    match connective:
        case Connective.AND:
            return _conjunction(problem, left, right, source)
        case Connective.OR:
            return _disjunction(problem, left, right, source)
        case Connective.IMPLIES:
            return _disjunction(problem, _negation(problem, left, source), right, source)
        case Connective.IMPLIED_BY:
            return _disjunction(problem, left, _negation(problem, right, source), source)
        case _:
            return _equivalence(problem, left, right, source)


def _add(terms: Mapping[int, float], variable: int, coefficient: float) -> dict[int, float]:
    return {**terms, variable: terms.get(variable, 0.0) + coefficient}


def _conjunction(problem: Milp, a: int, b: int, source: Source) -> int:
    c = problem.real(0.0, 1.0)
    problem.row({c: 1.0, a: -1.0}, high=0.0, source=source)
    problem.row({c: 1.0, b: -1.0}, high=0.0, source=source)
    problem.row(_add({c: 1.0, a: -1.0}, b, -1.0), low=-1.0, source=source)
    return c


def _disjunction(problem: Milp, a: int, b: int, source: Source) -> int:
    c = problem.real(0.0, 1.0)
    problem.row({c: 1.0, a: -1.0}, low=0.0, source=source)
    problem.row({c: 1.0, b: -1.0}, low=0.0, source=source)
    problem.row(_add({c: 1.0, a: -1.0}, b, -1.0), high=0.0, source=source)
    return c


def _equivalence(problem: Milp, a: int, b: int, source: Source) -> int:
    c = problem.real(0.0, 1.0)
    if a == b:
        problem.fix(c, 1.0, source)
        return c
    problem.row({c: 1.0, a: -1.0, b: -1.0}, low=-1.0, source=source)
    problem.row({c: 1.0, a: 1.0, b: 1.0}, low=1.0, source=source)
    problem.row({c: 1.0, a: 1.0, b: -1.0}, high=1.0, source=source)
    problem.row({c: 1.0, a: -1.0, b: 1.0}, high=1.0, source=source)
    return c
