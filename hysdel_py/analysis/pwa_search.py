"""Mixed-integer searches over a step of a Dha beside a Pwa, and what is known of each cell before."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

from hysdel_py.analysis.encoding import Step
from hysdel_py.analysis.milp import Milp, Status
from hysdel_py.analysis.pwa_pair import PwaPair, fix_word
from hysdel_py.analysis.pwa_proofs import CellRows, cell_rows
from hysdel_py.analysis.pwa_words import Cell, Evaluation, evaluated
from hysdel_py.analysis.questions import STATUS, Answered, Confirmed
from hysdel_py.analysis.report import CheckStatus

__all__ = ["KnownCell", "PwaSearch", "Search", "mode_name"]

Search = tuple[Milp, dict[int, float], float]
"""A problem, its objective, and the threshold that a point has to exceed."""


class KnownCell:
    """A cell, and what its word makes of the definitions, where that follows without a search."""

    def __init__(self, search: PwaSearch, cell: Cell) -> None:
        self.word = cell.word
        self.cell = cell
        self.evaluation: Evaluation | None = evaluated(search.comparison.dha, cell.word)
        self.rows: CellRows | None = (
            None if self.evaluation is None else cell_rows(search.comparison, cell, self.evaluation)
        )


class PwaSearch:
    """The problems that the questions about one Pwa share."""

    def __init__(self, pair: PwaPair) -> None:
        self.pair, self.comparison, self.pwa = pair, pair.comparison, pair.pwa

    @cached_property
    def steps(self) -> tuple[tuple[Milp, Step], tuple[Milp, Step]]:
        """A step with MUST, on thresholds too, and away from them."""
        return self.comparison.whole(clear=False), self.comparison.whole(clear=True)

    @cached_property
    def free_steps(self) -> tuple[tuple[Milp, Step], tuple[Milp, Step]]:
        """The same without MUST."""
        return self.comparison.whole(must=False, clear=False), self.comparison.whole(must=False, clear=True)

    def ask(self, pose: Callable[[Milp, Step], Search], *, must: bool = True) -> Answered:
        """Ask everywhere first, and where points do not stand, away from thresholds.

        Parameters
        ----------
        pose : callable
            Makes a search of a copy of a step.
        must : bool
            Whether the step keeps MUST.
        """
        status = CheckStatus.HOLDS
        for problem, step in self.steps if must else self.free_steps:
            confirmed = Confirmed(self.pair, step, self.comparison.clock)
            found = STATUS[confirmed.search(*pose(problem.copy(), step)).found]
            if found is CheckStatus.DIFFERENT:
                return found, confirmed.witness
            status = found if status is CheckStatus.HOLDS else status
            if status is not CheckStatus.DOUBTFUL:
                break
        return status, None

    def home(self, cell: Cell) -> int | None:
        """The mode of a cell; -1 where it has no point, None where no region holds the point that was found."""
        if cell.is_sure:
            return cell.modes[0]
        for problem, step in reversed(self.steps):
            work = problem.copy()
            fix_word(work, step, cell.word)
            answer = work.search(seconds=self.comparison.clock.allowance())
            fine = work.refine(answer.w) if answer.status is Status.FOUND else answer
            if fine.status is not Status.NONE:
                modes = self.pair.modes_at(fine.w, step) if fine.status is Status.FOUND else []
                return next((mode for mode in modes if mode in cell.modes), next(iter(modes), None))
        return -1


def mode_name(index: int, bits: str) -> str:
    """How reports call a mode."""
    return f"mode {index} ({bits})"
