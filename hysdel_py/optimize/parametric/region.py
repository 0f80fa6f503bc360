"""One active set of the canonical problem: its law and its region; kernels.

The canonical problem is ``min 1/2 |v1|^2 + c(theta)'v2  subject to  M1 v1 + M2 v2 <= b(theta)``. Affine functions of
theta are arrays whose columns are the constant, the coefficients, and last the coefficient of an infinitesimal that
breaks ties.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.factor import factor
from hysdel_py.optimize.parametric.vectors import blend, greatest, row_lengths, solve_lower, solve_upper

__all__ = ["least_distance", "region_rows", "stationary"]


@compiled
def stationary(M: Any, b: Any, c: Any, active: Any, angle: float) -> Any:
    """Solution with the active rows met, and their multipliers, by equation (3) of docs/mpqp.md.

    Returns
    -------
    regular : bool
        Whether the rows are independent and fix v2.
    v : array of shape (n, columns)
    multipliers : array of shape (k, columns)
    Qt, R : arrays of shapes (n1, n1), (k1, k1)
        Factor of the active rows; of what the equations of v2 leave of them if there is a v2.
    """
    n, free, k = M.shape[1], len(c), len(active)
    rows, right = M[active], b[active]
    if not free:
        return least_distance(rows, right, angle)
    nothing = np.zeros((0, 0))
    if k < free or k > n:
        return False, np.zeros((n, b.shape[1])), np.zeros(right.shape), nothing, nothing
    first, second = rows[:, : n - free].copy(), rows[:, n - free :].copy()
    Yt, R2, rank = factor(np.ascontiguousarray(second.T), angle)
    if rank < free:
        return False, np.zeros((n, b.shape[1])), np.zeros(right.shape), nothing, nothing
    pull = c.copy()
    solve_lower(R2, free, pull)
    base = np.zeros(right.shape)
    blend(Yt[:free], pull, base, -1.0)
    v = np.zeros((n, b.shape[1]))
    blend(first, base, v[: n - free], -1.0)
    W = np.ascontiguousarray(Yt[free:].T)
    left = right.copy()
    blend(np.ascontiguousarray(first.T), v[: n - free], left, -1.0)
    B, side = np.zeros((k - free, n - free)), np.zeros((k - free, b.shape[1]))
    blend(W, first, B, 1.0)
    blend(W, left, side, 1.0)
    regular, step, own, Qt, R = least_distance(B, side, angle)
    if not regular:
        return False, v, base, nothing, nothing
    blend(Yt[free:], own, base, 1.0)
    v[: n - free] += step
    left = right.copy()
    blend(np.ascontiguousarray(first.T), v[: n - free], left, -1.0)
    flat = np.zeros((free, b.shape[1]))
    blend(np.ascontiguousarray(Yt[:free].T), left, flat, 1.0)
    solve_upper(R2, free, flat)
    v[n - free :] = flat
    return True, v, base, Qt, R


@compiled
def least_distance(rows: Any, right: Any, angle: float) -> Any:
    """Shortest v with ``rows v = right``, column by column, and the multipliers ``v = -rows' multipliers``."""
    k, n = rows.shape
    Qt, R, rank = factor(rows, angle)
    v, y = np.zeros((n, right.shape[1])), right.copy()
    if rank < k:
        return False, v, y, Qt, R
    solve_lower(R, k, y)
    blend(Qt[:k], y, v, 1.0)
    solve_upper(R, k, y)
    return True, v, -y, Qt, R


@compiled
def region_rows(M: Any, b: Any, domain: Any, active: Any, v: Any, multipliers: Any, zero: float) -> Any:
    """Rows ``N theta <= h`` of length one of the region, in the order slacks, multipliers, domain.

    Returns
    -------
    possible : bool
        False if a row can never hold.
    N, h : arrays of shapes (r, p), (r,)
    source : int array of shape (r,)
        A row's own number: of a constraint for slacks, ``m + `` its place among the active rows for multipliers, -1 for
        the domain.
    """
    m, p, k = M.shape[0], b.shape[1] - 2, len(active)
    lines = np.zeros((m + k, p + 2))
    blend(M.T, v, lines[:m], 1.0)
    lines[:m] -= b
    lines[m:] = -multipliers
    N, h = np.empty((m + k + len(domain), p)), np.empty(m + k + len(domain))
    source = np.empty(len(h), dtype=np.int64)
    lengths, size, weight = row_lengths(lines, p), greatest(v), greatest(multipliers)
    inactive = np.ones(m + k, dtype=np.bool_)
    for row in active:
        inactive[row] = False
    count = 0
    for row in range(m + k):
        if not inactive[row]:
            continue
        scale = 1.0 + size + greatest(b[row]) if row < m else 1.0 + weight
        length, small = lengths[row], zero * scale
        if length <= small:
            sign = lines[row, 0] if abs(lines[row, 0]) > small else lines[row, 1 + p]
            if sign > 0:
                return False, N, h, source
            continue
        for i in range(p):
            N[count, i] = lines[row, 1 + i] / length
        h[count], source[count] = -lines[row, 0] / length, row
        count += 1
    for row in range(len(domain)):
        N[count], h[count], source[count] = domain[row, 1:], domain[row, 0], -1
        count += 1
    return True, N[:count].copy(), h[:count].copy(), source[:count].copy()
