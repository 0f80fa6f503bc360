"""Contact problems as box-constrained quadratic programs, by a primal active-set method.

    minimise 1/2 P'G P + c'P   subject to   lo <= P <= hi,   G positive semidefinite

Its optimality conditions are the friction law: with the slip ``g = G P + c``, g = 0 where P is inside, g >= 0 where it
is at its lower limit, g <= 0 where it is at its upper one. The objective falls with every change of the active set, so
the method ends; a free contact that depends on other free ones keeps its value, which makes singular G harmless.

Source: P. B. Stark and R. L. Parker, "Bounded-variable least-squares: an algorithm and applications", Computational
Statistics 10, 1995.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.optimize.compiled import compiled

__all__ = ["solve_box"]

DEPENDENT = 1e-12
"""A pivot below this share of its diagonal entry is zero."""

ROUNDING = 1e-13
"""A slip below this share of the terms that it is the sum of is zero."""


@compiled
def solve_box(G, c, lo, hi, P):
    """Solve from the point P, which is overwritten.

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
    for _ in range(20 * n + 20):
        while move_free(G, c, lo, hi, P, free):
            solves += 1
        solves += 1
        worst = most_violated(G, c, lo, hi, P, free)
        if worst < 0:
            return solves
        free[worst] = True
    return -1


@compiled
def most_violated(G, c, lo, hi, P, free):
    """The contact at a limit whose slip has the wrong sign for it, or -1."""
    n = len(c)
    worst = -1
    value = 0.0
    for i in range(n):
        if free[i] or lo[i] >= hi[i]:
            continue
        slip = c[i]
        size = abs(c[i])
        for j in range(n):
            slip += G[i, j] * P[j]
            size += abs(G[i, j] * P[j])
        if (P[i] <= lo[i] and slip < 0.0) or (P[i] >= hi[i] and slip > 0.0):
            excess = abs(slip) / np.sqrt(G[i, i])
            if abs(slip) > ROUNDING * size and excess > value:
                value = excess
                worst = i
    return worst


@compiled
def move_free(G, c, lo, hi, P, free):
    """Move the free contacts towards zero slip; true if a limit stopped them, which one of them then keeps."""
    index = np.flatnonzero(free)
    step = free_step(G, c, P, index)
    share = 1.0
    stopped = -1
    for a in range(len(index)):
        i = index[a]
        target = P[i] + step[a]
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
def free_step(G, c, P, index):
    """Step that brings the slips of the free contacts to zero, by Cholesky; zero for contacts that depend on others."""
    m, n = len(index), len(c)
    L = np.zeros((m, m))
    y = np.zeros(m)
    for a in range(m):
        i = index[a]
        total = -c[i]
        for j in range(n):
            total -= G[i, j] * P[j]
        for b in range(a):
            entry = G[i, index[b]]
            for k in range(b):
                entry -= L[a, k] * L[b, k]
            L[a, b] = entry / L[b, b] if L[b, b] > 0.0 else 0.0
            total -= L[a, b] * y[b]
        pivot = G[i, i]
        for k in range(a):
            pivot -= L[a, k] * L[a, k]
        if pivot > DEPENDENT * G[i, i]:
            L[a, a] = np.sqrt(pivot)
            y[a] = total / L[a, a]
    for a in range(m - 1, -1, -1):
        if L[a, a] > 0.0:
            total = y[a]
            for b in range(a + 1, m):
                total -= L[b, a] * y[b]
            y[a] = total / L[a, a]
        else:
            y[a] = 0.0
    return y
