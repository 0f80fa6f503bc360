"""From a relaxed point to a word of binaries: the real drivers are held at its values, and the rows decide the rest.

The drivers are held all at once, and one after the other where the rows object to that. Propagation after each decision
is a simulation of the system, as far as drivers settle it. A binary that stays open is rounded, and turned over once
where the rows object.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels.linear import copy_to
from hysdel_py.optimize.kernels.propagation import sweep, twice_the_longest

__all__ = ["fix_word", "follow", "narrow"]


@leaf
def narrow(variable, value, rows, columns, integer, box, sides, queued, moved, settings):
    """Fix one variable and propagate; the conflict, -1 without one."""
    box[0][variable] = box[1][variable] = value
    queue_rows(variable, columns[0], columns[1], queued)
    return sweep(
        rows[0], rows[1], rows[2], columns[0], columns[1], integer, box[0], box[1], sides[0], sides[1], queued, moved,
        settings,
    )[0]  # fmt: skip


@leaf
def queue_rows(variable, touched, touching, queued):
    """Mark the rows that a variable is in."""
    for at in range(touched[variable], touched[variable + 1]):
        queued[touching[at]] = True


@compiled
def follow(problem, columns, box, x, decisions, drive, settings):
    """Settle all binaries within the box, which changes; says whether the rows agreed.

    Parameters
    ----------
    x : array of shape (n,)
    decisions : (variable, real)
        Drivers and binaries in the order of time, and which are real drivers.
    drive : bool
        Whether the drivers are held at x.
    """
    rows, l, u, integer = problem[2], problem[3], problem[4], problem[5]
    queued, moved = np.zeros(len(l), dtype=np.bool_), np.zeros(twice_the_longest(rows[0]), dtype=np.int64)
    variables, real = decisions
    if drive:
        hold_drivers(problem, columns, box, x, decisions, queued, moved, settings)
    for i in range(len(variables)):
        j = variables[i]
        if box[0][j] >= box[1][j] or (real[i] and not drive):
            continue
        if real[i]:
            value = min(max(x[j], box[0][j]), box[1][j])
            if narrow(j, value, rows, columns, integer, box, (l, u), queued, moved, settings) >= 0:
                return False
            continue
        before = box[0].copy(), box[1].copy()
        value = 1.0 if x[j] > 0.5 else 0.0
        if narrow(j, value, rows, columns, integer, box, (l, u), queued, moved, settings) >= 0:
            copy_to(box[0], before[0])
            copy_to(box[1], before[1])
            queued[:] = False
            if narrow(j, 1.0 - value, rows, columns, integer, box, (l, u), queued, moved, settings) >= 0:
                return False
    return True


@compiled
def hold_drivers(problem, columns, box, x, decisions, queued, moved, settings):
    """Hold all real drivers at x at once, which costs one propagation; the box stays as it was if the rows object."""
    before = box[0].copy(), box[1].copy()
    variables, real = decisions
    for i in range(len(variables)):
        j = variables[i]
        if real[i] and box[0][j] < box[1][j]:
            box[0][j] = box[1][j] = min(max(x[j], box[0][j]), box[1][j])
            queue_rows(j, columns[0], columns[1], queued)
    rows = problem[2]
    conflict = sweep(
        rows[0], rows[1], rows[2], columns[0], columns[1], problem[5], box[0], box[1], problem[3], problem[4], queued,
        moved, settings,
    )[0]  # fmt: skip
    if conflict >= 0:
        copy_to(box[0], before[0])
        copy_to(box[1], before[1])
        queued[:] = False


@compiled
def fix_word(problem, columns, box, binaries, word, settings):
    """Fix all binaries of a box, which changes, and propagate; says whether the rows agreed."""
    rows, integer = problem[2], problem[5]
    queued = np.zeros(len(problem[3]), dtype=np.bool_)
    moved = np.zeros(twice_the_longest(rows[0]), dtype=np.int64)
    lb, ub = box
    for i in range(len(binaries)):
        j = binaries[i]
        if word[i] < lb[j] or word[i] > ub[j]:
            return False
        if lb[j] < ub[j]:
            queue_rows(j, columns[0], columns[1], queued)
            lb[j] = ub[j] = word[i]
    return sweep(
        rows[0], rows[1], rows[2], columns[0], columns[1], integer, lb, ub, problem[3], problem[4], queued, moved,
        settings,
    )[0] < 0  # fmt: skip
