"""The relaxation of one node, with a verdict that does not depend on how it was found."""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.certificate import bound_below, farkas_bound
from hysdel_py.optimize.kernels.node import BEATEN, EMPTY, SOLVED, solve_node, value_at
from hysdel_py.optimize.kernels.tree import SOLVES

__all__ = ["BOUND", "FLOOR", "OBJECTIVE", "judge", "worthwhile"]

OBJECTIVE, FLOOR, BOUND = 0, 1, 2
"""Numbers: value of the incumbent, least bound of the parts that are done, bound of the node at hand."""


@compiled
def judge(data, box, guess, state, settings):
    """Solve a node and certify the answer: (status, point, multipliers, bound, active).

    A status that is not certified is -1.
    """
    problem, groups, _, wide, _, _, _, known, _ = data
    numbers, counters = state[its.NUMBERS], state[its.COUNTERS]
    cutoff = (worthwhile(numbers, settings[its.GAPS]), known[0], known[1], known[2])
    counters[SOLVES] += 1
    status, _, w, y, active = solve_node(problem, groups, box, wide, guess, cutoff, settings[its.SOLVER])
    if status == EMPTY:
        certain = farkas_bound(problem, box, y, known[2]) > 0.0
        return (EMPTY if certain else -1), w, y, -np.inf, active
    bound = bound_below(problem, box, w, y, known)
    if status == SOLVED:
        value = value_at(problem, w) + known[0]
        if not value - bound <= max(settings[its.GAPS][0], settings[its.GAPS][1] * abs(value)):
            status = -1
    return (status if status in (SOLVED, BEATEN) else -1), w, y, bound, active


@leaf
def worthwhile(numbers, gaps):
    """Bound from which a part cannot be better than the incumbent by more than the gap."""
    objective = numbers[OBJECTIVE]
    if objective == np.inf:
        return np.inf
    return objective - max(gaps[0], gaps[1] * abs(objective))
