"""Does the region of a mode stay in the ranges? One linear program for each end that no row of it states."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.pwa_search import PwaSearch
from hysdel_py.analysis.questions import Answered, worst
from hysdel_py.analysis.report import CheckStatus
from hysdel_py.geometry.lp import LpStatus, maximise
from hysdel_py.systems.mode import Mode

__all__ = ["outside_ranges"]

Vector = NDArray[np.float64]

_ENDLESS = 1e6
"""A region that leaves a range without end is followed that far, relative to the end."""


def outside_ranges(search: PwaSearch, mode: Mode) -> Answered:
    """One linear program for each end of a range that no row of the region states."""
    statuses = [CheckStatus.HOLDS]
    for column, sign, end in _unstated_ends(search, mode):
        status, w = _greatest(search, mode, column, sign, end)
        witness = search.pair.witness_beyond(w) if w is not None else None
        if witness is not None:
            return CheckStatus.DIFFERENT, witness
        statuses.append(status)
    return worst(statuses), None


def _unstated_ends(search: PwaSearch, mode: Mode) -> Iterator[tuple[int, float, float]]:
    variables = (*search.pwa.x, *search.pwa.u)
    alone = [
        (int(np.flatnonzero(a)[0]), float(a[np.flatnonzero(a)[0]]), float(b))
        for a, b in zip(mode.region.A, mode.region.b, strict=True) if np.count_nonzero(a) == 1
    ]  # fmt: skip
    for column, v in enumerate(variables):
        for sign, end in ((1.0, v.high), (-1.0, -v.low)):
            stated = (b / abs(c) for j, c, b in alone if j == column and c * sign > 0)
            if not v.is_bool and isfinite(end) and min(stated, default=np.inf) > end + _off(search, v.low, v.high):
                yield column, sign, end


def _off(search: PwaSearch, low: float, high: float) -> float:
    """By how much a range has to be left."""
    ends = [abs(end) for end in (low, high) if isfinite(end)]
    return max(search.comparison.margins.tolerance * max(ends), 10.0 * search.pwa.tolerances.range)


def _greatest(search: PwaSearch, mode: Mode, column: int, sign: float, end: float) -> tuple[CheckStatus, Vector | None]:
    """How far a region goes beyond the end of a range; a point of it that is outside, if there is one."""
    v = (*search.pwa.x, *search.pwa.u)[column]
    c, bound = np.zeros(len(search.pair.names)), np.full(len(search.pair.names), np.inf)
    c[column] = sign
    far = _ENDLESS * max(1.0, abs(end))
    low, high = -bound, bound
    low[column], high[column] = -far, far
    if not search.comparison.clock.left:
        return CheckStatus.NOT_SETTLED, None
    answer = maximise(c, mode.region.A, mode.region.b, low, high, vertex=True)
    level = end + _off(search, v.low, v.high)
    if answer.status is LpStatus.INFEASIBLE or answer.bound <= level or (answer.is_optimal and answer.value <= level):
        return CheckStatus.HOLDS, None
    return CheckStatus.DOUBTFUL, answer.w if answer.is_optimal else None
