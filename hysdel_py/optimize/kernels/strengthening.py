"""Bounds of a search made tighter by what it has found: by the value of the incumbent, and by probing.

What is taken away from a box is either empty or costs no less than the incumbent less (nearly) the gap; the latter
becomes the bound of the parts that are done.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.cover import keep_open
from hysdel_py.optimize.kernels.cutoff import narrow_by_cost
from hysdel_py.optimize.kernels.guessing import queue_rows
from hysdel_py.optimize.kernels.judging import FLOOR, OBJECTIVE, judge, worthwhile
from hysdel_py.optimize.kernels.linear import copy_to
from hysdel_py.optimize.kernels.node import EMPTY, SOLVED, middle
from hysdel_py.optimize.kernels.probing import probe
from hysdel_py.optimize.kernels.tree import ACTIVE, NARROWED, OPEN, PENDING, PROBING

__all__ = ["NEVER", "meet", "narrow", "narrow_root", "strengthen"]

PART = 0.99
"""Share of the gap by which a point has to be better to lie in a narrowed box: a little less than all of it, so that
what was taken away stays within the gap in spite of rounding."""
NEVER = 2**62
"""Number of nodes that is not reached."""
PROBE_AGAIN = 4
"""Factor from the number of nodes at one probing to that at the next."""
PROBES = 3
"""Largest number of rounds of one probing."""
WORTH_A_ROUND = 1e-3
"""Share of itself by which a round has to raise the bound for another one."""


@leaf
def narrow(data, box, w, y, state, settings):
    """Leave of a box what may be better than the incumbent by more than the gap; False if that is nothing.

    What is taken away is not worth less than that, and this becomes the bound of the parts that are done.
    """
    numbers, counters = state[its.NUMBERS], state[its.COUNTERS]
    if not settings[its.NARROWING] or numbers[OBJECTIVE] == np.inf or np.isnan(w[0]):
        return True
    enough = numbers[OBJECTIVE] - PART * (numbers[OBJECTIVE] - worthwhile(numbers, settings[its.GAPS]))
    bound, moved, left = narrow_by_cost(data, box, w, y, enough, settings[its.PROPAGATION])
    if moved > 0:
        counters[NARROWED] += 1
    if moved > 0 or bound >= enough:
        numbers[FLOOR] = min(numbers[FLOOR], enough)
    return left and bound < enough


@leaf
def narrow_root(data, tree, state, settings):
    """Narrow the bounds of the whole problem after a better point was found; without a rest the search is over."""
    top = state[its.TOP]
    if not narrow(data, state[its.ROOT], top[0], top[1], state, settings):
        give_up_rest(tree, state)


@leaf
def meet(box, other, columns, queued):
    """Cut a box to another one; marks the rows of what has changed."""
    for j in range(len(box[0])):
        if other[0][j] > box[0][j] or other[1][j] < box[1][j]:
            box[0][j], box[1][j] = max(box[0][j], other[0][j]), min(box[1][j], other[1][j])
            queue_rows(j, columns[0], columns[1], queued)


@compiled
def strengthen(data, tree, state, settings):
    """Probe the whole problem and solve its relaxation again, as long as that raises its bound by much."""
    numbers, counters, root, top = state[its.NUMBERS], state[its.COUNTERS], state[its.ROOT], state[its.TOP]
    counters[PROBING] *= PROBE_AGAIN
    before = -np.inf
    for _ in range(PROBES):
        left, _ = probe(data, root, settings[its.PROPAGATION])
        if not left:
            return give_up_rest(tree, state)
        near = middle(root) if np.isnan(top[0][0]) else top[0]
        guess = state[its.ROOT_ACTIVE][: counters[ACTIVE]], near
        status, w, y, bound, _ = judge(data, root, guess, state, settings)
        if status == EMPTY:
            return give_up_rest(tree, state)
        if bound >= worthwhile(numbers, settings[its.GAPS]):
            numbers[FLOOR] = min(numbers[FLOOR], bound)
            return give_up_rest(tree, state)
        if status != SOLVED:
            return None
        raise_bounds(tree, counters, bound)
        copy_to(top[0], w)
        copy_to(top[1], y)
        narrow_root(data, tree, state, settings)
        if counters[OPEN] == 0 or not bound > before + WORTH_A_ROUND * abs(bound):
            return None
        before = bound
    return None


@leaf
def give_up_rest(tree, state):
    """Close all that is open: there is nothing, or nothing better than the incumbent."""
    counters = state[its.COUNTERS]
    keep_open(tree, counters, state[its.COVER])
    counters[OPEN] = counters[PENDING] = 0


@leaf
def raise_bounds(tree, counters, bound):
    """Let a bound of the whole problem count for all open nodes."""
    for at in range(counters[OPEN]):
        slot = tree[its.ORDER][at]
        tree[its.BOUNDS][slot] = max(tree[its.BOUNDS][slot], bound)
