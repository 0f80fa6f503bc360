"""Interval propagation over rows in compressed form, row after row.

In predictive control the rows come in the order of the stages, so that one pass carries the measured state through the
whole horizon. The rules are those of :mod:`hysdel_py.optimize.propagation`.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf

__all__ = ["noise_of", "propagate"]

ROUNDOFF = 2.0 * float(np.finfo(np.float64).eps)


@compiled
def propagate(rows, columns, integer, box, sides, queued, settings):
    """Shrink a box in place.

    Parameters
    ----------
    rows : (start, column, value)
        The matrix in compressed rows.
    columns : (start, row)
        For each column the rows that have an entry there.
    integer : array of bool, shape (n,)
    box : (lb, ub)
    sides : (l, u)
    queued : array of bool, shape (m,)
        Rows to look at first; false when done.
    settings : (margin, integrality, progress, huge, rounds)

    Returns
    -------
    conflict, rounds
        -1 without a conflict, else the row; m stands for a variable whose bounds have crossed.
    """
    moved = np.zeros(twice_the_longest(rows[0]), dtype=np.int64)
    return sweep(
        rows[0], rows[1], rows[2], columns[0], columns[1], integer, box[0], box[1], sides[0], sides[1], queued, moved,
        settings,
    )  # fmt: skip


@leaf
def sweep(start, column, value, touched, touching, integer, lb, ub, lower, upper, queued, moved, settings):
    """Passes over the queued rows until nothing moves."""
    m = len(lower)
    passes = 0
    again = True
    while again and passes < settings[4]:
        again = False
        passes += 1
        for row in range(m):
            if not queued[row]:
                continue
            queued[row] = False
            first, last = start[row], start[row + 1]
            count = tighten(
                column[first:last], value[first:last], lower[row], upper[row], lb, ub, integer, moved, settings
            )
            if count < 0:
                return row, passes
            for i in range(count):
                j = moved[i]
                if ub[j] - lb[j] < -settings[0] * (1.0 + abs(lb[j])):
                    return m, passes
                for at in range(touched[j], touched[j + 1]):
                    queued[touching[at]] = True
            again = again or count > 0
    return -1, passes


@leaf
def twice_the_longest(start):
    """Twice the greatest number of entries in a row."""
    most = 0
    for row in range(len(start) - 1):
        most = max(most, start[row + 1] - start[row])
    return 2 * most


@leaf
def tighten(column, value, lower, upper, lb, ub, integer, moved, settings):
    """Bounds that one row implies; writes what moved and returns how many, -1 if no point satisfies the row."""
    margin, huge = settings[0], settings[3]
    low = high = size = 0.0
    for at in range(len(column)):
        j, a = column[at], value[at]
        least, most = lb[j], ub[j]
        if a > 0:
            low += a * least
            high += a * most
        else:
            low += a * most
            high += a * least
        size += abs(a) * min(max(abs(least), abs(most)), huge)
    noise = noise_of(size, len(column), margin)
    if lower > -np.inf:
        lower -= noise + margin * abs(lower)
    if upper < np.inf:
        upper += noise + margin * abs(upper)
    if low > upper or high < lower:
        return -1
    count = 0
    if high > upper:
        count = use_side(column, value, 1.0, upper, lb, ub, integer, moved, count, settings)
    if low < lower:
        count = use_side(column, value, -1.0, -lower, lb, ub, integer, moved, count, settings)
    return count


@leaf
def noise_of(size, count, margin):
    """By how much a sum of so many terms of that size together may be wrong, and the margin."""
    return margin + ROUNDOFF * (count + 4) * size


@leaf
def use_side(column, value, sign, side, lb, ub, integer, moved, count, settings):
    """Bounds from ``sign * row <= side``: what the least values of the other terms leave to each.

    Only bounds at which a term is greatest move, so that the least values stay as they are.
    """
    low, endless, which = 0.0, 0, -1
    for at in range(len(column)):
        j, a = column[at], sign * value[at]
        term = a * lb[j] if a > 0 else a * ub[j]
        if term == -np.inf:
            endless, which = endless + 1, at
        else:
            low += term
    if endless > 1:
        return count
    for at in range(len(column)):
        j, a = column[at], sign * value[at]
        least, most = lb[j], ub[j]
        if least == most or (endless == 1 and at != which):
            continue
        if endless == 0 and abs(a) * (most - least) <= side - low:
            continue
        term = 0.0 if endless == 1 else (a * least if a > 0 else a * most)
        bound = (side - (low - term)) / a
        if integer[j]:
            bound = np.floor(bound + settings[1]) if a > 0 else np.ceil(bound - settings[1])
        step = settings[0] + (settings[2] * (most - least) if most - least < np.inf else 0.0)
        if abs(bound) >= settings[3]:
            continue
        if a > 0 and bound < most - step:
            ub[j] = bound
        elif a < 0 and bound > least + step:
            lb[j] = bound
        else:
            continue
        moved[count] = j
        count += 1
    return count
