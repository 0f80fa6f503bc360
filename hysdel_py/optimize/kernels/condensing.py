"""A node of a branch and bound as a small dense program.

Fixed variables are put in. Rows that demand a value define the variable of theirs that comes last, in terms of earlier
ones: in predictive control, whose variables come stage after stage, these are the next state and every auxiliary whose
pair of big-M rows has closed. What is left are independent variables, ``w = Z v + z0``, and the inequalities that the
box does not settle.

Rows with parallel real parts form a group; where all binaries of several rows of a group are fixed, they are one row
with two sides.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels.inequalities import inequalities
from hysdel_py.optimize.kernels.kinds import CONSTANT, DEFINED, FREE
from hysdel_py.optimize.kernels.linear import add_multiple

__all__ = ["condense"]

FIXED = 1e-11
"""A variable whose interval is narrower than this, relative to its size, is fixed in the middle."""
MEET = 1e-9
"""Sides of a group that are closer than this, relative to their size, are one side."""
PIVOT = 1e-3
"""The variable that a row defines has at least this share of its greatest coefficient."""


@compiled
def condense(problem, groups, box, wide):
    """Reduce a node.

    Parameters
    ----------
    problem : (P, q, rows, l, u, integer)
        P and rows as (start, column, value) in compressed rows.
    groups : (start, row, scale, integer)
        Members of each group: the real part of a row is its scale times that of the first of the group. The last entry
        marks the binaries among the variables.
    box : (lb, ub)
        Propagated bounds.
    wide : (lb, ub)
        Bounds that the problem itself has.

    Returns
    -------
    Z, z0 : arrays of shape (n, k), (n,)
    H, f : arrays of shape (k, k), (k,)
    N, b : rows ``N v >= b`` of unit length
    source : array of shape (rows, 2)
        Row of the problem (or m + variable for a bound) and the sign of its side: 1 for the upper one.
    length : array
        What the row of the problem was divided by.
    defining : array
        Group that defines each variable, -1 for none.
    merged
        See :func:`merge_groups`.
    place : array
        Number of each variable among the free ones, -1 for the others.
    """
    P, q, rows, l, u, integer = problem
    n = len(q)
    kind, value = classify(box)
    merged = merge_groups(rows, l, u, groups, integer, box)
    defining = define(rows, groups, merged, kind, n)
    place = none(n)
    k = 0
    for j in range(n):
        if kind[j] == FREE:
            place[j] = k
            k += 1
    places = (kind, value, defining, place)
    Z, z0 = substitute(rows, groups, merged, places, k)
    H, f = project(P, q, Z, z0)
    N, b, source, length = inequalities(problem, groups, merged, places, (Z, z0), (box, wide))
    return Z, z0, H, f, N, b, source, length, defining, merged, place


@compiled
def none(count):
    """As many numbers of nothing."""
    numbers = np.empty(count, dtype=np.int64)
    numbers[:] = -1
    return numbers


@compiled
def classify(box):
    """Which variables are constant, and their values."""
    lb, ub = box
    n = len(lb)
    kind = np.zeros(n, dtype=np.int64)
    value = np.zeros(n)
    for j in range(n):
        width = ub[j] - lb[j]
        if np.isfinite(width) and width <= FIXED * (1.0 + abs(lb[j])):
            kind[j] = CONSTANT
            value[j] = lb[j] if ub[j] <= lb[j] else 0.5 * (lb[j] + ub[j])
    return kind, value


@compiled
def merge_groups(rows, l, u, groups, integer, box):
    """Tightest sides of each group over its rows whose binaries are all fixed.

    Returns arrays of shape (groups,): low, high, the rows that give them (-1 for none), and whether the two meet; and
    for each row whether it went into its group.
    """
    start, member, scale, _ = groups
    count = len(start) - 1
    low, high = np.empty(count), np.empty(count)
    low[:], high[:] = -np.inf, np.inf
    at_low, at_high = none(count), none(count)
    meet = np.zeros(count, dtype=np.bool_)
    inside = np.zeros(len(l), dtype=np.bool_)
    for g in range(count):
        for at in range(start[g], start[g + 1]):
            row, s = member[at], scale[at]
            base, settled = fixed_part(row, rows, integer, box)
            if not settled:
                continue
            inside[row] = True
            first, second = (l[row] - base) / s, (u[row] - base) / s
            if s < 0:
                first, second = second, first
            if first > low[g]:
                low[g], at_low[g] = first, at
            if second < high[g]:
                high[g], at_high[g] = second, at
        if np.isfinite(low[g]) and np.isfinite(high[g]):
            meet[g] = abs(high[g] - low[g]) <= MEET * (1.0 + abs(high[g]))
    return low, high, at_low, at_high, meet, inside


@leaf
def fixed_part(row, rows, integer, box):
    """Sum of the binary terms of a row, and whether all of them are fixed."""
    start, column, value = rows
    total = 0.0
    for at in range(start[row], start[row + 1]):
        j = column[at]
        if integer[j]:
            if box[0][j] < box[1][j]:
                return 0.0, False
            total += value[at] * box[0][j]
    return total, True


@compiled
def define(rows, groups, merged, kind, n):
    """Let each group whose sides meet define its last free variable; marks these in `kind`.

    Returns the group that defines each variable, -1 for none.
    """
    start, column, value = rows
    defining = none(n)
    for g in range(len(merged[4])):
        if not merged[4][g]:
            continue
        row = groups[1][groups[0][g]]
        last, coefficient, greatest = -1, 0.0, 0.0
        for at in range(start[row], start[row + 1]):
            j = column[at]
            if kind[j] != CONSTANT:
                greatest = max(greatest, abs(value[at]))
                if j > last:
                    last, coefficient = j, value[at]
        if last >= 0 and defining[last] < 0 and abs(coefficient) >= PIVOT * greatest:
            defining[last] = g
            kind[last] = DEFINED
    return defining


@compiled
def substitute(rows, groups, merged, places, k):
    """All variables in terms of the free ones, in rising order, so that what a row needs is there already."""
    start, column, value = rows
    kind, constant, defining, place = places
    n = len(kind)
    Z, z0 = np.zeros((n, k)), np.zeros(n)
    for j in range(n):
        if kind[j] == FREE:
            Z[j, place[j]] = 1.0
        elif kind[j] == CONSTANT:
            z0[j] = constant[j]
        else:
            g = defining[j]
            row = groups[1][groups[0][g]]
            own = 0.0
            for at in range(start[row], start[row + 1]):
                i = column[at]
                if i == j:
                    own = value[at]
                elif not groups[3][i]:
                    z0[j] -= value[at] * z0[i]
                    if kind[i] != CONSTANT:
                        add_multiple(Z[j], -value[at], Z[i])
            z0[j] = (z0[j] + 0.5 * (merged[0][g] + merged[1][g])) / own
            for c in range(k):
                Z[j, c] /= own
    return Z, z0


@compiled
def project(P, q, Z, z0):
    """Hessian and gradient in the free variables."""
    start, column, value = P
    n, k = Z.shape
    H, f, t = np.zeros((k, k)), np.zeros(k), np.zeros(k)
    for i in range(n):
        if start[i] == start[i + 1] and q[i] == 0.0:
            continue
        t[:] = 0.0
        slope = q[i]
        for at in range(start[i], start[i + 1]):
            slope += value[at] * z0[column[at]]
            add_multiple(t, value[at], Z[column[at]])
        add_multiple(f, slope, Z[i])
        for a in range(k):
            if Z[i, a] != 0.0:
                add_multiple(H[a], Z[i, a], t)
    return H, f
