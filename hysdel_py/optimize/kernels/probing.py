"""Both values of each binary, tried by propagation: what they say of the bounds of all variables and of the rows.

Each binary d that is open is fixed at 0 and at 1. A contradiction at one value fixes d at the other; what neither value
leaves to a variable it cannot have. And a row ``a'x + c d <= u``, whose other terms are at most U0 beside d = 0 and at
most U1 beside d = 1, may become

    a'x + (V0 - V1) d <= V0,   V0 = min(u, U0),   V1 = min(u - c, U1),

which says the same where d is 0 or 1 and more in between: the big-M constants of a stage become those of the values
that are possible there.

Source: M. W. P. Savelsbergh, "Preprocessing and probing techniques for mixed integer programming problems", ORSA
Journal on Computing 6, 1994.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.guessing import queue_rows
from hysdel_py.optimize.kernels.linear import copy_to
from hysdel_py.optimize.kernels.propagation import noise_of, propagate

__all__ = ["probe"]

GAIN = 1e-6
"""A row is only changed where this much is gained, relative to its side and at least absolute."""


@compiled
def probe(data, box, settings):
    """Try both values of each open binary of a box; shrinks the box and changes coefficients and sides of rows.

    The rows are changed for good: they hold in the box, and only there.

    Parameters
    ----------
    data : tuple
        See :func:`hysdel_py.optimize.kernels.search.run`; values and sides of its rows change in place.
    box : (lb, ub)
        Propagated; changed in place.
    settings : (margin, integrality, progress, huge, rounds)
        Those of the propagation.

    Returns
    -------
    left, changes
        False if nothing is left of the box; how many bounds and rows changed.
    """
    problem, columns, binaries = data[its.PROBLEM], data[its.COLUMNS], data[its.BINARIES]
    changes = 0
    low, high = (box[0].copy(), box[1].copy()), (box[0].copy(), box[1].copy())
    for i in range(len(binaries)):
        j = binaries[i]
        if box[0][j] >= box[1][j]:
            continue
        at_zero = try_value(problem, columns, box, j, 0.0, low, settings)
        at_one = try_value(problem, columns, box, j, 1.0, high, settings)
        if not (at_zero or at_one):
            return False, changes
        if at_zero and at_one:
            changes += lift_rows(problem, columns, j, low, high, settings)
            changes += take_hull(box, low, high, settings)
        else:
            only = low if at_zero else high
            copy_to(box[0], only[0])
            copy_to(box[1], only[1])
            changes += 1
    return True, changes


@compiled
def try_value(problem, columns, box, j, value, inside, settings):
    """Write into `inside` what propagation leaves of a box beside a value of a binary; False if that is nothing."""
    copy_to(inside[0], box[0])
    copy_to(inside[1], box[1])
    inside[0][j] = inside[1][j] = value
    queued = np.zeros(len(problem[3]), dtype=np.bool_)
    queue_rows(j, columns[0], columns[1], queued)
    return propagate(problem[2], columns, problem[5], inside, (problem[3], problem[4]), queued, settings)[0] < 0


@leaf
def take_hull(box, low, high, settings):
    """Shrink a box to the hull of two others within it; returns how many bounds moved by more than a little."""
    moved = 0
    for j in range(len(box[0])):
        least, most = min(low[0][j], high[0][j]), max(low[1][j], high[1][j])
        step = settings[0] + (settings[2] * (box[1][j] - box[0][j]) if box[1][j] - box[0][j] < np.inf else 0.0)
        moved += (1 if least > box[0][j] + step else 0) + (1 if most < box[1][j] - step else 0)
        box[0][j], box[1][j] = max(box[0][j], least), min(box[1][j], most)
    return moved


@leaf
def lift_rows(problem, columns, j, low, high, settings):
    """Change the rows of one side that a binary is in; returns how many."""
    (start, column, value), l, u = problem[2], problem[3], problem[4]
    changed = 0
    for at in range(columns[0][j], columns[0][j + 1]):
        row = columns[1][at]
        if (l[row] == -np.inf) == (u[row] == np.inf):
            continue
        sign = 1.0 if u[row] < np.inf else -1.0
        side = u[row] if sign > 0.0 else -l[row]
        where = place_in(row, j, start, column)
        first = greatest_rest(row, where, sign, problem[2], low, settings)
        second = greatest_rest(row, where, sign, problem[2], high, settings)
        own = sign * value[where]
        least = GAIN * (1.0 + abs(side))
        if not (first < side - least or second < side - own - least):
            continue
        first, second = min(first, side), min(second, side - own)
        value[where] = sign * (first - second)
        if sign > 0.0:
            u[row] = first
        else:
            l[row] = -first
        changed += 1
    return changed


@leaf
def place_in(row, j, start, column):
    """Place of a variable among the entries of a row."""
    for at in range(start[row], start[row + 1]):
        if column[at] == j:
            return at
    return -1


@leaf
def greatest_rest(row, where, sign, rows, box, settings):
    """Greatest value in a box of ``sign * row`` without one of its entries, with the possible rounding."""
    start, column, value = rows
    total = size = 0.0
    for at in range(start[row], start[row + 1]):
        if at == where:
            continue
        j, a = column[at], sign * value[at]
        total += a * (box[1][j] if a > 0.0 else box[0][j]) if a != 0.0 else 0.0
        size += abs(a) * min(max(abs(box[0][j]), abs(box[1][j])), settings[3])
    return total + noise_of(size, start[row + 1] - start[row], settings[0]) + settings[0] * abs(total)
