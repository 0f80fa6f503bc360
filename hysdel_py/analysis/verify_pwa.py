"""Has a Pwa the steps of a Dha? Questions to the words, regions and maps of its modes, each with proof or witness.

Together they are complete. No word of the Dha is without a mode, and its cell, the points where it has the word, lies
in the region of that mode; a region holds no point of another word, nor one that MUST or a range forbids; and in each
cell the maps are equal. Regions of modes whose words exclude each other share no point then, and only the others are
compared in pairs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.encoding import Step
from hysdel_py.analysis.milp import Milp, Status
from hysdel_py.analysis.pwa_pair import PwaPair, exclude_words, fix_word, overlapping_pairs
from hysdel_py.analysis.pwa_words import Cell, cells_of, maps_under
from hysdel_py.analysis.questions import ANY_POINT, STATUS, Answered, Confirmed, violate, worst
from hysdel_py.analysis.report import Check, CheckStatus, Question
from hysdel_py.geometry.lp import LpStatus, maximise
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.mode import Mode
from hysdel_py.systems.origin import Origin

__all__ = ["MOST_MODES", "pwa_checks"]

MOST_MODES = 2000
"""With more modes the questions are not asked."""

Vector = NDArray[np.float64]

_ENDLESS = 1e6
"""An endless direction of a region is followed that far, in widths of the ranges."""


def pwa_checks(pair: PwaPair) -> Iterator[Check]:
    """All questions about a Pwa.

    Parameters
    ----------
    pair : PwaPair

    Yields
    ------
    Check
        First whether a mode is missing, then three for each mode, then for each pair that no Boolean tells apart.
    """
    if not pair.pwa.is_complete or len(pair.pwa.modes) > MOST_MODES:
        yield _open(f"all modes, since there are more than {min(MOST_MODES, len(pair.pwa.modes))}", "not asked")
        return
    cells = cells_of(pair.pwa)
    if cells is None:
        yield _open("all modes, since the words of joined ones are not known or too many", "not asked")
        return
    yield from _Questions(pair, cells).checks()


def _open(subject: str, how: str) -> Check:
    return Check(Question.LOST_MODE, subject, CheckStatus.NOT_SETTLED, how)


class _Questions:
    """The questions about the modes of one Pwa, with the problems that they share."""

    def __init__(self, pair: PwaPair, cells: tuple[Cell, ...]) -> None:
        self._pair, self._cells = pair, cells
        self._comparison = pair.comparison

    def checks(self) -> Iterator[Check]:
        """All checks in turn."""
        yield self._lost_word()
        homes = [self._home(cell) for cell in self._cells]
        regions = []
        for mode in self._pair.pwa.modes:
            own = [cell for cell, home in zip(self._cells, homes, strict=True) if home == mode.index]
            yield self._cells_in_region(mode, own)
            regions.append(self._region_in_cells(mode, own))
            yield regions[-1]
            yield self._maps(mode, own)
        yield from self._overlaps(regions)
        yield from self._homeless([cell for cell, home in zip(self._cells, homes, strict=True) if home is None])

    # ---- problems ---------------------------------------------------------------------------------------------------

    @cached_property
    def _steps(self) -> tuple[tuple[Milp, Step], tuple[Milp, Step]]:
        """A step with MUST on thresholds too, and away from them."""
        return self._comparison.whole(clear=False), self._comparison.whole(clear=True)

    @cached_property
    def _free_steps(self) -> tuple[tuple[Milp, Step], tuple[Milp, Step]]:
        """The same without MUST."""
        return self._comparison.whole(must=False, clear=False), self._comparison.whole(must=False, clear=True)

    def _ask(
        self, steps: tuple[tuple[Milp, Step], ...], search: Callable[[Milp, Step], tuple[Milp, dict[int, float], float]]
    ) -> Answered:
        """Ask everywhere, and where points do not stand, away from thresholds."""
        status = CheckStatus.HOLDS
        for problem, step in steps:
            confirmed = Confirmed(self._pair, step, self._comparison.clock)
            found = STATUS[confirmed.search(*search(problem.copy(), step)).found]
            if found is CheckStatus.DIFFERENT:
                return found, confirmed.witness
            status = found if status is CheckStatus.HOLDS else status
            if status is not CheckStatus.DOUBTFUL:
                break
        return status, None

    # ---- words and their cells --------------------------------------------------------------------------------------

    def _lost_word(self) -> Check:
        def search(problem: Milp, step: Step) -> tuple[Milp, dict[int, float], float]:
            exclude_words(problem, step, [cell.word for cell in self._cells])
            return problem, {}, ANY_POINT

        status, witness = self._ask(self._steps, search)
        return Check(Question.LOST_MODE, "all words of the Booleans", status, "model", witness=witness)

    def _home(self, cell: Cell) -> int | None:
        """The mode of a cell; -1 where it has no point, None where no region holds the point that was found."""
        if cell.is_sure:
            return cell.modes[0]
        (near, step), (clear, _) = self._steps
        for problem in (clear, near):
            work = problem.copy()
            fix_word(work, step, cell.word)
            answer = work.search(seconds=self._comparison.clock.left)
            if answer.status is Status.NONE:
                continue
            fine = work.refine(answer.w) if answer.status is Status.FOUND else answer
            if fine.status is not Status.NONE:
                modes = self._pair.modes_at(fine.w, step) if fine.status is Status.FOUND else []
                return next((mode for mode in modes if mode in cell.modes), next(iter(modes), None))
        return -1

    def _homeless(self, cells: list[Cell]) -> Iterator[Check]:
        """Cells with a point that no region holds."""
        for cell in cells:
            def search(problem: Milp, step: Step, cell: Cell = cell) -> tuple[Milp, dict[int, float], float]:
                fix_word(problem, step, cell.word)
                return problem, {}, ANY_POINT

            status, witness = self._ask(self._steps, search)
            status = CheckStatus.DOUBTFUL if status is CheckStatus.HOLDS else status
            yield Check(Question.LOST_MODE, f"the word {_bits(cell)}", status, "model", witness=witness)

    def _cells_in_region(self, mode: Mode, own: list[Cell]) -> Check:
        """Does every point of the Dha with the word keep every row of the region?"""
        statuses = []
        for i, (a, b) in enumerate(zip(mode.region.A, mode.region.b, strict=True)):
            form = mode.form(a, float(b))
            for cell in own if not self._is_implied(form) else ():
                status, witness = self._beyond(cell, form, a)
                if witness is not None:
                    origin = _origin(mode, i, form)
                    return Check(Question.LOST_MODE, _name(mode, i), status, "model", (), (origin,), witness)
                statuses.append(status)
        return Check(Question.LOST_MODE, _name(mode), worst(statuses), "model" if statuses else "interval")

    def _is_implied(self, form: Affine) -> bool:
        ranges = self._comparison.ranges
        return form.range(ranges.__getitem__)[1] <= self._comparison.margins.violation(form, ranges)

    def _beyond(self, cell: Cell, form: Affine, a: Vector) -> Answered:
        level = self._comparison.margins.violation(form, self._comparison.ranges) - form.constant

        def search(problem: Milp, step: Step) -> tuple[Milp, dict[int, float], float]:
            fix_word(problem, step, cell.word)
            return problem, self._pair.terms(a, step), level

        return self._ask(self._steps, search)

    # ---- regions ----------------------------------------------------------------------------------------------------

    def _region_in_cells(self, mode: Mode, own: list[Cell]) -> Check:
        """Has the region a point with another word, against MUST, or outside a range?"""
        statuses = []
        for ask in (self._other_word, self._against_must, self._outside_ranges):
            status, witness = ask(mode, own)
            if witness is not None:
                return Check(Question.BEYOND, _name(mode), status, "model", witness=witness)
            statuses.append(status)
        return Check(Question.BEYOND, _name(mode), worst(statuses), "model")

    def _other_word(self, mode: Mode, own: list[Cell]) -> Answered:
        def search(problem: Milp, step: Step) -> tuple[Milp, dict[int, float], float]:
            self._pair.add_region(problem, step, mode)
            exclude_words(problem, step, [cell.word for cell in own])
            return problem, {}, ANY_POINT

        return self._ask(self._steps, search)

    def _against_must(self, mode: Mode, own: list[Cell]) -> Answered:  # noqa: ARG002
        statuses = []
        for requirement in self._comparison.dha.requirements:
            def search(problem: Milp, step: Step, item: object = requirement) -> tuple[Milp, dict[int, float], float]:
                self._pair.add_region(problem, step, mode)
                return (problem, *violate(self._comparison, problem, item, step.values))

            status, witness = self._ask(self._free_steps, search)
            if witness is not None:
                return status, witness
            statuses.append(status)
        return worst(statuses), None

    def _outside_ranges(self, mode: Mode, own: list[Cell]) -> Answered:  # noqa: ARG002
        """One linear program for each end of a range that no row of the region states."""
        statuses = [CheckStatus.HOLDS]
        for column, sign, end in self._unstated_ends(mode):
            status, w = self._greatest(mode, column, sign, end)
            witness = self._pair.witness_beyond(w) if w is not None else None
            if witness is not None:
                return CheckStatus.DIFFERENT, witness
            statuses.append(status)
        return worst(statuses), None

    def _unstated_ends(self, mode: Mode) -> Iterator[tuple[int, float, float]]:
        variables = (*self._pair.pwa.x, *self._pair.pwa.u)
        alone = [
            (int(np.flatnonzero(a)[0]), float(a[np.flatnonzero(a)[0]]), float(b))
            for a, b in zip(mode.region.A, mode.region.b, strict=True) if np.count_nonzero(a) == 1
        ]  # fmt: skip
        for column, v in enumerate(variables):
            for sign, end in ((1.0, v.high), (-1.0, -v.low)):
                stated = (b / abs(c) for j, c, b in alone if j == column and c * sign > 0)
                if not v.is_bool and isfinite(end) and min(stated, default=np.inf) > end + self._off(v.low, v.high):
                    yield column, sign, end

    def _off(self, low: float, high: float) -> float:
        """By how much a range has to be left."""
        ends = [abs(end) for end in (low, high) if isfinite(end)]
        return max(self._comparison.margins.tolerance * max(ends), 10.0 * self._pair.pwa.tolerances.range)

    def _greatest(self, mode: Mode, column: int, sign: float, end: float) -> tuple[CheckStatus, Vector | None]:
        """How far a region goes beyond the end of a range; a point of it that is outside, if there is one."""
        v = (*self._pair.pwa.x, *self._pair.pwa.u)[column]
        c, bound = np.zeros(len(self._pair.names)), np.full(len(self._pair.names), np.inf)
        c[column] = sign
        far = _ENDLESS * max(1.0, abs(end))
        low, high = -bound, bound
        low[column], high[column] = -far, far
        if not self._comparison.clock.left:
            return CheckStatus.NOT_SETTLED, None
        answer = maximise(c, mode.region.A, mode.region.b, low, high, vertex=True)
        level = end + self._off(v.low, v.high)
        if answer.status is LpStatus.INFEASIBLE or answer.bound <= level or (answer.is_optimal and answer.value <= level):
            return CheckStatus.HOLDS, None
        return CheckStatus.DOUBTFUL, answer.w if answer.is_optimal else None

    # ---- maps -------------------------------------------------------------------------------------------------------

    def _maps(self, mode: Mode, own: list[Cell]) -> Check:
        """Are the next states and outputs those of the Dha under each word of the mode?"""
        statuses = []
        how = "coefficients"
        for cell in own:
            known = maps_under(self._comparison.dha, cell.word)
            for name, row in self._rows_of_map(mode):
                if known is not None and self._is_same(name, known[name] - row, row, cell):
                    continue
                how = "model"
                status, witness = self._differing(cell, name, row)
                if witness is not None:
                    return Check(Question.MODE, f"{_name(mode)}, {name}", status, how, witness=witness)
                statuses.append(status)
        return Check(Question.MODE, _name(mode), worst(statuses), how)

    def _rows_of_map(self, mode: Mode) -> Iterator[tuple[str, Vector]]:
        names = (*(f"{v.name}'" for v in self._pair.pwa.x), *(v.name for v in self._pair.pwa.y))
        return zip(names, mode.dynamics, strict=True)

    def _form(self, row: Vector) -> Affine:
        terms = zip(self._pair.names, row, strict=False)
        return Affine(float(row[-1]), tuple((name, float(c)) for name, c in terms if c))

    def _tolerance(self, name: str, row: Vector) -> float:
        own = self._comparison.margins.distance(self._form(row), self._comparison.ranges)
        return max(own, 2.0 * self._comparison.tolerances[name])

    def _is_same(self, name: str, difference: Vector, row: Vector, cell: Cell) -> bool:
        """Whether two maps differ nowhere in the ranges by more than the tolerance; Booleans of the word are fixed."""
        ranges = {**self._comparison.ranges, **{n: (float(v), float(v)) for n, v in cell.word}}
        low, high = self._form(difference).range(ranges.__getitem__)
        return max(abs(low), abs(high)) <= self._tolerance(name, row)

    def _differing(self, cell: Cell, name: str, row: Vector) -> Answered:
        statuses = []
        for sign in (1.0, -1.0):
            def search(problem: Milp, step: Step, sign: float = sign) -> tuple[Milp, dict[int, float], float]:
                fix_word(problem, step, cell.word)
                own = step.next[name[:-1]] if name.endswith("'") else step.outputs[name]
                objective = {own: sign, **self._pair.terms(-sign * row[:-1], step)}
                return problem, objective, self._tolerance(name, row) + sign * float(row[-1])

            status, witness = self._ask(self._steps, search)
            if witness is not None:
                return status, witness
            statuses.append(status)
        return worst(statuses), None

    # ---- pairs ------------------------------------------------------------------------------------------------------

    def _overlaps(self, regions: list[Check]) -> Iterator[Check]:
        """Different words exclude common points where each region lies in its cells; other pairs are searched."""
        status = worst([check.status for check in regions])
        apart = CheckStatus.HOLDS if status is CheckStatus.HOLDS else CheckStatus.NOT_SETTLED
        yield Check(Question.OVERLAP, "modes that differ in a Boolean", apart, "words")
        for first, second in overlapping_pairs(self._pair.pwa.modes):
            status, witness = self._common(first, second)
            subject = f"modes {first.index} and {second.index}"
            yield Check(Question.OVERLAP, subject, status, "model", witness=witness)

    def _common(self, first: Mode, second: Mode) -> Answered:
        def search(problem: Milp, step: Step) -> tuple[Milp, dict[int, float], float]:
            depth = problem.real(0.0, 1.0)
            for mode in (first, second):
                self._add_depth(problem, step, mode, depth)
            return problem, {depth: 1.0}, 4.0 * self._comparison.margins.tolerance

        return self._ask(self._steps, search)

    def _add_depth(self, problem: Milp, step: Step, mode: Mode, depth: int) -> None:
        """The rows of a region, those over real coordinates moved inwards in proportion to the size of their terms."""
        booleans = {v.name for v in (*self._pair.pwa.x, *self._pair.pwa.u) if v.is_bool}
        for a, b in zip(mode.region.A, mode.region.b, strict=True):
            form = mode.form(a, float(b))
            size = 1.0 + sum(abs(c) * max(map(abs, self._comparison.ranges[n])) for n, c in form.terms) + abs(b)
            inwards = {} if booleans.issuperset(n for n, _ in form.terms) else {depth: float(size)}
            problem.row({**self._pair.terms(a, step), **inwards}, high=float(b))


def _name(mode: Mode, row: int | None = None) -> str:
    return f"mode {mode.index} ({mode.bits})" + ("" if row is None else f", row {row} of its region")


def _bits(cell: Cell) -> str:
    return ", ".join(f"{name} = {int(value)}" for name, value in cell.word)


def _origin(mode: Mode, row: int, form: Affine) -> Origin:
    source = mode.sources[row]
    return Origin(line=source.line, text=source.describe(form).removesuffix(f" (line {source.line})"))
