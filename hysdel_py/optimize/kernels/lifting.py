"""From the multipliers of a condensed node to those of all rows of the problem."""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf

__all__ = ["lift_multipliers"]


@compiled
def lift_multipliers(problem, groups, condensed, gradient, active, weight):
    """Multipliers of all rows from those of the active inequalities.

    Parameters
    ----------
    gradient : array of shape (n,)
        Of the objective at the solution; zero for a ray. Changed in place.
    active, weight : arrays
        Numbers of the inequalities and their multipliers.

    Returns
    -------
    y : array of shape (m,)
        Positive at upper sides. Those of the rows that define a variable make its reduced cost vanish.
    """
    rows, m = problem[2], len(problem[3])
    source, length, defining, merged = condensed
    y = np.zeros(m)
    for i in range(len(active)):
        which, sign = source[active[i], 0], float(source[active[i], 1])
        amount = sign * weight[i] / length[active[i]]
        if which >= m:
            gradient[which - m] += amount
        else:
            y[which] += amount
            spread(which, amount, rows, gradient)
    for j in range(len(defining) - 1, -1, -1):
        g = defining[j]
        if g >= 0:
            first = groups[0][g]
            need = -gradient[j] / entry(groups[1][first], j, rows)  # of the first row of the group
            at = merged[3][g] if need > 0 else merged[2][g]
            row, amount = groups[1][at], need / groups[2][at]
            y[row] += amount
            spread(row, amount, rows, gradient)
    return y


@leaf
def spread(row, amount, rows, gradient):
    """Add a multiple of a row to the gradient."""
    for at in range(rows[0][row], rows[0][row + 1]):
        gradient[rows[1][at]] += amount * rows[2][at]


@leaf
def entry(row, j, rows):
    """Coefficient of a variable in a row."""
    for at in range(rows[0][row], rows[0][row + 1]):
        if rows[1][at] == j:
            return rows[2][at]
    return 0.0
