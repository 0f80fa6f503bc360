"""The bounds of :mod:`hysdel_py.optimize.certificate` in scalar code, over the rows and bounds of the whole problem.

They hold for any point and any multipliers, so that nothing that came before, condensing and active sets, has to be
believed. The allowance for rounding is that of the vectorised form.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf

__all__ = ["bound_below", "combine", "excess", "farkas_bound", "least_term", "tangent"]


@compiled
def bound_below(problem, box, x, y, known):
    """Lower bound of the objective over the box for any x and y; minus infinity where there is none.

    Parameters
    ----------
    problem : (P, q, rows, l, u, integer)
    box : (lb, ub)
    x, y : arrays of shape (n,), (m,)
    known : (constant, curvature, rounding)
        `curvature` is c >= 0 with P - diag(c) positive semidefinite; `rounding` the relative error of a dot product
        and of the sums over it.
    """
    constant, curvature, rounding = known
    n = len(problem[1])
    reduced, noise = np.empty(n), np.empty(n)
    square, size = tangent(problem, x, reduced, noise)
    size += abs(constant)
    most, scale = combine(problem, y, reduced, noise)
    total = constant - 0.5 * square - most
    for i in range(n):
        c = curvature[i]
        if c > 0.0:
            step = (abs(reduced[i]) + rounding * noise[i]) / c
            total += reduced[i] * x[i] - rounding * noise[i] * abs(x[i]) - 0.5 * c * step * step
        else:
            total += least_term(reduced[i], rounding * noise[i], box[0][i], box[1][i])
    total -= rounding * (size + scale)
    return total if not np.isnan(total) else -np.inf


@leaf
def tangent(problem, x, reduced, noise):
    """Write ``P x + q`` and the sum of its absolute terms; returns ``x'P x`` and the size of half of it."""
    (start, column, value), q = problem[0], problem[1]
    square = size = 0.0
    for i in range(len(q)):
        Px = Pabs = 0.0
        for at in range(start[i], start[i + 1]):
            term = value[at] * x[column[at]]
            Px += term
            Pabs += abs(term)
        square += x[i] * Px
        size += 0.5 * abs(x[i]) * Pabs
        reduced[i], noise[i] = Px + q[i], Pabs + abs(q[i])
    return square, size


@compiled
def farkas_bound(problem, box, y, rounding):
    """Least value of the combined rows over the box; positive proves that the rows have no point there."""
    n = len(problem[1])
    reduced, noise = np.zeros(n), np.zeros(n)
    most, scale = combine(problem, y, reduced, noise)
    total = -most
    for i in range(n):
        total += least_term(reduced[i], rounding * noise[i], box[0][i], box[1][i])
    total -= rounding * scale
    return total if not np.isnan(total) else -np.inf


@leaf
def combine(problem, y, reduced, noise):
    """Add A'y to `reduced` and its absolute terms to `noise`; greatest value of y's over the sides, and its size.

    A multiplier that points at an infinite side counts as zero.
    """
    (start, column, value), l, u = problem[2], problem[3], problem[4]
    most = scale = 0.0
    for row in range(len(l)):
        side = u[row] if y[row] > 0.0 else l[row]
        if y[row] == 0.0 or abs(side) == np.inf:
            continue
        most += y[row] * side
        scale += abs(y[row] * side)
        for at in range(start[row], start[row + 1]):
            term = value[at] * y[row]
            reduced[column[at]] += term
            noise[column[at]] += abs(term)
    return most, scale


@leaf
def least_term(coefficient, radius, low, high):
    """Least product of a coefficient, known up to a radius, and a variable in its bounds; zero times infinity is 0."""
    first, last = coefficient - radius, coefficient + radius
    least = np.inf
    for factor in (first, last):
        for end in (low, high):
            least = min(least, factor * end if factor != 0.0 else 0.0)
    return least


@leaf
def excess(problem, box, x):
    """Largest violation of a row or bound at x, each relative to the size of its nearer side."""
    (start, column, value), l, u = problem[2], problem[3], problem[4]
    worst = 0.0
    for row in range(len(l)):
        total = 0.0
        for at in range(start[row], start[row + 1]):
            total += value[at] * x[column[at]]
        worst = max(worst, beyond(total, l[row], u[row]))
    for j in range(len(x)):
        worst = max(worst, beyond(x[j], box[0][j], box[1][j]))
    return worst


@leaf
def beyond(value, low, high):
    """How far a value is outside its sides."""
    if low <= value <= high:
        return 0.0
    if np.isnan(value):
        return np.inf
    size = min(abs(low), abs(high))
    if size == np.inf:
        size = 0.0
    return max(low - value, value - high) / (1.0 + size)
