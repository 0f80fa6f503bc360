"""The loop of a branch and bound in compiled code, in slices between which the caller looks at clocks and limits.

Propagation, condensing, active sets and certificates of :mod:`hysdel_py.optimize.kernels` for one node after the other.
What cannot be certified here is handed back: nothing is pruned without a bound or a ray that was checked against the
rows and bounds of the whole problem, and nothing becomes the incumbent without a check of all rows.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.optimize.compiled import compiled, leaf
from hysdel_py.optimize.kernels.certificate import bound_below, excess, farkas_bound
from hysdel_py.optimize.kernels.guessing import fix_word, follow, queue_rows
from hysdel_py.optimize.kernels.node import BEATEN, EMPTY, SOLVED, middle, solve_node, value_at
from hysdel_py.optimize.kernels.propagation import propagate
from hysdel_py.optimize.kernels.tree import DEPTH, DIVE, NODES, OPEN, SOLVES, WORDS, push, take_next, wished

__all__ = ["BOUND", "CALM", "FLOOR", "FULL", "HELP", "OBJECTIVE", "PAUSED", "run", "start", "try_word"]

CALM, PAUSED, FULL, HELP = 0, 1, 2, 3
"""Why a slice ended: no open node, its nodes are used up, no room for two more, a node that needs other means."""
OBJECTIVE, FLOOR, BOUND = 0, 1, 2
"""Numbers: value of the incumbent, least bound of the parts that are done, bound of the node at hand."""

MODULUS = 2**61 - 1
"""Words of binaries are told apart by their values as numbers modulo this."""


@compiled
def start(data, tree, state, settings, guess, slice_):
    """Open the root, try what is known of the solution, and look at the first nodes; see :func:`run`.

    Parameters
    ----------
    guess : (floor, point, word, active)
        A lower bound; a point whose drivers may be good and a word of binaries, both of length 0 if there is none;
        active inequalities of a similar problem.
    """
    floor, point, word, active = guess
    numbers, counters = state[1], state[2]
    numbers[OBJECTIVE] = numbers[FLOOR] = np.inf
    counters[:] = 0
    if not open_root(data, state[6], settings):
        return CALM
    counters[DEPTH] = -1
    near = point if len(point) else middle(state[6])
    push(tree, counters, state[6], floor, -1, 0.0, active, near)
    if len(point):
        try_point(data, point, (active, near), state, settings)
    if len(word):
        try_word(data, word, state, settings)
    return run(data, tree, state, settings, slice_)


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
    queued = np.ones(len(l), dtype=np.bool_)
    return propagate(problem[2], columns, integer, root, (l, u), queued, settings[2])[0] < 0


@compiled
def run(data, tree, state, settings, slice_):
    """Look at open nodes until something of :data:`CALM` to :data:`HELP` happens.

    Parameters
    ----------
    data : (problem, groups, columns, wide, decisions, binaries, priorities, known)
        `problem`, `groups`, `wide` as for :func:`hysdel_py.optimize.kernels.node.solve_node`; `columns` the rows of
        each variable; `decisions` see :func:`hysdel_py.optimize.kernels.guessing.follow`; `known` see
        :func:`hysdel_py.optimize.kernels.certificate.bound_below`.
    tree
        See :mod:`hysdel_py.optimize.kernels.tree`.
    state : (x, numbers, counters, box, relaxed, words, root)
        Incumbent; numbers and counters; box and relaxed point of the node at hand; hashes of the words that were
        guessed; propagated bounds of the whole problem.
    settings : (gaps, solver, propagation, feasibility, integrality, rounding)
        `gaps` is (absolute, relative).
    slice_ : int
        Largest number of nodes.
    """
    numbers, counters = state[1], state[2]
    bounds, order = tree[2], tree[7]
    stop = counters[NODES] + slice_
    while counters[OPEN] > 0:
        if counters[NODES] >= stop:
            return PAUSED
        if counters[OPEN] + 2 > len(order):
            return FULL
        slot = take_next(bounds, order, counters)
        counters[DIVE] = 0
        if bounds[slot] >= worthwhile(numbers, settings[0]):
            numbers[FLOOR] = min(numbers[FLOOR], bounds[slot])
            continue
        counters[NODES] += 1
        if not explore(data, tree, slot, state, settings):
            return HELP
    return CALM


@leaf
def worthwhile(numbers, gaps):
    """Bound from which a part cannot be better than the incumbent by more than the gap."""
    objective = numbers[OBJECTIVE]
    if objective == np.inf:
        return np.inf
    return objective - max(gaps[0], gaps[1] * abs(objective))


@compiled
def explore(data, tree, slot, state, settings):
    """Drop, settle or split one node; False if it needs other means."""
    problem, _, columns = data[:3]
    numbers, counters, box, relaxed = state[1], state[2], state[3], state[4]
    box[0][:], box[1][:] = tree[0][slot], tree[1][slot]
    counters[DEPTH], numbers[BOUND] = tree[4][slot], tree[2][slot]
    relaxed[0] = np.nan
    if tree[3][slot, 0] >= 0:
        j = tree[3][slot, 0]
        box[0][j] = box[1][j] = tree[3][slot, 1]
        queued = np.zeros(len(problem[3]), dtype=np.bool_)
        queue_rows(j, columns[0], columns[1], queued)
        sides = problem[3], problem[4]
        if propagate(problem[2], columns, problem[5], box, sides, queued, settings[2])[0] >= 0:
            return True
    free = has_choice(box[0], box[1], data[5])
    status, w, bound, active = judge(data, box, wished(tree, slot), state, settings)
    if status == EMPTY:
        return True
    numbers[BOUND] = max(numbers[BOUND], bound)
    if status == BEATEN or numbers[BOUND] >= worthwhile(numbers, settings[0]):
        numbers[FLOOR] = min(numbers[FLOOR], numbers[BOUND])
        return True
    if status != SOLVED:
        return False
    if not free:
        return settle(data, box, w, bound, state, settings)
    relaxed[:] = w
    every = settings[5]
    if every and (counters[DEPTH] % every == 0):
        look_around(data, box, w, active, state, settings)
    if numbers[BOUND] >= worthwhile(numbers, settings[0]):
        numbers[FLOOR] = min(numbers[FLOOR], numbers[BOUND])
        return True
    split(data, tree, box, w, active, state, settings)
    return True


@leaf
def has_choice(lb, ub, binaries):
    """Whether a binary is not fixed."""
    for i in range(len(binaries)):
        if lb[binaries[i]] < ub[binaries[i]]:
            return True
    return False


@compiled
def judge(data, box, guess, state, settings):
    """Solve a node and certify the answer: (status, point, bound, active); a status that is not certified is -1."""
    problem, groups, _, wide, _, _, _, known = data
    numbers, counters = state[1], state[2]
    cutoff = (worthwhile(numbers, settings[0]), known[0], known[1], known[2])
    counters[SOLVES] += 1
    status, _, w, y, active = solve_node(problem, groups, box, wide, guess, cutoff, settings[1])
    if status == EMPTY:
        certain = farkas_bound(problem, box, y, known[2]) > 0.0
        return (EMPTY if certain else -1), w, -np.inf, active
    bound = bound_below(problem, box, w, y, known)
    if status == SOLVED:
        value = value_at(problem, w) + known[0]
        if not value - bound <= max(settings[0][0], settings[0][1] * abs(value)):
            status = -1
    return (status if status in (SOLVED, BEATEN) else -1), w, bound, active


@compiled
def settle(data, box, w, bound, state, settings):
    """Close a node without a choice: its point becomes the incumbent if it is better; False if it breaks a row."""
    numbers = state[1]
    if not offer(data, box, w, state, settings):
        return False
    numbers[FLOOR] = min(numbers[FLOOR], max(bound, numbers[BOUND]))
    return True


@compiled
def offer(data, box, w, state, settings):
    """Make a point with the binaries of a box the incumbent if it is better; False if it breaks a row."""
    problem, wide, binaries, known = data[0], data[3], data[5], data[7]
    for i in range(len(binaries)):
        w[binaries[i]] = box[0][binaries[i]]
    if not excess(problem, wide, w) <= settings[3]:
        return False
    value = value_at(problem, w) + known[0]
    if value < state[1][OBJECTIVE]:
        state[0][:] = w
        state[1][OBJECTIVE] = value
    return True


@compiled
def look_around(data, box, w, active, state, settings):
    """Guess words from a relaxed point: by its drivers, then by its binaries, until one is better."""
    before = state[1][OBJECTIVE]
    for drive in (True, False):
        if state[1][OBJECTIVE] >= before:
            inside = box[0].copy(), box[1].copy()
            if follow(data[0], data[2], inside, w, data[4], drive, settings[2]):
                try_settled(data, inside, (active, w), state, settings)


@compiled
def try_point(data, x, guess, state, settings):
    """Guess a word by the drivers of any point, within the bounds of the whole problem."""
    box = state[6][0].copy(), state[6][1].copy()
    if follow(data[0], data[2], box, x, data[4], True, settings[2]):
        try_settled(data, box, guess, state, settings)


@compiled
def try_word(data, word, state, settings):
    """Solve with given binaries; the point becomes the incumbent if it is better."""
    box = state[6][0].copy(), state[6][1].copy()
    if fix_word(data[0], data[2], box, data[5], word, settings[2]):
        polish(data, box, (np.zeros((0, 2), dtype=np.int64), np.zeros(0)), state, settings)


@compiled
def try_settled(data, settled, guess, state, settings):
    """Solve with the binaries of a box that has no choice left, unless they have been tried."""
    binaries, words, counters = data[5], state[5], state[2]
    word = np.empty(len(binaries))
    code = 0
    for i in range(len(binaries)):
        word[i] = settled[0][binaries[i]]
        code = (2 * code + (1 if word[i] > 0.5 else 0)) % MODULUS
    for i in range(min(counters[WORDS], len(words))):
        if words[i] == code:
            return
    words[counters[WORDS] % len(words)] = code
    counters[WORDS] += 1
    box = state[6][0].copy(), state[6][1].copy()
    if fix_word(data[0], data[2], box, binaries, word, settings[2]):
        polish(data, box, guess, state, settings)


@compiled
def polish(data, box, guess, state, settings):
    """Solve for the real variables of a box without a choice and offer the point."""
    status, w, _, _ = judge(data, box, guess, state, settings)
    if status == SOLVED:
        offer(data, box, w, state, settings)


@compiled
def split(data, tree, box, w, active, state, settings):
    """Open the two halves of a node, the nearer one to be looked at next."""
    counters = state[2]
    j = branching_variable(box[0], box[1], w, data[5], data[6], settings[4])
    near = 1.0 if w[j] > 0.5 else 0.0
    push(tree, counters, box, state[1][BOUND], j, 1.0 - near, active, w)
    push(tree, counters, box, state[1][BOUND], j, near, active, w)
    counters[DIVE] = 1


@leaf
def branching_variable(lb, ub, w, binaries, priorities, integrality):
    """The binary of the lowest priority that is farthest from 0 and 1; integral ones only if there is no other."""
    chosen, best, first = -1, -1.0, np.inf
    integral = True
    for i in range(len(binaries)):
        j = binaries[i]
        if lb[j] >= ub[j]:
            continue
        distance = min(abs(w[j]), abs(1.0 - w[j]))
        settled = distance <= integrality
        if settled and not integral:
            continue
        better = (integral and not settled) or priorities[i] < first or (priorities[i] == first and distance > best)
        if better:
            chosen, best, first, integral = j, distance, priorities[i], settled
    return chosen
