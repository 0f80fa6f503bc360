"""The parts into which a search has split its problem, kept for the next problem of a closed loop.

The ends of a tree, wherever it stopped, divide all words of binaries among them: each word satisfies the decisions of
exactly one end. That holds whatever the numbers of the problem are, and for the ends moved by one time step as well.
What an end was closed with, a point and multipliers or a ray, gives a bound of the same part of the next problem; it is
computed anew from the numbers of that problem, so that nothing rests on how alike the two are.

A cover is the tuple (ways, lengths, points, multipliers, kinds, limits): per end its decisions as ``2 * variable +
value`` in the order of the tree and their number, its point and multipliers, and which of :data:`OPEN_END` to
:data:`RAY` it is; `limits` are the number of ends and the largest number of decisions that is kept.

Source: T. Marcucci and R. Tedrake, "Warm start of mixed-integer programs for model predictive control of hybrid
systems", IEEE Transactions on Automatic Control 66, 2021.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.certificate import bound_below, farkas_bound
from hysdel_py.optimize.kernels.guessing import queue_rows
from hysdel_py.optimize.kernels.linear import copy_to
from hysdel_py.optimize.kernels.propagation import propagate

__all__ = [
    "BOUNDED",
    "COUNT",
    "DEEPEST",
    "OPEN_END",
    "RAY",
    "inherited",
    "keep",
    "keep_open",
    "later",
    "restrict",
    "wished_rows",
]

OPEN_END, BOUNDED, RAY = 0, 1, 2
"""Kinds of ends: without multipliers, with a point and multipliers, with a ray of Farkas."""
COUNT, DEEPEST = 0, 1
"""Entries of the limits."""


@leaf
def keep(cover, way, length, point, multipliers, kind):
    """Note an end; the deepest ends are merged with their neighbours where there is no room. No room at all: nothing.

    Parameters
    ----------
    cover
        See the module.
    way : array
        Decisions, of which `length` count.
    point, multipliers : arrays of shape (n,), (m,)
        They count unless `kind` is :data:`OPEN_END`.
    """
    ways, lengths, limits = cover[0], cover[1], cover[5]
    if len(ways) == 0:
        return
    while limits[COUNT] >= len(ways):
        coarsen(cover)
    shortened = min(length, limits[DEEPEST])
    if shortened < length and holds(ways, lengths, limits[COUNT], way, shortened):
        return
    at = limits[COUNT]
    copy_to(ways[at], way[:shortened])
    lengths[at] = shortened
    cover[4][at] = kind if shortened == length else OPEN_END
    if cover[4][at] != OPEN_END:
        copy_to(cover[2][at], point)
        copy_to(cover[3][at], multipliers)
    limits[COUNT] = at + 1


@leaf
def holds(ways, lengths, count, way, length):
    """Whether the cover has an end with these decisions."""
    for i in range(count):
        if lengths[i] != length:
            continue
        same = True
        for k in range(length):
            same = same and ways[i, k] == way[k]
        if same:
            return True
    return False


@leaf
def coarsen(cover):
    """Drop the last decision of the deepest ends, which makes neighbours one."""
    ways, lengths, limits = cover[0], cover[1], cover[5]
    deepest = 0
    for i in range(limits[COUNT]):
        deepest = max(deepest, lengths[i])
    limits[DEEPEST] = max(deepest - 1, 0)
    count = limits[COUNT]
    kept = 0
    for i in range(count):
        length = min(lengths[i], limits[DEEPEST])
        if length < lengths[i] and holds(ways, lengths, kept, ways[i], length):
            continue
        cover[4][kept] = cover[4][i] if length == lengths[i] else OPEN_END
        copy_to(ways[kept], ways[i])
        lengths[kept] = length
        copy_to(cover[2][kept], cover[2][i])
        copy_to(cover[3][kept], cover[3][i])
        kept += 1
    limits[COUNT] = kept


@leaf
def keep_open(tree, counters, cover):
    """Note the nodes that are still open, after a search that was stopped."""
    for at in range(counters[0]):
        slot = tree[its.ORDER][at]
        keep(cover, tree[its.WAYS][slot], tree[its.DEPTHS][slot], tree[its.NEAR][slot], tree[its.NEAR][slot], OPEN_END)


@compiled
def restrict(problem, columns, box, way, length, settings):
    """Take decisions within a box, which changes, and propagate; False if the rows object."""
    queued = np.zeros(len(problem[3]), dtype=np.bool_)
    lb, ub = box
    for k in range(length):
        j, value = way[k] // 2, float(way[k] % 2)
        if value < lb[j] or value > ub[j]:
            return False
        if lb[j] < ub[j]:
            lb[j] = ub[j] = value
            queue_rows(j, columns[0], columns[1], queued)
    return propagate(problem[2], columns, problem[5], box, (problem[3], problem[4]), queued, settings)[0] < 0


@leaf
def inherited(problem, box, point, multipliers, kind, known):
    """Bound of a part from what the same part was closed with one step before; infinite if it is proven empty."""
    if kind == RAY:
        return np.inf if farkas_bound(problem, box, multipliers, known[2]) > 0.0 else -np.inf
    if kind == BOUNDED:
        return bound_below(problem, box, point, multipliers, known)
    return -np.inf


@compiled
def wished_rows(multipliers, active, m):
    """Rows with a multiplier, and the bounds among some active inequalities, as a start of an active set."""
    found = np.empty((m + len(active), 2), dtype=np.int64)
    count = 0
    for row in range(len(multipliers)):
        if multipliers[row] != 0.0:
            found[count, 0], found[count, 1] = row, (1 if multipliers[row] > 0.0 else -1)
            count += 1
    for i in range(len(active)):
        if active[i, 0] >= m:
            found[count, 0], found[count, 1] = active[i, 0], active[i, 1]
            count += 1
    return found[:count]


@compiled
def later(cover: Any, count: int, plan: Any, size: int, stages: int, before: Any) -> Any:
    """The ends of a tree of a predictive problem one step later.

    Decisions of the first stage are taken as made: ends that disagree with the plan there are left out, and the others
    lose them, which leaves a cover. The last stage is new; its rows have no multipliers.

    Parameters
    ----------
    cover : (ways, lengths, points, multipliers, kinds)
    count : int
        Ends that count.
    plan : array of shape (n,)
    size, stages : int
        Variables of a stage, and of all stages.
    before : array
        For each row the one that says the same one stage earlier, -1 for none.
    """
    ways, lengths = cover[0][:count].copy(), np.zeros(count, dtype=np.int64)
    points, multipliers = cover[2][:count].copy(), np.zeros((count, cover[3].shape[1]))
    kinds = cover[4][:count].copy()
    kept = 0
    for i in range(count):
        length = 0
        agrees = True
        for k in range(cover[1][i]):
            code = cover[0][i, k]
            if code // 2 >= size:
                ways[kept, length] = code - 2 * size
                length += 1
            elif (plan[code // 2] > 0.5) != (code % 2 == 1):
                agrees = False
        if not agrees:
            continue
        lengths[kept], kinds[kept] = length, cover[4][i]
        copy_to(points[kept], cover[2][i])
        copy_to(points[kept], cover[2][i, size:stages])
        multipliers[kept] = 0.0
        for row in range(multipliers.shape[1]):
            if before[row] >= 0:
                multipliers[kept, before[row]] = cover[3][i, row]
        kept += 1
    return ways[:kept], lengths[:kept], points[:kept], multipliers[:kept], kinds[:kept]
