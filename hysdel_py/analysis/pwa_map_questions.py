"""Are the maps of a mode those of the Dha under its word, and do two modes hold at once?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.encoding import Step
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.pwa_pair import fix_word, overlapping_pairs
from hysdel_py.analysis.pwa_search import KnownCell, PwaSearch, Search, mode_name
from hysdel_py.analysis.questions import Answered, worst
from hysdel_py.analysis.report import Check, CheckStatus, Question
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.mode import Mode

__all__ = ["map_check", "overlap_checks"]

Vector = NDArray[np.float64]

_DEEP = 4.0
"""An overlap is deeper than that many tolerances."""


def map_check(search: PwaSearch, mode: Mode, own: list[KnownCell]) -> Check:
    """Are the next states and outputs those of the Dha under each word of the mode?"""
    statuses = []
    how = "coefficients"
    for cell in own:
        known = None if cell.evaluation is None else cell.evaluation.results
        for name, row in _rows_of_map(search, mode):
            if known is not None and _is_same(search, name, known[name] - row, row, cell):
                continue
            how = "model"
            status, witness = _differing(search, cell, name, row)
            if witness is not None:
                return Check(Question.MODE, f"{mode_name(mode.index, mode.bits)}, {name}", status, how, witness=witness)
            statuses.append(status)
    return Check(Question.MODE, mode_name(mode.index, mode.bits), worst(statuses), how)


def _rows_of_map(search: PwaSearch, mode: Mode) -> Iterator[tuple[str, Vector]]:
    names = (*(f"{v.name}'" for v in search.pwa.x), *(v.name for v in search.pwa.y))
    return zip(names, mode.dynamics, strict=True)


def _form(search: PwaSearch, row: Vector) -> Affine:
    terms = zip(search.pair.names, row, strict=False)
    return Affine(float(row[-1]), tuple((name, float(c)) for name, c in terms if c))


def _tolerance(search: PwaSearch, name: str, row: Vector) -> float:
    own = search.comparison.margins.distance(_form(search, row), search.comparison.ranges)
    return max(own, 2.0 * search.comparison.tolerances[name])


def _is_same(search: PwaSearch, name: str, difference: Vector, row: Vector, cell: KnownCell) -> bool:
    """Whether two maps differ nowhere in the ranges by more than the tolerance; Booleans of the word are fixed."""
    ranges = {**search.comparison.ranges, **{n: (float(v), float(v)) for n, v in cell.word}}
    low, high = _form(search, difference).range(ranges.__getitem__)
    return max(abs(low), abs(high)) <= _tolerance(search, name, row)


def _differing(search: PwaSearch, cell: KnownCell, name: str, row: Vector) -> Answered:
    statuses = []
    for sign in (1.0, -1.0):

        def pose(problem: Milp, step: Step, sign: float = sign) -> Search:
            fix_word(problem, step, cell.word)
            own = step.next[name[:-1]] if name.endswith("'") else step.outputs[name]
            objective = {own: sign, **search.pair.terms(-sign * row[:-1], step)}
            return problem, objective, _tolerance(search, name, row) + sign * float(row[-1])

        status, witness = search.ask(pose)
        if witness is not None:
            return status, witness
        statuses.append(status)
    return worst(statuses), None


def overlap_checks(search: PwaSearch, regions: list[Check]) -> Iterator[Check]:
    """Different words exclude common points where each region lies in its cells; other pairs are searched."""
    status = worst([check.status for check in regions])
    apart = CheckStatus.HOLDS if status is CheckStatus.HOLDS else CheckStatus.NOT_SETTLED
    yield Check(Question.OVERLAP, "modes that differ in a Boolean", apart, "words")
    for first, second in overlapping_pairs(search.pwa.modes):
        status, witness = _common(search, first, second)
        subject = f"modes {first.index} and {second.index}"
        yield Check(Question.OVERLAP, subject, status, "model", witness=witness)


def _common(search: PwaSearch, first: Mode, second: Mode) -> Answered:
    def pose(problem: Milp, step: Step) -> Search:
        depth = problem.real(0.0, 1.0)
        for mode in (first, second):
            search.pair.add_region(problem, step, mode, depth)
        return problem, {depth: 1.0}, _DEEP * search.comparison.margins.tolerance

    return search.ask(pose)
