"""The open nodes of a search in arrays, and which of them is looked at next.

A tree is the tuple (lb, ub, bound, split, depth, active, used, order, near, ways): per slot the box of the parent, its
certified bound, the binary that is fixed, its value and the number of the parent, the depth, the active inequalities of
the parent's relaxation as numbers ``2 * row + side``, of which `used` count, its solution, and the decisions on the way
here as numbers ``2 * variable + value``, of which `depth` count. The first slots in
`order` are the open ones in the order in which they were opened, the rest are free.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.linear import copy_to

__all__ = [
    "ACTIVE",
    "DEPTH",
    "DIVE",
    "FATE",
    "HOW_MANY",
    "LAST",
    "NARROWED",
    "NODES",
    "OPEN",
    "PENDING",
    "PLANTED",
    "PROBING",
    "SOLVES",
    "WAY",
    "WORDS",
    "least_open",
    "push",
    "push_again",
    "take_next",
    "wished",
]

OPEN, NODES, SOLVES, DIVE, DEPTH, WORDS, ACTIVE, PENDING, LAST, FATE = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
WAY, PLANTED = 10, 13
"""Counters: open nodes, nodes visited, programs solved, whether the last node was split, its depth, words tried,
active inequalities at the root, words to be tried, slot of the node at hand, what became of it, its entries
of `split`, and whether an earlier tree has been taken over."""
NARROWED, PROBING = 14, 15
"""How often a box was narrowed by the cost, and the number of nodes after which the whole problem is probed."""
HOW_MANY = 16
"""Their number."""


@leaf
def take_next(bound, order, counters):
    """Slot of the next node, which becomes free: the child opened last, or the least bound once a dive has ended."""
    last = counters[OPEN] - 1
    chosen = last
    if counters[DIVE] == 0:
        for at in range(last - 1, -1, -1):
            if bound[order[at]] < bound[order[chosen]]:
                chosen = at
    slot = order[chosen]
    for at in range(chosen, last):
        order[at] = order[at + 1]
    order[last] = slot
    counters[OPEN] = last
    return slot


@leaf
def least_open(bound, order, counters):
    """Least bound of the open nodes, infinite if there are none."""
    least = np.inf
    for at in range(counters[OPEN]):
        least = min(least, bound[order[at]])
    return least


@leaf
def push(tree, counters, box, bound, variable, value, active, near, way):
    """Open a node below the one that was visited last, whose decisions are `way`; there has to be a free slot."""
    slot = tree[its.ORDER][counters[OPEN]]
    counters[OPEN] += 1
    copy_to(tree[its.LOWER][slot], box[0])
    copy_to(tree[its.UPPER][slot], box[1])
    tree[its.BOUNDS][slot] = bound
    tree[its.SPLITS][slot, 0], tree[its.SPLITS][slot, 1], tree[its.SPLITS][slot, 2] = variable, value, counters[NODES]
    depth = counters[DEPTH]
    tree[its.DEPTHS][slot] = depth + 1
    copy_to(tree[its.WAYS][slot], way)
    if variable >= 0 and depth >= 0:
        tree[its.WAYS][slot, depth] = 2 * variable + (1 if value > 0.5 else 0)
    count = min(len(active), tree[its.ACTIVES].shape[1])
    for i in range(count):
        tree[its.ACTIVES][slot, i] = 2 * active[i, 0] + (1 if active[i, 1] > 0 else 0)
    tree[its.USED][slot] = count
    copy_to(tree[its.NEAR][slot], near)


@leaf
def push_again(tree, counters, box, bound, variable, value, active, near, way):
    """Open the node at hand once more, with a smaller box that leaves no choice; no decision is added to its way."""
    counters[DEPTH] -= 1
    push(tree, counters, box, bound, variable, value, active, near, way)
    counters[DEPTH] += 1
    copy_to(tree[its.WAYS][tree[its.ORDER][counters[OPEN] - 1]], way)


@compiled
def wished(tree, slot):
    """What a node begins with: active inequalities, row (or m + variable) and sign of the side, and a point."""
    guess = np.empty((tree[its.USED][slot], 2), dtype=np.int64)
    for i in range(len(guess)):
        code = tree[its.ACTIVES][slot, i]
        guess[i, 0], guess[i, 1] = code // 2, (1 if code % 2 else -1)
    return guess, tree[its.NEAR][slot]
