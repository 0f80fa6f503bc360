"""Contact problems as box-constrained quadratic programs, by active sets.

    minimise 1/2 P'G P + c'P   subject to   lo <= P <= hi,   G positive semidefinite

Its optimality conditions are the friction law: with the slip ``g = G P + c``, g = 0 where P is inside, g >= 0 where it
is at its lower limit, g <= 0 where it is at its upper one. The primal method changes one contact at a time; the
objective falls with every change, so it ends. A free contact that depends on other free ones keeps its value, which
makes singular G harmless; where given speeds contradict each other, so that these cannot all stick, the objective falls
along a line, which they follow until one reaches a limit. Large plants first let all contacts change together: that
mostly settles in a few rounds, where one after the other would take one system for each contact that changes.

Sources: P. B. Stark and R. L. Parker, "Bounded-variable least-squares: an algorithm and applications", Computational
Statistics 10, 1995; M. Hintermueller, K. Ito and K. Kunisch, "The primal-dual active set strategy as a semismooth
Newton method", SIAM Journal on Optimization 13, 2002.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.drivetrain.kernels.delassus import band_step, dense_step, is_dense, magnitudes, slips

__all__ = ["free_step", "solve_box"]

ROUNDING = 1e-13
"""A slip below this share of the terms that it is the sum of is zero."""

CONTRADICTION = 1e-9
"""A free contact whose slip stays above this share of its terms, though it depends on other free ones, cannot stick."""

ROUNDS = 12
"""Rounds in which all contacts change together, before one at a time does."""


@compiled
def solve_box(G, c, lo, hi, P):
    """Solve from the point P, which is overwritten.

    Parameters
    ----------
    G : Delassus

    Returns
    -------
    int
        Number of linear systems that were solved; -1 where the limit of changes was reached.
    """
    n = len(c)
    free = np.zeros(n, dtype=np.bool_)
    for i in range(n):
        P[i] = min(max(P[i], lo[i]), hi[i])
        free[i] = lo[i] < P[i] < hi[i]
    solves = 0
    if not is_dense(G):
        solves, settled = change_together(G, c, lo, hi, P, free)
        if settled:
            return solves
    for _ in range(20 * n + 20):
        while move_free(G, c, lo, hi, P, free):
            solves += 1
        solves += 1
        if resolve_contradiction(G, c, lo, hi, P, free):
            continue
        worst = most_violated(G, c, lo, hi, P, free)
        if worst < 0:
            return solves
        free[worst] = True
    return -1


@compiled
def change_together(G, c, lo, hi, P, free):
    """Rounds of the primal-dual method; number of systems, and whether they found the solution."""
    for done in range(1, ROUNDS + 1):
        P += band_step(G, slips(G, c, P), free)[1]
        released = release(G, c, lo, hi, P, free)
        if not cut_free(lo, hi, P, free) and not released:
            return done, contradicted(G, c, P, free) < 0
    return ROUNDS, False


@compiled
def cut_free(lo, hi, P, free):
    """Put free contacts that have left their limits onto them; whether there were any."""
    changed = False
    for i in range(len(P)):
        if free[i] and not lo[i] <= P[i] <= hi[i]:
            P[i] = lo[i] if P[i] < lo[i] else hi[i]
            free[i] = False
            changed = True
    return changed


@compiled
def release(G, c, lo, hi, P, free):
    """Free all contacts at a limit whose slip has the wrong sign for it; whether there were any."""
    slip, size = slips(G, c, P), magnitudes(G, c, P)
    found = False
    for i in range(len(P)):
        if not free[i] and wrong_sign(slip[i], lo[i], hi[i], P[i]) and abs(slip[i]) > ROUNDING * size[i]:
            free[i] = True
            found = True
    return found


@compiled
def wrong_sign(slip, lo, hi, P):
    """Whether a contact at a limit should let go of it."""
    return lo < hi and ((P <= lo and slip < 0.0) or (P >= hi and slip > 0.0))


@compiled
def most_violated(G, c, lo, hi, P, free):
    """The contact at a limit whose slip has the wrong sign for it, or -1."""
    worst, value = -1, 0.0
    slip, size = slips(G, c, P), np.zeros(0)
    for i in range(len(c)):
        if free[i] or not wrong_sign(slip[i], lo[i], hi[i], P[i]):
            continue
        if len(size) == 0:
            size = magnitudes(G, c, P)
        excess = abs(slip[i]) / np.sqrt(G.diagonal[i])
        if abs(slip[i]) > ROUNDING * size[i] and excess > value:
            value = excess
            worst = i
    return worst


@compiled
def move_free(G, c, lo, hi, P, free):
    """Move the free contacts towards zero slip; true if a limit stopped them, which one of them then keeps."""
    index = np.flatnonzero(free)
    return stopped_by_limit(lo, hi, P, free, index, free_step(G, c, P, index), 1.0)


@compiled
def stopped_by_limit(lo, hi, P, free, index, step, share):
    """Move contacts by at most a share of a step; true if a limit stopped them, which one of them then keeps."""
    stopped = -1
    for a in range(len(index)):
        i = index[a]
        target = P[i] + share * step[a]
        room = share
        if target < lo[i]:
            room = (lo[i] - P[i]) / step[a]
        elif target > hi[i]:
            room = (hi[i] - P[i]) / step[a]
        if room < share:
            share = room
            stopped = i
    for a in range(len(index)):
        i = index[a]
        P[i] = min(max(P[i] + share * step[a], lo[i]), hi[i])
    if stopped < 0:
        return False
    free[stopped] = False
    nearer_low = abs(P[stopped] - lo[stopped]) < abs(P[stopped] - hi[stopped])
    P[stopped] = lo[stopped] if nearer_low else hi[stopped]
    return True


@compiled
def contradicted(G, c, P, free):
    """The free contact whose slip is farthest from zero, as a share of its terms, or -1."""
    worst, value = -1, CONTRADICTION
    slip, size = slips(G, c, P), np.zeros(0)
    for i in range(len(c)):
        if not free[i] or abs(slip[i]) <= value * abs(c[i]):
            continue
        if len(size) == 0:
            size = magnitudes(G, c, P)
        if abs(slip[i]) > value * size[i]:
            value = abs(slip[i]) / size[i]
            worst = i
    return worst


@compiled
def resolve_contradiction(G, c, lo, hi, P, free):
    """Move free contacts that cannot all stick, without a change of any slip, until one is at a limit.

    True if there were any.
    """
    worst = contradicted(G, c, P, free)
    if worst < 0:
        return False
    index, nothing, unit = np.flatnonzero(free), np.zeros(len(P)), np.zeros(len(P))
    unit[worst] = -1.0 if slips(G, c, P)[worst] > 0.0 else 1.0
    step = unit[index] + free_step(G, slips(G, nothing, unit), nothing, index)
    if abs(step[np.searchsorted(index, worst)]) < 0.5:
        return False  # it does not depend on others: its slip is rounding
    far = np.max(hi[index] - lo[index]) / np.max(np.abs(step))
    return stopped_by_limit(lo, hi, P, free, index, step, 2.0 * far)


@compiled
def free_step(G, c, P, index):
    """Step that brings the slips of the contacts in `index` to zero; zero for contacts that depend on others."""
    slip = slips(G, c, P)
    if is_dense(G):
        return dense_step(G.dense, slip, index)
    sticks = np.zeros(len(P), dtype=np.bool_)
    sticks[index] = True
    return band_step(G, slip, sticks)[1][index]
