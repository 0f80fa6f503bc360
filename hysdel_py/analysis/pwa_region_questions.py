"""Is the region of a mode the cell of its word? Row by row that the cell lies inside, and that nothing else does."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.encoding import Step
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.pwa_pair import exclude_words, fix_word
from hysdel_py.analysis.pwa_proofs import is_inside
from hysdel_py.analysis.pwa_range_questions import outside_ranges
from hysdel_py.analysis.pwa_search import KnownCell, PwaSearch, Search, mode_name
from hysdel_py.analysis.questions import ANY_POINT, Answered, violate, worst
from hysdel_py.analysis.report import Check, Question
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineRequirement, LogicRequirement
from hysdel_py.systems.mode import Mode
from hysdel_py.systems.origin import Origin

__all__ = ["cells_in_region", "region_in_cells"]

Vector = NDArray[np.float64]


def cells_in_region(search: PwaSearch, mode: Mode, own: list[KnownCell]) -> Check:
    """Does every point of the Dha with the word keep every row of the region?"""
    statuses = []
    how = "interval"
    for i, (a, b) in enumerate(zip(mode.region.A, mode.region.b, strict=True)):
        form = mode.form(a, float(b))
        for cell in own if not _is_implied(search, form) else ():
            how = "item" if how == "interval" else how
            if _is_proven(search, cell, form, a):
                continue
            how = "model"
            status, witness = _beyond(search, cell, form, a)
            if witness is not None:
                origin = _origin(mode, i, form)
                return Check(Question.LOST_MODE, _name(mode, i), status, "model", (), (origin,), witness)
            statuses.append(status)
    return Check(Question.LOST_MODE, _name(mode), worst(statuses), how)


def _is_implied(search: PwaSearch, form: Affine) -> bool:
    ranges = search.comparison.ranges
    return form.range(ranges.__getitem__)[1] <= search.comparison.margins.violation(form, ranges)


def _is_proven(search: PwaSearch, cell: KnownCell, form: Affine, a: Vector) -> bool:
    return cell.rows is not None and cell.rows.is_within(a, _level(search, form))


def _level(search: PwaSearch, form: Affine) -> float:
    """How great the terms of a row have to be for it to be violated."""
    return search.comparison.margins.violation(form, search.comparison.ranges) - form.constant


def _beyond(search: PwaSearch, cell: KnownCell, form: Affine, a: Vector) -> Answered:
    def pose(problem: Milp, step: Step) -> Search:
        fix_word(problem, step, cell.word)
        return problem, search.pair.terms(a, step), _level(search, form)

    return search.ask(pose)


def region_in_cells(search: PwaSearch, mode: Mode, own: list[KnownCell]) -> Check:
    """Has the region a point with another word, against MUST, or outside a range?"""
    statuses = []
    is_proven = len(own) == 1 and own[0].rows is not None and is_inside(mode, own[0].rows)
    how = "item" if is_proven else "model"
    left = () if is_proven else (partial(_other_word, own=own), _against_must)
    for ask in (*left, outside_ranges):
        status, witness = ask(search, mode)
        if witness is not None:
            return Check(Question.BEYOND, _name(mode), status, "model", witness=witness)
        statuses.append(status)
    return Check(Question.BEYOND, _name(mode), worst(statuses), how)


def _other_word(search: PwaSearch, mode: Mode, own: list[KnownCell]) -> Answered:
    def pose(problem: Milp, step: Step) -> Search:
        depth = problem.real(0.0, 1.0)  # deep inside, where no row of another mode can be meant
        search.pair.add_region(problem, step, mode, depth)
        exclude_words(problem, step, [cell.word for cell in own])
        return problem, {depth: 1.0}, ANY_POINT

    return search.ask(pose)


def _against_must(search: PwaSearch, mode: Mode) -> Answered:
    statuses = []
    for requirement in search.comparison.dha.requirements:

        def pose(problem: Milp, step: Step, item: AffineRequirement | LogicRequirement = requirement) -> Search:
            search.pair.add_region(problem, step, mode)
            return (problem, *violate(search.comparison, problem, item, step.values))

        status, witness = search.ask(pose, must=False)
        if witness is not None:
            return status, witness
        statuses.append(status)
    return worst(statuses), None


def _name(mode: Mode, row: int | None = None) -> str:
    return mode_name(mode.index, mode.bits) + ("" if row is None else f", row {row} of its region")


def _origin(mode: Mode, row: int, form: Affine) -> Origin:
    source = mode.sources[row]
    return Origin(line=source.line, text=source.describe(form).removesuffix(f" (line {source.line})"))
