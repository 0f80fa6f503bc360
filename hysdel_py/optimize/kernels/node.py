"""One node of a branch and bound from bounds to multipliers, without leaving compiled code."""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import active_set
from hysdel_py.optimize.kernels.certificate import bound_below
from hysdel_py.optimize.kernels.condensing import condense
from hysdel_py.optimize.kernels.lifting import lift_multipliers
from hysdel_py.optimize.kernels.linear import copy_to, dot

__all__ = ["solve_node"]

inverse_factor, nonzeros, work_space = active_set.inverse_factor, active_set.nonzeros, active_set.work_space
solve, start_from = active_set.solve, active_set.start_from
SOLVED, EMPTY, BEATEN, LIMIT = active_set.SOLVED, active_set.EMPTY, active_set.BEATEN, active_set.LIMIT
TOO_LARGE = 4
"""Status of a node with more free variables than wanted."""
ASTRAY = 1e-6
"""The proximal steps have not settled while their pull exceeds this, relative to the typical curvature."""
LEAST_SCALE = 1e-6
"""The typical curvature counts as at least this."""
FLAT = 1e-6
"""A variable with less curvature than this, relative to the greatest, has none."""


@compiled
def solve_node(problem, groups, box, wide, guess, cutoff, settings):
    """Condense and solve.

    Parameters
    ----------
    problem, groups, box, wide
        See :func:`hysdel_py.optimize.kernels.condensing.condense`.
    guess : (active, near)
        Active inequalities of a similar node, row (or m + variable) and sign of the side, an array of shape (rows, 2);
        and its solution, an array of length n, or of length 0 if there is none.
    cutoff : (value, constant, curvature, rounding)
        The solution may stop once a bound reaches `value`, which :func:`bound_below` has to confirm with the rest;
        infinite for a solution.
    settings : (tolerance, iterations, proximity, rounds, largest)
        `proximity` is the weight of the proximal term relative to the typical diagonal entry of the Hessian, both with
        variables measured by the widths of their bounds in the problem.

    Returns
    -------
    status, iterations, w, y, active
        `y` are multipliers of all rows, or a ray of Farkas for an empty node; `active` has the form that it has in
        `guess`.
    """
    condensed = condense(problem, groups, box, wide)
    Z, z0, H, f, N, b, source = condensed[:7]
    k = len(f)
    m = len(problem[3])
    if k > settings[4]:
        return TOO_LARGE, 0, z0, np.zeros(m), np.zeros((0, 2), dtype=np.int64)
    unit = units(condensed[10], wide, k)
    scale = typical_curvature(H, unit)
    rho = np.empty(k)
    for i in range(k):
        rho[i] = settings[2] * scale / (unit[i] * unit[i])
        H[i, i] += rho[i]
    J, sound = inverse_factor(H)
    if not sound:
        return LIMIT, 0, z0, np.zeros(m), np.zeros((0, 2), dtype=np.int64)
    work = work_space(J)
    start_from(places_of(guess[0], source, m, len(Z)), N, work)
    rows = nonzeros(N)
    centre = centre_in(condensed[10], box, guess[1], k)
    iterations = 0
    if cutoff[0] < np.inf:
        pull = products(rho, centre)
        target = cutoff[0] - value_at(problem, z0) - cutoff[1] - 0.5 * dot(pull, centre)
        status, iterations, row = solve(rows, b, difference(f, pull), work, target, settings[:2])
        if status == BEATEN:
            w, y = lifted(problem, groups, condensed, work, status, row)
            if bound_below(problem, box, w, y, cutoff[1:]) >= cutoff[0]:
                return BEATEN, iterations, w, y, active_rows(source, work)
    status, count, row = approach(rows, b, f, work, centre, (rho, unit), settings)
    w, y = lifted(problem, groups, condensed, work, status, row)
    return status, iterations + count, w, y, active_rows(source, work)


@compiled
def products(a, b):
    """Entries of two vectors multiplied."""
    result = np.empty(len(a))
    for i in range(len(a)):
        result[i] = a[i] * b[i]
    return result


@compiled
def difference(a, b):
    """One vector less another one."""
    result = np.empty(len(a))
    for i in range(len(a)):
        result[i] = a[i] - b[i]
    return result


@compiled
def active_rows(source, work):
    """The active inequalities in the numbers of the problem."""
    active = np.empty((work[4][0], 2), dtype=np.int64)
    for i in range(len(active)):
        active[i, 0], active[i, 1] = source[work[2][i], 0], source[work[2][i], 1]
    return active


@compiled
def units(place, wide, k):
    """Units in which the free variables are measured: the widths of their bounds in the problem, 1 without any.

    A flow of some litres per second beside a level in metres would otherwise get a proximal term of the wrong size.
    """
    unit = np.empty(k)
    unit[:] = 1.0
    for j in range(len(place)):
        if place[j] >= 0:
            width = wide[1][j] - wide[0][j]
            unit[place[j]] = width if 0.0 < width < np.inf else 1.0
    return unit


@leaf
def typical_curvature(H, unit):
    """Geometric mean of the diagonal entries that are not negligible.

    The greatest one would not do: beside the price of a slack all other curvature is small, and a proximal term of its
    size lets the steps crawl.
    """
    greatest = 0.0
    for i in range(len(H)):
        greatest = max(greatest, H[i, i] * unit[i] * unit[i])
    total, count = 0.0, 0
    for i in range(len(H)):
        curvature = H[i, i] * unit[i] * unit[i]
        if curvature > FLAT * greatest:
            total += np.log(curvature)
            count += 1
    return max(np.exp(total / count), LEAST_SCALE) if count else LEAST_SCALE


@compiled
def approach(rows, b, f, work, centre, weights, settings):
    """Proximal steps, whose centre follows the solution until it does not move; changes `centre` and `work`."""
    rho, unit = weights
    status, iterations, row, moved = LIMIT, 0, -1, 0.0
    for _ in range(settings[3]):
        status, count, row = solve(rows, b, difference(f, products(rho, centre)), work, np.inf, settings[:2])
        iterations += count
        moved = 0.0
        for i in range(len(f)):
            moved = max(moved, abs(work[5][i] - centre[i]) / unit[i])
            centre[i] = work[5][i]
        if status != SOLVED or settings[2] * moved <= settings[0]:
            break
    if status == SOLVED and settings[2] * moved > ASTRAY:
        status = LIMIT
    return status, iterations, row


@compiled
def lifted(problem, groups, condensed, work, status, row):
    """Point and multipliers in all variables and rows."""
    Z, z0, source, length, defining, merged = (
        condensed[0], condensed[1], condensed[6], condensed[7], condensed[8], condensed[9]
    )  # fmt: skip
    size = work[4][0]
    active, weight = np.empty(size + 1, dtype=np.int64), np.empty(size + 1)
    copy_to(active, work[2][:size])
    copy_to(weight, work[3][:size])
    active[size], weight[size] = row, 1.0  # a ray, if there is one, takes this much of the row that cannot hold
    w = point(Z, z0, work[5])
    if status == EMPTY:
        gradient, size = np.zeros(len(w)), size + 1
    else:
        gradient = gradient_at(problem, w)
    active, weight = active[:size], weight[:size]
    return w, lift_multipliers(problem, groups, (source, length, defining, merged), gradient, active, weight)


@compiled
def centre_in(place, box, near, k):
    """Where the proximal steps begin: the point of the box nearest to `near`, or its middle."""
    start = near if len(near) else middle(box)
    centre = np.zeros(k)
    for j in range(len(place)):
        if place[j] >= 0:
            centre[place[j]] = min(max(start[j], box[0][j]), box[1][j])
    return centre


@compiled
def middle(box):
    """Middle of a box, 0 for a variable without bounds."""
    lb, ub = box
    centre = np.zeros(len(lb))
    for j in range(len(lb)):
        if lb[j] > -np.inf and ub[j] < np.inf:
            centre[j] = 0.5 * (lb[j] + ub[j])
    return centre


@compiled
def places_of(guess, source, m, n):
    """Numbers of the wished inequalities among those of this node."""
    at = np.empty((m + n, 2), dtype=np.int64)
    at[:] = -1
    for i in range(len(source)):
        at[source[i, 0], 0 if source[i, 1] > 0 else 1] = i
    found = np.zeros(len(guess), dtype=np.int64)
    count = 0
    for i in range(len(guess)):
        place = at[guess[i, 0], 0 if guess[i, 1] > 0 else 1]
        if place >= 0:
            found[count] = place
            count += 1
    return found[:count]


@compiled
def point(Z, z0, v):
    """All variables."""
    w = z0.copy()
    for j in range(len(w)):
        w[j] += dot(Z[j], v)
    return w


@compiled
def gradient_at(problem, w):
    """``P w + q``."""
    start, column, value = problem[0]
    gradient = problem[1].copy()
    for i in range(len(w)):
        for at in range(start[i], start[i + 1]):
            gradient[i] += value[at] * w[column[at]]
    return gradient


@leaf
def value_at(problem, w):
    """``1/2 w'P w + q'w``."""
    start, column, value = problem[0]
    total = 0.0
    for i in range(len(w)):
        slope = problem[1][i]
        for at in range(start[i], start[i + 1]):
            slope += 0.5 * value[at] * w[column[at]]
        total += slope * w[i]
    return total
