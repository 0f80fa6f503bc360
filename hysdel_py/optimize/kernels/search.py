"""The loop of a branch and bound in compiled code, in slices between which the caller looks at clocks and limits.

Propagation, condensing, active sets and certificates of :mod:`hysdel_py.optimize.kernels` for one node after the other.
What cannot be certified here is handed back: nothing is pruned without a bound or a ray that was checked against the
rows and bounds of the whole problem, and nothing becomes the incumbent without a check of all rows.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.cover import OPEN_END, inherited, keep, restrict, wished_rows
from hysdel_py.optimize.kernels.incumbents import note_word, offer, take_word, within
from hysdel_py.optimize.kernels.judging import BOUND, FLOOR, OBJECTIVE, judge, worthwhile
from hysdel_py.optimize.kernels.node import SOLVED, middle
from hysdel_py.optimize.kernels.propagation import propagate
from hysdel_py.optimize.kernels.strengthening import NEVER, narrow_root, strengthen
from hysdel_py.optimize.kernels.tree import (
    ACTIVE,
    DEPTH,
    DIVE,
    LAST,
    NODES,
    OPEN,
    PENDING,
    PLANTED,
    PROBING,
    least_open,
    push,
    take_next,
    wished,
)
from hysdel_py.optimize.kernels.visits import CUT_OFF, HINTED, INFEASIBLE, LEAF, SPLIT, digest, enter

__all__ = [
    "BOUND",
    "CALM",
    "CUT_OFF",
    "FLOOR",
    "FULL",
    "HELP",
    "HOW_MANY",
    "INFEASIBLE",
    "LEAF",
    "OBJECTIVE",
    "OPEN_END",
    "PAUSED",
    "SPLIT",
    "keep",
    "note_word",
    "run",
    "start",
]  # fmt: skip

CALM, PAUSED, FULL, HELP = 0, 1, 2, 3
"""Why a slice ended: no open node, its nodes are used up, no room for two more, a node that needs other means."""
HOW_MANY = 4
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
    numbers, counters, root = state[its.NUMBERS], state[its.COUNTERS], state[its.ROOT]
    numbers[OBJECTIVE] = numbers[FLOOR] = np.inf
    numbers[HINTED] = 1.0 if len(point) else 0.0
    counters[:] = 0
    counters[PROBING] = settings[its.PROBE_FROM] if settings[its.PROBE_FROM] > 0 else NEVER
    state[its.TOP][0][:] = np.nan
    if not open_root(data, root, settings):
        return False
    counters[DEPTH], counters[LAST] = -1, tree[its.ORDER][0]
    push(tree, counters, root, floor, -1, 0.0, active, point if len(point) else middle(root), state[its.HERE])
    if len(word):
        note_word(word, state)
    return True


@compiled
def open_root(data, root, settings):
    """Propagate the whole problem into `root`; False if that proves it empty."""
    problem, columns, wide = data[its.PROBLEM], data[its.COLUMNS], data[its.WIDE]
    start, integer, margin = problem[2][0], problem[5], settings[its.PROPAGATION][0]
    lb, ub = root
    for j in range(len(lb)):
        lb[j], ub[j] = wide[0][j], wide[1][j]
        if integer[j]:
            lb[j], ub[j] = np.ceil(lb[j] - settings[its.PROPAGATION][1]), np.floor(ub[j] + settings[its.PROPAGATION][1])
        if ub[j] - lb[j] < -margin * (1.0 + abs(lb[j])):
            return False
    l, u = problem[3], problem[4]
    for row in range(len(l)):
        empty = start[row] == start[row + 1] and (l[row] > margin or u[row] < -margin)
        if empty or l[row] > u[row] + margin * (1.0 + abs(u[row])):
            return False
    queued = np.empty(len(l), dtype=np.bool_)
    queued[:] = True
    return propagate(problem[2], columns, integer, root, (l, u), queued, settings[its.PROPAGATION])[0] < 0


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
    counters, box = state[its.COUNTERS], state[its.BOX]
    stop = counters[NODES] + slice_
    while counters[PENDING] > 0 or counters[OPEN] > 0:
        guessed = counters[PENDING] > 0 and counters[NODES] > 0
        if guessed:
            slot = counters[LAST]  # its relaxation is a good start
            ready = take_word(data, state, settings)
        elif counters[PLANTED] == 0 and counters[NODES] > 0 and len(state[its.CARRIED][1]) > 0:
            plant(data, tree, state, settings)
            continue
        elif counters[NODES] >= stop:
            return PAUSED
        elif counters[OPEN] + 2 > len(tree[its.ORDER]):
            return FULL
        elif counters[NODES] >= counters[PROBING]:
            strengthen(data, tree, state, settings)
            continue
        else:
            slot = take_next(tree[its.BOUNDS], tree[its.ORDER], counters)
            ready = enter(data, tree, slot, state, settings)
        if not ready:
            continue
        before = state[its.NUMBERS][OBJECTIVE]
        status, w, y, bound, active = judge(data, box, wished(tree, slot), state, settings)
        if guessed:
            if status == SOLVED:
                offer(data, box, w, state, settings)
        elif not digest(data, tree, (status, w, y, bound, active), state, settings):
            return HELP
        if state[its.NUMBERS][OBJECTIVE] < before:
            narrow_root(data, tree, state, settings)
        if counters[OPEN] == 0 and state[its.NUMBERS][FLOOR] >= worthwhile(state[its.NUMBERS], settings[its.GAPS]):
            counters[PENDING] = 0
    return CALM


@compiled
def plant(data, tree, state, settings):
    """Open the ends of an earlier tree in place of the halves of the root, unless they can be closed again."""
    problem, known = data[its.PROBLEM], data[its.KNOWN]
    numbers, counters, root, cover = state[its.NUMBERS], state[its.COUNTERS], state[its.ROOT], state[its.COVER]
    ways, lengths, points, multipliers, kinds = state[its.CARRIED]
    least = least_open(tree[its.BOUNDS], tree[its.ORDER], counters)
    counters[PLANTED], counters[OPEN], counters[DIVE] = 1, 0, 0
    for i in range(len(lengths)):
        box = root[0].copy(), root[1].copy()
        if not restrict(problem, data[its.COLUMNS], box, ways[i], lengths[i], settings[its.PROPAGATION]):
            keep(cover, ways[i], lengths[i], points[i], multipliers[i], OPEN_END)
            continue
        near = within(box, points[i])
        bound = max(least, inherited(problem, box, near, multipliers[i], kinds[i], known))
        if bound >= worthwhile(numbers, settings[its.GAPS]):
            numbers[FLOOR] = min(numbers[FLOOR], bound)
            keep(cover, ways[i], lengths[i], near, multipliers[i], kinds[i])
            continue
        active = wished_rows(multipliers[i], state[its.ROOT_ACTIVE][: counters[ACTIVE]], len(problem[3]))
        counters[DEPTH] = lengths[i] - 1
        code = ways[i, lengths[i] - 1]
        push(tree, counters, box, bound, code // 2, float(code % 2), active, near, ways[i])
