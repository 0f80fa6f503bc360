"""The inequalities of a condensed node: the sides of rows and the bounds that its box does not settle."""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels.kinds import CONSTANT, DEFINED, FREE
from hysdel_py.optimize.kernels.linear import add_multiple, square

__all__ = ["inequalities"]

EMPTY_ROW = 1e-12
"""A row whose coefficients are together shorter than this says nothing about the free variables."""


@compiled
def inequalities(problem, groups, merged, places, lifted, ranges):
    """Sides of rows and bounds of variables that the box does not settle, as rows ``N v >= b`` of unit length."""
    source = open_sides(problem, groups, merged, places, ranges)
    limit, k = len(source), lifted[0].shape[1]
    N, b, length = np.zeros((limit, k)), np.zeros(limit), np.zeros(limit)
    count = 0
    for i in range(limit):
        which, sign = source[i, 0], float(source[i, 1])
        b[count] = fill(which, sign, problem, places, lifted, ranges, N[count])
        size = np.sqrt(square(N[count], 0))
        if size <= EMPTY_ROW:
            N[count] = 0.0
            continue
        for c in range(k):
            N[count, c] /= size
        b[count] /= size
        length[count] = size
        source[count, 0], source[count, 1] = source[i, 0], source[i, 1]
        count += 1
    return N[:count], b[:count], source[:count], length[:count]


@leaf
def fill(which, sign, problem, places, lifted, ranges, normal):
    """Write one side as ``normal v >= side``; returns the side."""
    (start, column, value), l, u = problem[2], problem[3], problem[4]
    (kind, _, _, place), (Z, z0), (box, wide) = places, lifted, ranges
    if which >= len(l):
        j = which - len(l)
        ends = box if kind[j] == FREE else wide
        add_multiple(normal, -sign, Z[j])
        return sign * (z0[j] - (ends[1][j] if sign > 0 else ends[0][j]))
    total = 0.0
    for at in range(start[which], start[which + 1]):
        j, a = column[at], value[at]
        total += a * z0[j]
        if kind[j] == FREE:
            normal[place[j]] -= sign * a
        elif kind[j] == DEFINED:
            add_multiple(normal, -sign * a, Z[j])
    return sign * (total - (u[which] if sign > 0 else l[which]))


@compiled
def open_sides(problem, groups, merged, places, ranges):
    """The sides that the box does not settle: row (or m + variable) and 1 for an upper side, -1 for a lower one."""
    rows, l, u = problem[2], problem[3], problem[4]
    kind, defining = places[0], places[2]
    box, wide = ranges
    n, m = len(kind), len(l)
    source = np.empty((2 * (m + n), 2), dtype=np.int64)
    count = 0
    for g in range(len(merged[4])):
        if merged[4][g] and owned(g, rows, groups, defining):
            continue
        for side in range(2):  # of the merged row: the upper, then the lower one
            at = merged[3][g] if side == 0 else merged[2][g]
            if at >= 0:
                sign = 1 if (groups[2][at] > 0) == (side == 0) else -1
                count = keep_if_open(groups[1][at], sign, rows, l, u, box, source, count)
    for row in range(m):
        if not merged[5][row]:
            count = keep_if_open(row, 1, rows, l, u, box, source, count)
            count = keep_if_open(row, -1, rows, l, u, box, source, count)
    for j in range(n):
        if kind[j] == CONSTANT:
            continue
        low, high = (box[0][j], box[1][j]) if kind[j] == FREE else (wide[0][j], wide[1][j])
        if kind[j] == DEFINED and implied(j, defining[j], rows, groups, merged, box, low, high):
            continue
        if high < np.inf:
            source[count, 0], source[count, 1] = m + j, 1
            count += 1
        if low > -np.inf:
            source[count, 0], source[count, 1] = m + j, -1
            count += 1
    return source[:count].copy()


@leaf
def keep_if_open(row, sign, rows, l, u, box, source, count):
    """Note one side of a row, unless it is missing or holds everywhere in the box."""
    side = u[row] if sign > 0 else -l[row]
    if side == np.inf:
        return count
    reach = 0.0
    for at in range(rows[0][row], rows[0][row + 1]):
        j, a = rows[1][at], sign * rows[2][at]
        reach += a * (box[1][j] if a > 0 else box[0][j])
    if reach <= side:
        return count
    source[count, 0], source[count, 1] = row, sign
    return count + 1


@leaf
def owned(g, rows, groups, defining):
    """Whether a group defines a variable."""
    row = groups[1][groups[0][g]]
    for at in range(rows[0][row], rows[0][row + 1]):
        if defining[rows[1][at]] == g:
            return True
    return False


@leaf
def implied(j, g, rows, groups, merged, box, low, high):
    """Whether the definition keeps a variable within its bounds for every point of the box."""
    start, column, value = rows
    row = groups[1][groups[0][g]]
    least = most = 0.5 * (merged[0][g] + merged[1][g])
    own = 1.0
    for at in range(start[row], start[row + 1]):
        i, a = column[at], value[at]
        if i == j:
            own = a
        elif not groups[3][i]:
            least -= max(a * box[0][i], a * box[1][i])
            most -= min(a * box[0][i], a * box[1][i])
    first, second = least / own, most / own
    if own < 0:
        first, second = second, first
    return first >= low and second <= high
