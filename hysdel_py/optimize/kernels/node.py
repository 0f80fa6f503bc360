"""One node of a branch and bound from bounds to multipliers, without leaving compiled code."""

from __future__ import annotations

import numpy as np

from hysdel_py.optimize.compiled import compiled
from hysdel_py.optimize.kernels import active_set
from hysdel_py.optimize.kernels.condensing import condense, lift_multipliers

__all__ = ["solve_node"]

inverse_factor, solve, start_from = active_set.inverse_factor, active_set.solve, active_set.start_from
EMPTY, LIMIT = active_set.EMPTY, active_set.LIMIT
TOO_LARGE = 4
"""Status of a node with more free variables than wanted."""
ASTRAY = 1e-6
"""The proximal steps have not settled while their pull exceeds this, relative to the greatest curvature."""


@compiled
def solve_node(problem, groups, box, wide, guess, settings):
    """Condense and solve.

    Parameters
    ----------
    problem, groups, box, wide
        See :func:`hysdel_py.optimize.kernels.condensing.condense`.
    guess : array of shape (rows, 2)
        Active inequalities of a similar node: row (or m + variable) and sign of the side.
    settings : (tolerance, iterations, proximity, rounds, largest)
        `proximity` is the weight of the proximal term relative to the greatest diagonal entry of the Hessian.

    Returns
    -------
    status, iterations, w, y, active
        `y` are multipliers of all rows, or a ray of Farkas for an empty node; `active` has the form of `guess`.
    """
    Z, H, f, N, b, source, length, defining, merged = condense(problem, groups, box, wide)
    k = len(f)
    none = np.zeros((0, 2), dtype=np.int64)
    if k > settings[4]:
        return TOO_LARGE, 0, Z[:, k].copy(), np.zeros(len(problem[3])), none
    scale = 0.0
    for i in range(k):
        scale = max(scale, H[i, i])
    rho = settings[2] * max(scale, 1e-6)
    for i in range(k):
        H[i, i] += rho
    J, sound = inverse_factor(H)
    if not sound:
        return LIMIT, 0, Z[:, k].copy(), np.zeros(len(problem[3])), none
    work = (
        J, np.zeros((k, k)), np.zeros(k, dtype=np.int64), np.zeros(k), np.zeros(1, dtype=np.int64), np.zeros(k)
    )  # fmt: skip
    start_from(places_of(guess, source, len(problem[3]), len(Z)), N, work)
    status, iterations, row, moved = LIMIT, 0, -1, 0.0
    centre = middle(Z, box, k)
    for _ in range(settings[3]):
        status, count, row = solve(N, b, f - rho * centre, work, np.inf, (settings[0], settings[1]))
        iterations += count
        moved = 0.0
        for i in range(k):
            moved = max(moved, abs(work[5][i] - centre[i]))
            centre[i] = work[5][i]
        if status != 0 or rho * moved <= settings[0] * max(scale, 1e-6):
            break
    if status == 0 and rho * moved > ASTRAY * max(scale, 1e-6):
        status = LIMIT
    size = work[4][0]
    active, weight = work[2][:size].copy(), work[3][:size].copy()
    w = point(Z, work[5])
    gradient = np.zeros(len(w))
    if status == EMPTY:
        active, weight = np.append(active, row), np.append(weight, 1.0)
    else:
        gradient = gradient_at(problem, w)
    y = lift_multipliers(problem, groups, (source, length, defining, merged), gradient, active, weight)
    return status, iterations, w, y, source[active]


@compiled
def middle(Z, box, k):
    """Middle of the box in the free variables."""
    centre = np.zeros(k)
    for j in range(len(Z)):
        if Z[j, k] == 0.0:
            for c in range(k):
                if Z[j, c] == 1.0 and np.isfinite(box[0][j]) and np.isfinite(box[1][j]):
                    centre[c] = 0.5 * (box[0][j] + box[1][j])
    return centre


@compiled
def places_of(guess, source, m, n):
    """Numbers of the wished inequalities among those of this node."""
    at = np.full((m + n, 2), -1, dtype=np.int64)
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
def point(Z, v):
    """All variables."""
    n, k = Z.shape[0], Z.shape[1] - 1
    w = np.zeros(n)
    for j in range(n):
        total = Z[j, k]
        for c in range(k):
            total += Z[j, c] * v[c]
        w[j] = total
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
