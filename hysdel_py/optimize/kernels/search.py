"""The loop of a branch and bound in compiled code, in slices between which the caller looks at clocks and limits.

Propagation, condensing, active sets and certificates of :mod:`hysdel_py.optimize.kernels` for one node after the other.
What cannot be certified here is handed back: nothing is pruned without a bound or a ray that was checked against the
rows and bounds of the whole problem, and nothing becomes the incumbent without a check of all rows.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.optimize.compiled import compiled, leaf
from hysdel_py.optimize.kernels.branching import branching_variable, learn
from hysdel_py.optimize.kernels.cover import BOUNDED, OPEN_END, RAY, inherited, keep, restrict, wished_rows
from hysdel_py.optimize.kernels.guessing import queue_rows
from hysdel_py.optimize.kernels.incumbents import look_around, note_hinted, note_word, offer, take_word, within
from hysdel_py.optimize.kernels.judging import BOUND, FLOOR, OBJECTIVE, judge, worthwhile
from hysdel_py.optimize.kernels.linear import copy_to
from hysdel_py.optimize.kernels.node import EMPTY, SOLVED, middle
from hysdel_py.optimize.kernels.propagation import propagate
from hysdel_py.optimize.kernels.strengthening import NEVER, meet, narrow, narrow_root, strengthen
from hysdel_py.optimize.kernels.tree import (
    ACTIVE,
    DEPTH,
    DIVE,
    FATE,
    LAST,
    NARROWED,
    NODES,
    OPEN,
    PENDING,
    PLANTED,
    PROBING,
    WAY,
    least_open,
    push,
    push_again,
    take_next,
    wished,
)

__all__ = [
    "BOUND", "CALM", "CUT_OFF", "FLOOR", "FULL", "HELP", "INFEASIBLE", "LEAF",
    "NUMBERS", "OBJECTIVE", "OPEN_END", "PAUSED", "SPLIT", "keep", "note_word", "run", "start",
]  # fmt: skip

CALM, PAUSED, FULL, HELP = 0, 1, 2, 3
"""Why a slice ended: no open node, its nodes are used up, no room for two more, a node that needs other means."""
SPLIT, CUT_OFF, INFEASIBLE, LEAF = 0, 1, 2, 3
"""What became of a node."""
HINTED = 3
"""Number beside those of :mod:`judging`: whether the root begins at a point whose drivers may be good."""
NUMBERS = 4
"""How many numbers."""


@compiled
def start(data, tree, state, settings, guess):
    """Open the root and note what is known of the solution; see :func:`run`. False if the problem is proven empty.

    Parameters
    ----------
    guess : (floor, point, word, active)
        A lower bound; a point whose drivers may be good and a word of binaries, both of length 0 if there is none;
        active inequalities of a similar problem.
    """
    floor, point, word, active = guess
    numbers, counters, root = state[1], state[2], state[6]
    numbers[OBJECTIVE] = numbers[FLOOR] = np.inf
    numbers[HINTED] = 1.0 if len(point) else 0.0
    counters[:] = 0
    counters[PROBING] = settings[6] if settings[6] > 0 else NEVER
    state[13][0][:] = np.nan
    if not open_root(data, root, settings):
        return False
    counters[DEPTH], counters[LAST] = -1, tree[7][0]
    push(tree, counters, root, floor, -1, 0.0, active, point if len(point) else middle(root), state[10])
    if len(word):
        note_word(word, state)
    return True


@compiled
def open_root(data, root, settings):
    """Propagate the whole problem into `root`; False if that proves it empty."""
    problem, columns, wide = data[0], data[2], data[3]
    start, integer, margin = problem[2][0], problem[5], settings[2][0]
    lb, ub = root
    for j in range(len(lb)):
        lb[j], ub[j] = wide[0][j], wide[1][j]
        if integer[j]:
            lb[j], ub[j] = np.ceil(lb[j] - settings[2][1]), np.floor(ub[j] + settings[2][1])
        if ub[j] - lb[j] < -margin * (1.0 + abs(lb[j])):
            return False
    l, u = problem[3], problem[4]
    for row in range(len(l)):
        empty = start[row] == start[row + 1] and (l[row] > margin or u[row] < -margin)
        if empty or l[row] > u[row] + margin * (1.0 + abs(u[row])):
            return False
    queued = np.empty(len(l), dtype=np.bool_)
    queued[:] = True
    return propagate(problem[2], columns, integer, root, (l, u), queued, settings[2])[0] < 0


@compiled
def run(data, tree, state, settings, slice_):
    """Look at guesses and open nodes until something of :data:`CALM` to :data:`HELP` happens.

    The root comes before all guesses: often its relaxed point is as good as a guess, and no other program is solved.

    Parameters
    ----------
    data : (problem, groups, columns, wide, decisions, binaries, priorities, known, spare)
        `problem`, `groups`, `wide` as for :func:`hysdel_py.optimize.kernels.node.solve_node`; `columns` the rows of
        each variable; `decisions` see :func:`hysdel_py.optimize.kernels.guessing.follow`; `known` see
        :func:`hysdel_py.optimize.kernels.certificate.bound_below`; `spare` is c >= 0 with P - diag(c) positive
        semidefinite.
    tree
        See :mod:`hysdel_py.optimize.kernels.tree`.
    state : (x, numbers, counters, box, relaxed, words, root, active, pending, costs, way, multipliers, cover, top,
    carried)
        Incumbent; numbers and counters; box and relaxed point of the node at hand; words that were guessed, as
        numbers; bounds of the whole problem, propagated and narrowed by the cost, and active inequalities there; words
        to be tried; pseudo-costs, see :mod:`hysdel_py.optimize.kernels.branching`; decisions on the way to the node at
        hand, and multipliers of its relaxation; the ends of this tree, see :mod:`hysdel_py.optimize.kernels.cover`;
        point and multipliers of the relaxation of the whole problem, not numbers before there is one; the ends of an
        earlier tree that take the place of the halves of the root.
    settings : (gaps, solver, propagation, feasibility, integrality, rounding, probing, narrowing)
        `gaps` is (absolute, relative).
    slice_ : int
        Largest number of nodes.
    """
    counters, box = state[2], state[3]
    stop = counters[NODES] + slice_
    while counters[PENDING] > 0 or counters[OPEN] > 0:
        guessed = counters[PENDING] > 0 and counters[NODES] > 0
        if guessed:
            slot = counters[LAST]  # its relaxation is a good start
            ready = take_word(data, state, settings)
        elif counters[PLANTED] == 0 and counters[NODES] > 0 and len(state[14][1]) > 0:
            plant(data, tree, state, settings)
            continue
        elif counters[NODES] >= stop:
            return PAUSED
        elif counters[OPEN] + 2 > len(tree[7]):
            return FULL
        elif counters[NODES] >= counters[PROBING]:
            strengthen(data, tree, state, settings)
            continue
        else:
            slot = take_next(tree[2], tree[7], counters)
            ready = enter(data, tree, slot, state, settings)
        if not ready:
            continue
        before = state[1][OBJECTIVE]
        status, w, y, bound, active = judge(data, box, wished(tree, slot), state, settings)
        if guessed:
            if status == SOLVED:
                offer(data, box, w, state, settings)
        elif not digest(data, tree, (status, w, y, bound, active), state, settings):
            return HELP
        if state[1][OBJECTIVE] < before:
            narrow_root(data, tree, state, settings)
        if counters[OPEN] == 0 and state[1][FLOOR] >= worthwhile(state[1], settings[0]):
            counters[PENDING] = 0
    return CALM


@compiled
def plant(data, tree, state, settings):
    """Open the ends of an earlier tree in place of the halves of the root, unless they can be closed again."""
    problem, known = data[0], data[7]
    numbers, counters, root, cover = state[1], state[2], state[6], state[12]
    ways, lengths, points, multipliers, kinds = state[14]
    least = least_open(tree[2], tree[7], counters)
    counters[PLANTED], counters[OPEN], counters[DIVE] = 1, 0, 0
    for i in range(len(lengths)):
        box = root[0].copy(), root[1].copy()
        if not restrict(problem, data[2], box, ways[i], lengths[i], settings[2]):
            keep(cover, ways[i], lengths[i], points[i], multipliers[i], OPEN_END)
            continue
        near = within(box, points[i])
        bound = max(least, inherited(problem, box, near, multipliers[i], kinds[i], known))
        if bound >= worthwhile(numbers, settings[0]):
            numbers[FLOOR] = min(numbers[FLOOR], bound)
            keep(cover, ways[i], lengths[i], near, multipliers[i], kinds[i])
            continue
        active = wished_rows(multipliers[i], state[7][: counters[ACTIVE]], len(problem[3]))
        counters[DEPTH] = lengths[i] - 1
        code = ways[i, lengths[i] - 1]
        push(tree, counters, box, bound, code // 2, float(code % 2), active, near, ways[i])


@compiled
def enter(data, tree, slot, state, settings):
    """Propagated box of a node; False if that is the end of it."""
    problem, columns = data[0], data[2]
    numbers, counters, box = state[1], state[2], state[3]
    counters[DIVE], counters[LAST] = 0, slot
    state[4][0] = np.nan
    depth = tree[4][slot]
    if tree[2][slot] >= worthwhile(numbers, settings[0]):
        numbers[FLOOR] = min(numbers[FLOOR], tree[2][slot])
        keep(state[12], tree[9][slot], depth, tree[8][slot], state[11], OPEN_END)
        return False
    copy_to(state[10], tree[9][slot, :depth])
    counters[NODES] += 1
    counters[FATE] = INFEASIBLE
    copy_to(counters[WAY:], tree[3][slot])
    copy_to(box[0], tree[0][slot])
    copy_to(box[1], tree[1][slot])
    counters[DEPTH], numbers[BOUND] = depth, tree[2][slot]
    j = tree[3][slot, 0]
    if j < 0:
        return True
    box[0][j] = box[1][j] = tree[3][slot, 1]
    queued = np.zeros(len(problem[3]), dtype=np.bool_)
    queue_rows(j, columns[0], columns[1], queued)
    if counters[NARROWED] > 0:
        meet(box, state[6], columns, queued)
    sides = problem[3], problem[4]
    if propagate(problem[2], columns, problem[5], box, sides, queued, settings[2])[0] < 0:
        return True
    learn(state[9], j, tree[3][slot, 1], tree[8][slot, j], growth(numbers, np.inf, settings[0]))
    keep(state[12], state[10], depth, tree[8][slot], state[11], OPEN_END)
    if counters[NARROWED] > 0:
        call_beaten(state, settings)
    return False


@leaf
def call_beaten(state, settings):
    """Say of an empty part of a narrowed problem that it is no better than the incumbent; it may have points."""
    numbers = state[1]
    state[2][FATE], numbers[BOUND] = CUT_OFF, max(numbers[BOUND], worthwhile(numbers, settings[0]))


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
    numbers, counters, box = state[1], state[2], state[3]
    copy_to(state[11], y)
    if counters[DEPTH] == 0 and status == SOLVED:
        copy_to(state[13][0], w)
        copy_to(state[13][1], y)
    if counters[DEPTH] == 0:
        counters[ACTIVE] = min(len(active), len(state[7]))
        keep_active(state[7], active, counters[ACTIVE])
    variable, slot = counters[WAY], counters[LAST]
    if variable >= 0 and status >= 0:
        gained = growth(numbers, np.inf if status == EMPTY else bound, settings[0])
        learn(state[9], variable, tree[3][slot, 1], tree[8][slot, variable], gained)
    if status == EMPTY:
        keep(state[12], state[10], counters[DEPTH], w, y, RAY)
        if counters[NARROWED] > 0:
            call_beaten(state, settings)
        return True
    numbers[BOUND] = max(numbers[BOUND], bound)
    if is_beaten(state, settings):
        keep(state[12], state[10], counters[DEPTH], w, y, BOUNDED)
        return True
    if status != SOLVED:
        return False
    if not has_choice(box[0], box[1], data[5]):
        counters[FATE] = LEAF
        return settle(data, box, w, bound, state, settings)
    copy_to(state[4], w)
    every = settings[5]
    if every and counters[DEPTH] % every == 0:
        look_around(data, box, w, state, settings)
        if is_beaten(state, settings):
            keep(state[12], state[10], counters[DEPTH], w, y, BOUNDED)
            return True
    if not narrow(data, box, w, y, state, settings):
        keep(state[12], state[10], counters[DEPTH], w, y, BOUNDED)
        call_beaten(state, settings)
        return True
    if counters[DEPTH] == 0 and numbers[HINTED] > 0.0:
        note_hinted(data, box, tree[8][slot], state, settings)
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
    numbers = state[1]
    if numbers[BOUND] < worthwhile(numbers, settings[0]):
        return False
    numbers[FLOOR] = min(numbers[FLOOR], numbers[BOUND])
    state[2][FATE] = CUT_OFF
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
    numbers = state[1]
    if not offer(data, box, w, state, settings):
        return False
    numbers[FLOOR] = min(numbers[FLOOR], max(bound, numbers[BOUND]))
    keep(state[12], state[10], state[2][DEPTH], w, state[11], BOUNDED)
    return True


@leaf
def split(data, tree, box, w, active, state, settings):
    """Open the two halves of a node, the nearer one to be looked at next."""
    counters = state[2]
    wanted = worthwhile(state[1], settings[0]) - state[1][BOUND]
    j = branching_variable(box[0], box[1], w, data[5], data[6], settings[4], state[9], wanted)
    if j < 0:  # the cost has left one word only
        j = data[5][0]
        push_again(tree, counters, box, state[1][BOUND], j, box[0][j], active, w, state[10])
    else:
        near = 1.0 if w[j] > 0.5 else 0.0
        push(tree, counters, box, state[1][BOUND], j, 1.0 - near, active, w, state[10])
        push(tree, counters, box, state[1][BOUND], j, near, active, w, state[10])
    counters[DIVE], counters[FATE] = 1, SPLIT
