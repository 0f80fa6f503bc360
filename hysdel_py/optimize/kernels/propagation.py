"""Interval propagation over rows in compressed form, row after row.

In predictive control the rows come in the order of the stages, so that one pass carries the measured state through the
whole horizon. The rules are those of :mod:`hysdel_py.optimize.propagation`.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.optimize.compiled import compiled

__all__ = ["propagate"]

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
    m = len(rows[0]) - 1
    passes = 0
    again = True
    while again and passes < settings[4]:
        again = False
        passes += 1
        for row in range(m):
            if queued[row]:
                queued[row] = False
                conflict, moved = tighten(row, rows, columns, integer, box, sides, queued, settings)
                if conflict >= 0:
                    return conflict, passes
                again = again or moved
    return -1, passes


@compiled
def tighten(row, rows, columns, integer, box, sides, queued, settings):
    """Bounds that one row implies; marks the rows that touch what moved."""
    start, column, value = rows
    first, last = start[row], start[row + 1]
    low, high, low_endless, high_endless, size = activity(first, last, column, value, box, settings[3])
    margin = settings[0]
    noise = margin + ROUNDOFF * (last - first + 4) * size
    lower, upper = sides[0][row], sides[1][row]
    if np.isfinite(lower):
        lower -= noise + margin * abs(lower)
    if np.isfinite(upper):
        upper += noise + margin * abs(upper)
    if (low_endless == 0 and low > upper) or (high_endless == 0 and high < lower):
        return row, False
    moved = False
    for entry in range(first, last):
        j, a = column[entry], value[entry]
        least, most = box[0][j], box[1][j]
        term_low, term_high = (a * least, a * most) if a > 0 else (a * most, a * least)
        new_low, new_high = -np.inf, np.inf
        if np.isfinite(upper) and low_endless - np.isinf(term_low) == 0:
            left = upper - (low if np.isinf(term_low) else low - term_low)
            if a > 0:
                new_high = left / a
            else:
                new_low = left / a
        if np.isfinite(lower) and high_endless - np.isinf(term_high) == 0:
            left = lower - (high if np.isinf(term_high) else high - term_high)
            if a > 0:
                new_low = max(new_low, left / a)
            else:
                new_high = min(new_high, left / a)
        if update(j, new_low, new_high, integer, box, settings):
            moved = True
            if box[1][j] - box[0][j] < -margin * (1.0 + abs(box[0][j])):
                return m_of(start), True
            for at in range(columns[0][j], columns[0][j + 1]):
                queued[columns[1][at]] = True
            low, high, low_endless, high_endless, size = activity(first, last, column, value, box, settings[3])
    return -1, moved


@compiled
def m_of(start):
    """Number of rows."""
    return len(start) - 1


@compiled
def activity(first, last, column, value, box, huge):
    """Finite parts of the least and greatest value of a row, how many terms are endless, and the size of the terms."""
    low = high = size = 0.0
    low_endless = high_endless = 0
    for entry in range(first, last):
        j, a = column[entry], value[entry]
        term_low, term_high = a * box[0][j], a * box[1][j]
        if a < 0:
            term_low, term_high = term_high, term_low
        if np.isinf(term_low):
            low_endless += 1
        else:
            low += term_low
        if np.isinf(term_high):
            high_endless += 1
        else:
            high += term_high
        size += abs(a) * min(max(abs(box[0][j]), abs(box[1][j])), huge)
    return low, high, low_endless, high_endless, size


@compiled
def update(j, new_low, new_high, integer, box, settings):
    """Take over bounds that are worth it; integers are rounded inwards."""
    margin, integrality, progress, huge = settings[0], settings[1], settings[2], settings[3]
    if integer[j]:
        new_low, new_high = np.ceil(new_low - integrality), np.floor(new_high + integrality)
    width = box[1][j] - box[0][j]
    step = margin + (progress * width if np.isfinite(width) else 0.0)
    moved = False
    if new_high < box[1][j] - step and abs(new_high) < huge:
        box[1][j] = new_high
        moved = True
    if new_low > box[0][j] + step and abs(new_low) < huge:
        box[0][j] = new_low
        moved = True
    return moved
