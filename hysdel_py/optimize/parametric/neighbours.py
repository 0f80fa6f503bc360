"""Active sets beyond the facets of a region, by exchange of rows (see the table in docs/mpqp.md); kernels.

An active set is a row of an int array: its rows in ascending order, then -1.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.factor import append
from hysdel_py.optimize.parametric.vectors import back_substituted, doubled, turned

__all__ = ["ActiveSet", "sets_beyond", "sorted_with"]

ActiveSet = tuple[int, ...]


@compiled
def sets_beyond(
    M: Any, free: int, active: Any, source: int, factors: Any, tolerance: float, sets: Any, count: int
) -> Any:
    """Append the active sets that may lie beyond one facet.

    Parameters
    ----------
    M : array of shape (m, n)
    free : int
        Number of variables without curvature.
    active : int array of shape (k,)
    source : int
        Row of the facet: of the problem, or ``m + `` place of a multiplier.
    factors : tuple
        Factor of the active rows, Qt and R, and two vectors of n + 1 entries.
    tolerance : float
        Sine of the angle from which a row is independent.
    sets : int array of shape (room, n)
    count : int
        Sets there are already.

    Returns
    -------
    sets, count
        `sets` is a longer array where there was no room.
    """
    if source < len(M):
        return _entering(M, active, source, factors, tolerance, sets, count)
    return _leaving(M, free, active, source - len(M), tolerance, sets, count)


@compiled
def _entering(M: Any, active: Any, row: int, factors: Any, tolerance: float, sets: Any, count: int) -> Any:
    """A row that is violated beyond the facet enters, in exchange for another if it depends on the active ones."""
    Qt, R, d, weights = factors
    k = len(active)
    if turned(Qt, M[row], k, d) > tolerance * tolerance:
        sets = doubled(sets, count)
        sorted_with(active, len(active), row, len(M), sets[count])
        return sets, count + 1
    back_substituted(R, d, k, weights)
    for place in range(k):
        if weights[place] > tolerance:
            sets = doubled(sets, count)
            sorted_with(active, place, row, len(M), sets[count])
            count += 1
    return sets, count


@compiled
def _leaving(M: Any, free: int, active: Any, place: int, tolerance: float, sets: Any, count: int) -> Any:
    """A row with a negative multiplier leaves, in exchange for a blocking row if v2 is no longer fixed."""
    if free:
        direction, fixed = _loose_direction(M, free, active, place, tolerance)
        if not fixed:
            return _blocking(M, active, place, direction, tolerance, sets, count)
    sets = doubled(sets, count)
    sorted_with(active, place, len(M), len(M), sets[count])
    return sets, count + 1


@compiled
def _loose_direction(M: Any, free: int, active: Any, place: int, tolerance: float) -> Any:
    """A direction of v2 that the other active rows leave free, and whether there is none."""
    flat = M.shape[1] - free
    Qt, R, d = np.eye(free), np.zeros((free, free)), np.empty(free)
    rank: Any = np.int64(0)
    for other in range(len(active)):
        if other != place and rank < free:
            rest = turned(Qt, M[active[other], flat:].copy(), rank, d)
            if rest > tolerance * tolerance:
                append(Qt, R, rank, d)
                rank += 1
    return Qt[free - 1].copy(), rank == free


@compiled
def _blocking(M: Any, active: Any, place: int, direction: Any, tolerance: float, sets: Any, count: int) -> Any:
    """A row leaves along a direction of v2 until another row blocks it."""
    speed = np.dot(M[:, M.shape[1] - len(direction) :].copy(), direction)
    if speed[active[place]] > 0:
        speed = -speed
    for row in active:
        speed[row] = 0.0
    for row in range(len(M)):
        if speed[row] > tolerance:
            sets = doubled(sets, count)
            sorted_with(active, place, row, len(M), sets[count])
            count += 1
    return sets, count


@compiled
def sorted_with(active: Any, without: int, row: int, last: int, out: Any) -> None:
    """An active set without one place and with one row more.

    The place ``len(active)`` and rows from `last` on mean none.
    """
    count, waiting = 0, row < last
    for place in range(len(active)):
        if place == without:
            continue
        if waiting and row < active[place]:
            out[count], waiting = row, False
            count += 1
        out[count] = active[place]
        count += 1
    if waiting:
        out[count] = row
        count += 1
    for place in range(count, len(out)):
        out[place] = -1
