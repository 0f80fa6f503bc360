"""Has a Pwa the steps of a Dha? Questions to the words, regions and maps of its modes, each with proof or witness.

Together they are complete. No word of the Dha is without a mode, and its cell, the points where it has the word, lies
in the region of that mode; a region holds no point of another word, nor one that MUST or a range forbids; and in each
cell the maps are equal. Regions of modes whose words exclude each other share no point then, and only the others are
compared in pairs.
"""

from __future__ import annotations

from collections.abc import Iterator

from hysdel_py.analysis.encoding import Step
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.pwa_map_questions import map_check, overlap_checks
from hysdel_py.analysis.pwa_pair import PwaPair, exclude_words, fix_word
from hysdel_py.analysis.pwa_region_questions import cells_in_region, region_in_cells
from hysdel_py.analysis.pwa_search import KnownCell, PwaSearch, Search
from hysdel_py.analysis.pwa_words import Cell, cells_of
from hysdel_py.analysis.questions import ANY_POINT
from hysdel_py.analysis.report import Check, CheckStatus, Question

__all__ = ["MOST_MODES", "pwa_checks"]

MOST_MODES = 2000
"""With more modes the questions are not asked."""


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
    yield from _checks(PwaSearch(pair), cells)


def _open(subject: str, how: str) -> Check:
    return Check(Question.LOST_MODE, subject, CheckStatus.NOT_SETTLED, how)


def _checks(search: PwaSearch, cells: tuple[Cell, ...]) -> Iterator[Check]:
    yield _lost_word(search, cells)
    homes = [(cell, search.home(cell)) for cell in cells]
    regions = []
    for mode in search.pwa.modes:
        own = [KnownCell(search, cell) for cell, home in homes if home == mode.index]
        yield cells_in_region(search, mode, own)
        regions.append(region_in_cells(search, mode, own))
        yield regions[-1]
        yield map_check(search, mode, own)
    yield from overlap_checks(search, regions)
    yield from (_homeless(search, cell) for cell, home in homes if home is None)


def _lost_word(search: PwaSearch, cells: tuple[Cell, ...]) -> Check:
    """Has the Dha a point whose word no mode has?"""

    def pose(problem: Milp, step: Step) -> Search:
        exclude_words(problem, step, [cell.word for cell in cells])
        return problem, {}, ANY_POINT

    status, witness = search.ask(pose)
    return Check(Question.LOST_MODE, "all words of the Booleans", status, "model", witness=witness)


def _homeless(search: PwaSearch, cell: Cell) -> Check:
    """A cell with a point that no region holds."""

    def pose(problem: Milp, step: Step) -> Search:
        fix_word(problem, step, cell.word)
        return problem, {}, ANY_POINT

    status, witness = search.ask(pose)
    word = ", ".join(f"{name} = {int(value)}" for name, value in cell.word)
    settled = CheckStatus.DOUBTFUL if status is CheckStatus.HOLDS else status
    return Check(Question.LOST_MODE, f"the word {word}", settled, "model", witness=witness)
