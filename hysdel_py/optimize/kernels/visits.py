"""What the search does at a node: propagate into it, then drop, settle or split it by what its relaxation says.

`data`, `tree`, `state` and `settings` are those of :func:`hysdel_py.optimize.kernels.search.run`.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.branching import branching_variable, learn
from hysdel_py.optimize.kernels.cover import BOUNDED, OPEN_END, RAY, keep
from hysdel_py.optimize.kernels.guessing import queue_rows
from hysdel_py.optimize.kernels.incumbents import look_around, note_hinted, offer
from hysdel_py.optimize.kernels.judging import BOUND, FLOOR, worthwhile
from hysdel_py.optimize.kernels.linear import copy_to
from hysdel_py.optimize.kernels.node import EMPTY, SOLVED
from hysdel_py.optimize.kernels.propagation import propagate
from hysdel_py.optimize.kernels.strengthening import meet, narrow
from hysdel_py.optimize.kernels.tree import (
    ACTIVE,
    DEPTH,
    DIVE,
    FATE,
    LAST,
    NARROWED,
    NODES,
    WAY,
    push,
    push_again,
)

__all__ = ["CUT_OFF", "HINTED", "INFEASIBLE", "LEAF", "SPLIT", "digest", "enter"]

SPLIT, CUT_OFF, INFEASIBLE, LEAF = 0, 1, 2, 3
"""What became of a node."""
HINTED = 3
"""Number beside those of :mod:`judging`: whether the root begins at a point whose drivers may be good."""


@compiled
def enter(data, tree, slot, state, settings):
    """Propagated box of a node; False if that is the end of it."""
    problem, columns = data[its.PROBLEM], data[its.COLUMNS]
    numbers, counters, box = state[its.NUMBERS], state[its.COUNTERS], state[its.BOX]
    counters[DIVE], counters[LAST] = 0, slot
    state[its.RELAXED][0] = np.nan
    depth = tree[its.DEPTHS][slot]
    if tree[its.BOUNDS][slot] >= worthwhile(numbers, settings[its.GAPS]):
        numbers[FLOOR] = min(numbers[FLOOR], tree[its.BOUNDS][slot])
        keep(state[its.COVER], tree[its.WAYS][slot], depth, tree[its.NEAR][slot], state[its.MULTIPLIERS], OPEN_END)
        return False
    copy_to(state[its.HERE], tree[its.WAYS][slot, :depth])
    counters[NODES] += 1
    counters[FATE] = INFEASIBLE
    copy_to(counters[WAY:], tree[its.SPLITS][slot])
    copy_to(box[0], tree[its.LOWER][slot])
    copy_to(box[1], tree[its.UPPER][slot])
    counters[DEPTH], numbers[BOUND] = depth, tree[its.BOUNDS][slot]
    j = tree[its.SPLITS][slot, 0]
    if j < 0:
        return True
    box[0][j] = box[1][j] = tree[its.SPLITS][slot, 1]
    queued = np.zeros(len(problem[3]), dtype=np.bool_)
    queue_rows(j, columns[0], columns[1], queued)
    if counters[NARROWED] > 0:
        meet(box, state[its.ROOT], columns, queued)
    sides = problem[3], problem[4]
    if propagate(problem[2], columns, problem[5], box, sides, queued, settings[its.PROPAGATION])[0] < 0:
        return True
    grown = growth(numbers, np.inf, settings[its.GAPS])
    learn(state[its.COSTS], j, tree[its.SPLITS][slot, 1], tree[its.NEAR][slot, j], grown)
    keep(state[its.COVER], state[its.HERE], depth, tree[its.NEAR][slot], state[its.MULTIPLIERS], OPEN_END)
    if counters[NARROWED] > 0:
        call_beaten(state, settings)
    return False


@leaf
def call_beaten(state, settings):
    """Say of an empty part of a narrowed problem that it is no better than the incumbent; it may have points."""
    numbers = state[its.NUMBERS]
    state[its.COUNTERS][FATE], numbers[BOUND] = CUT_OFF, max(numbers[BOUND], worthwhile(numbers, settings[its.GAPS]))


@leaf
def growth(numbers, bound, gaps):
    """By how much a new bound is above that of the parent, as far as it matters; not a number if that is unknown."""
    before, enough = numbers[BOUND], worthwhile(numbers, gaps)
    if before == -np.inf:
        return np.nan
    if bound == np.inf and enough == np.inf:
        return 1.0 + abs(before)
    return max(min(bound, enough) - before, 0.0)


@leaf
def digest(data, tree, verdict, state, settings):
    """Drop, settle or split a node whose relaxation has been judged; False if it needs other means."""
    status, w, y, bound, active = verdict
    numbers, counters, box = state[its.NUMBERS], state[its.COUNTERS], state[its.BOX]
    copy_to(state[its.MULTIPLIERS], y)
    if counters[DEPTH] == 0 and status == SOLVED:
        copy_to(state[its.TOP][0], w)
        copy_to(state[its.TOP][1], y)
    if counters[DEPTH] == 0:
        counters[ACTIVE] = min(len(active), len(state[its.ROOT_ACTIVE]))
        keep_active(state[its.ROOT_ACTIVE], active, counters[ACTIVE])
    variable, slot = counters[WAY], counters[LAST]
    if variable >= 0 and status >= 0:
        gained = growth(numbers, np.inf if status == EMPTY else bound, settings[its.GAPS])
        learn(state[its.COSTS], variable, tree[its.SPLITS][slot, 1], tree[its.NEAR][slot, variable], gained)
    if status == EMPTY:
        keep(state[its.COVER], state[its.HERE], counters[DEPTH], w, y, RAY)
        if counters[NARROWED] > 0:
            call_beaten(state, settings)
        return True
    numbers[BOUND] = max(numbers[BOUND], bound)
    if is_beaten(state, settings):
        keep(state[its.COVER], state[its.HERE], counters[DEPTH], w, y, BOUNDED)
        return True
    if status != SOLVED:
        return False
    if not has_choice(box[0], box[1], data[its.BINARIES]):
        counters[FATE] = LEAF
        return settle(data, box, w, bound, state, settings)
    copy_to(state[its.RELAXED], w)
    every = settings[its.ROUNDING]
    if every and counters[DEPTH] % every == 0:
        look_around(data, box, w, state, settings)
        if is_beaten(state, settings):
            keep(state[its.COVER], state[its.HERE], counters[DEPTH], w, y, BOUNDED)
            return True
    if not narrow(data, box, w, y, state, settings):
        keep(state[its.COVER], state[its.HERE], counters[DEPTH], w, y, BOUNDED)
        call_beaten(state, settings)
        return True
    if counters[DEPTH] == 0 and numbers[HINTED] > 0.0:
        note_hinted(data, box, tree[its.NEAR][slot], state, settings)
    split(data, tree, box, w, active, state, settings)
    return True


@leaf
def keep_active(kept, active, count):
    """Keep the first active inequalities of the root."""
    for i in range(count):
        kept[i, 0], kept[i, 1] = active[i, 0], active[i, 1]


@leaf
def is_beaten(state, settings):
    """Whether the node at hand cannot be better than the incumbent by more than the gap; it is closed then."""
    numbers = state[its.NUMBERS]
    if numbers[BOUND] < worthwhile(numbers, settings[its.GAPS]):
        return False
    numbers[FLOOR] = min(numbers[FLOOR], numbers[BOUND])
    state[its.COUNTERS][FATE] = CUT_OFF
    return True


@leaf
def has_choice(lb, ub, binaries):
    """Whether a binary is not fixed."""
    for i in range(len(binaries)):
        if lb[binaries[i]] < ub[binaries[i]]:
            return True
    return False


@leaf
def settle(data, box, w, bound, state, settings):
    """Close a node without a choice: its point becomes the incumbent if it is better; False if it breaks a row."""
    numbers = state[its.NUMBERS]
    if not offer(data, box, w, state, settings):
        return False
    numbers[FLOOR] = min(numbers[FLOOR], max(bound, numbers[BOUND]))
    keep(state[its.COVER], state[its.HERE], state[its.COUNTERS][DEPTH], w, state[its.MULTIPLIERS], BOUNDED)
    return True


@leaf
def split(data, tree, box, w, active, state, settings):
    """Open the two halves of a node, the nearer one to be looked at next."""
    counters = state[its.COUNTERS]
    wanted = worthwhile(state[its.NUMBERS], settings[its.GAPS]) - state[its.NUMBERS][BOUND]
    binaries, costs = data[its.BINARIES], state[its.COSTS]
    j = branching_variable(box[0], box[1], w, binaries, data[its.PRIORITIES], settings[its.INTEGRALITY], costs, wanted)
    if j < 0:  # the cost has left one word only
        j = data[its.BINARIES][0]
        push_again(tree, counters, box, state[its.NUMBERS][BOUND], j, box[0][j], active, w, state[its.HERE])
    else:
        near = 1.0 if w[j] > 0.5 else 0.0
        push(tree, counters, box, state[its.NUMBERS][BOUND], j, 1.0 - near, active, w, state[its.HERE])
        push(tree, counters, box, state[its.NUMBERS][BOUND], j, near, active, w, state[its.HERE])
    counters[DIVE], counters[FATE] = 1, SPLIT
