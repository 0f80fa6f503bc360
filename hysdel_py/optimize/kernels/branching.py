"""At which binary a node is split: the earliest one whose splitting pays, as far as the search has seen.

A pseudo-cost is the mean growth of the certified bound for each unit by which a binary was rounded, one for each of its
values. Binaries that matter in one time step matter in the next one a stage earlier, so that a controller hands its
pseudo-costs on. They only choose where to split; no bound depends on them.

Source: T. Achterberg, T. Koch and A. Martin, "Branching rules revisited", Operations Research Letters 33, 2005; the
preference for early stages is ours.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import leaf

__all__ = ["branching_variable", "learn"]

LEAST_SHARE = 1e-3
"""A binary counts as rounded by at least this much."""
WORTHWHILE = 0.1
"""A binary is passed over if its score is below this share of the best score."""
NEGLIGIBLE = 1e-6
"""Growth below this share of what is wanted counts as this much, so that one useless half does not hide the other."""


@leaf
def learn(costs, variable, value, relaxed, growth):
    """Note by how much the bound grew when a binary was fixed.

    Parameters
    ----------
    costs : array of shape (n, 4)
        For each variable the sum of growths and their number at 0, then at 1.
    variable : int
    value, relaxed : float
        What it was fixed at, and its value in the relaxation before; nothing is learnt where they are the same.
    growth : float
        Of the bound; not a number where it is not known.
    """
    if not growth >= 0.0 or value == relaxed:
        return
    at = 2 if value > 0.5 else 0
    costs[variable, at] += growth / max(abs(value - relaxed), LEAST_SHARE)
    costs[variable, at + 1] += 1.0


@leaf
def branching_variable(lb, ub, w, binaries, priorities, integrality, costs, wanted):
    """The binary of the lowest priority among those whose score is near the best; -1 if none has a choice.

    Binaries that the relaxation has at 0 or 1 are considered only if there is no other.

    Parameters
    ----------
    lb, ub, w : arrays of shape (n,)
        Bounds of the node and its relaxed point.
    binaries, priorities : arrays
    integrality : float
        Distance from 0 and 1 up to which a binary counts as settled.
    costs : array of shape (n, 4)
        See :func:`learn`.
    wanted : float
        Growth with which the node could be dropped; more does not count.
    """
    usual = usual_growth(binaries, costs)
    integral, best = True, -1.0
    for i in range(len(binaries)):
        j = binaries[i]
        settled = is_settled(w[j], integrality)
        if lb[j] >= ub[j] or (settled and not integral):
            continue
        if integral and not settled:
            integral, best = False, -1.0
        best = max(best, score(j, w[j], costs, usual, wanted))
    chosen, first, most = -1, np.inf, -1.0
    for i in range(len(binaries)):
        j = binaries[i]
        if lb[j] >= ub[j] or priorities[i] > first or (not integral and is_settled(w[j], integrality)):
            continue
        own = score(j, w[j], costs, usual, wanted)
        if own >= WORTHWHILE * best and (priorities[i] < first or own > most):
            chosen, first, most = j, priorities[i], own
    return chosen


@leaf
def is_settled(value, integrality):
    """Whether a relaxed binary is at 0 or 1."""
    return min(abs(value), abs(1.0 - value)) <= integrality


@leaf
def usual_growth(binaries, costs):
    """Mean pseudo-cost of all binaries, 1 before anything was seen."""
    total = count = 0.0
    for i in range(len(binaries)):
        total += costs[binaries[i], 0] + costs[binaries[i], 2]
        count += costs[binaries[i], 1] + costs[binaries[i], 3]
    return total / count if count > 0.0 else 1.0


@leaf
def score(variable, relaxed, costs, usual, wanted):
    """Product of the growths that are expected in the two halves."""
    product = 1.0
    for value in range(2):
        count = costs[variable, 2 * value + 1]
        rate = costs[variable, 2 * value] / count if count > 0.0 else usual
        growth = rate * max(abs(value - relaxed), LEAST_SHARE)
        if wanted < np.inf:
            growth = max(min(growth, wanted), NEGLIGIBLE * wanted)
        product *= growth
    return product
