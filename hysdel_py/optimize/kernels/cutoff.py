"""What the value of the incumbent leaves of a box.

The certificate of a relaxation is a constant and one term per variable,

    f(w) >= K + sum_j phi_j(w_j),   phi_j(v) = r_j v + c_j/2 (v - x_j)^2,

with the reduced costs r and any curvature c for which P - diag(c) is positive semidefinite. Where all terms but the
j-th take their least value over the box, a point that costs less than the cut-off has phi_j(w_j) below what is left,
which is an interval of w_j. Without curvature this is the fixing of variables by reduced costs (H. Crowder, E. L.
Johnson, M. Padberg, "Solving large-scale zero-one linear programming problems", Operations Research 31, 1983); with it,
a signal whose square is weighed cannot be far from where the relaxation has it.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.certificate import combine, least_term, tangent
from hysdel_py.optimize.kernels.guessing import queue_rows
from hysdel_py.optimize.kernels.propagation import propagate

__all__ = ["narrow_by_cost"]


@compiled
def narrow_by_cost(data, box, x, y, cutoff, settings):
    """Shrink a box to a part outside of which no point costs less than the cut-off, by the bound and by the rows.

    Parameters
    ----------
    data : tuple
        See :func:`hysdel_py.optimize.kernels.search.run`.
    box : (lb, ub)
        Changed in place.
    x, y : arrays of shape (n,), (m,)
        Any point and multipliers of all rows; those of the relaxation make the part small.
    cutoff : float
    settings : (margin, integrality, progress, huge, rounds)
        Those of the propagation.

    Returns
    -------
    bound, moved, left
        A lower bound over the box as it was; how many bounds of variables moved by the cost; False if nothing is left.
    """
    problem, columns, known, spare = data[its.PROBLEM], data[its.COLUMNS], data[its.KNOWN], data[its.SPARE]
    n, rounding = len(x), known[2]
    reduced, noise, least = np.empty(n), np.empty(n), np.empty(n)
    square, size = tangent(problem, x, reduced, noise)
    most, scale = combine(problem, y, reduced, noise)
    total = known[0] - 0.5 * square - most
    size += scale + abs(known[0])
    for j in range(n):
        least[j] = least_of_term(reduced[j], rounding * noise[j], spare[j], x[j], box[0][j], box[1][j])
        total += least[j]
        size += abs(least[j])
    slack = cutoff - total + 2.0 * rounding * size
    if not np.isfinite(slack):
        return -np.inf, 0, True
    total -= rounding * size
    if total >= cutoff:
        return total, 0, True
    queued = np.zeros(len(problem[3]), dtype=np.bool_)
    moved = 0
    for j in range(n):
        if not (box[0][j] < box[1][j] and np.isfinite(box[0][j]) and np.isfinite(box[1][j])):
            continue
        radius = rounding * noise[j]
        rest = least[j] + slack + radius * greatest_size(box[0][j], box[1][j]) - reduced[j] * x[j]
        rest += rounding * (abs(least[j]) + slack + abs(reduced[j] * x[j]))
        low, high = where_below(reduced[j], spare[j], rest)
        count = move_ends(box, j, x[j] + low, x[j] + high, problem[5][j], settings)
        if count:
            queue_rows(j, columns[0], columns[1], queued)
            moved += count
        if box[0][j] > box[1][j]:
            return total, moved, False
    if moved == 0:
        return total, 0, True
    sides = problem[3], problem[4]
    conflict = propagate(problem[2], columns, problem[5], box, sides, queued, settings)[0]
    return total, moved, conflict < 0


@leaf
def greatest_size(low, high):
    """Greatest absolute value in an interval."""
    return max(abs(low), abs(high))


@leaf
def least_of_term(reduced, radius, curvature, x, low, high):
    """Least value of ``r v + c/2 (v - x)^2`` in an interval, with r known up to a radius."""
    far = greatest_size(low, high)
    if far == np.inf:
        if curvature == 0.0:
            return least_term(reduced, radius, low, high)
        return reduced * x - radius * abs(x) - 0.5 * (abs(reduced) + radius) ** 2 / curvature
    v = low if reduced > 0.0 else high
    if curvature > 0.0:
        v = min(max(x - reduced / curvature, low), high)
    return reduced * v + 0.5 * curvature * (v - x) ** 2 - radius * far


@leaf
def where_below(slope, curvature, level):
    """Ends of the interval of t in which ``slope t + curvature/2 t^2 <= level``; crossed where it is empty."""
    if curvature == 0.0:
        low = level / slope if slope < 0.0 else -np.inf
        high = level / slope if slope > 0.0 else np.inf
        return low, high
    inside = slope * slope + 2.0 * curvature * level
    if inside < 0.0:
        return np.inf, -np.inf
    root = np.sqrt(inside)
    near = 2.0 * level / (abs(slope) + root) if abs(slope) + root > 0.0 else 0.0  # without cancellation
    far = (abs(slope) + root) / curvature
    return (-far, near) if slope >= 0.0 else (-near, far)


@leaf
def move_ends(box, j, low, high, integer, settings):
    """Move the ends of a variable to those given, if that is worth while; returns how many moved."""
    margin, integrality, progress = settings[0], settings[1], settings[2]
    step = margin + progress * (box[1][j] - box[0][j])
    low, high = low - margin * (1.0 + abs(low)), high + margin * (1.0 + abs(high))
    if integer:
        low, high = np.ceil(low - integrality), np.floor(high + integrality)
    moved = 0
    if low > box[0][j] + step:
        box[0][j] = low
        moved += 1
    if high < box[1][j] - step:
        box[1][j] = high
        moved += 1
    return moved
