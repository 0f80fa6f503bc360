"""One active set of the canonical problem: its law, its region, its facets and what lies beyond them; kernels.

The canonical problem is ``min 1/2 |v1|^2 + c(theta)'v2  subject to  M1 v1 + M2 v2 <= b(theta)``. Affine functions of
theta are arrays whose columns are the constant, the coefficients, and last the coefficient of an infinitesimal that
breaks ties.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.optimize.compiled import compiled
from hysdel_py.optimize.parametric.facets import facets, inner_point, same_rows
from hysdel_py.optimize.parametric.factor import factor, solve_lower, solve_upper
from hysdel_py.optimize.parametric.nearest import FOUND, LOST

__all__ = ["DEPENDENT", "EMPTY", "REGION", "UNCLEAR", "explore", "region_rows", "stationary"]

REGION, EMPTY, DEPENDENT, UNCLEAR = 0, 1, 2, 3
"""What an active set turned out to be."""


@compiled
def stationary(M: Any, b: Any, c: Any, active: Any, angle: float) -> Any:
    """Solution with the active rows met, and their multipliers, by equation (3) of docs/mpqp.md.

    Returns
    -------
    regular : bool
        Whether the rows are independent and fix v2.
    v : array of shape (n, columns)
    multipliers : array of shape (k, columns)
    """
    n, free = M.shape[1], len(c)
    curved = n - free
    k = len(active)
    rows, right = M[active], b[active]
    columns = b.shape[1]
    v, multipliers = np.zeros((n, columns)), np.zeros((k, columns))
    if k < free or k > n:
        return False, v, multipliers
    first = np.ascontiguousarray(rows[:, :curved])
    second = np.ascontiguousarray(rows[:, curved:])
    Yt, R2, rank = factor(np.ascontiguousarray(second.T), angle)
    if rank < free:
        return False, v, multipliers
    base = -np.dot(Yt[:free].T, solve_lower(R2, free, c))
    v1 = -np.dot(first.T, base)
    B = np.dot(Yt[free:], first)
    Qt, R, rank = factor(B, angle)
    if rank < k - free:
        return False, v, multipliers
    e = np.dot(Yt[free:], right) - np.dot(B, v1)
    y = solve_lower(R, rank, e)
    v[:curved] = v1 + np.dot(Qt[:rank].T, y)
    multipliers[:] = base - np.dot(Yt[free:].T, solve_upper(R, rank, y))
    v[curved:] = solve_upper(R2, free, np.dot(Yt[:free], right - np.dot(first, v[:curved])))
    return True, v, multipliers


@compiled
def region_rows(M: Any, b: Any, domain: Any, active: Any, v: Any, multipliers: Any, zero: float) -> Any:
    """Rows ``N theta <= h`` of length one of the region, in the order multipliers, slacks, domain.

    Returns
    -------
    possible : bool
        False if a row can never hold.
    N, h : arrays of shapes (r, p), (r,)
    source : int array of shape (r,)
        A row's own number: of a constraint for slacks, ``m + `` its place among the active rows for multipliers, -1 for
        the domain.
    """
    m, p = M.shape[0], b.shape[1] - 2
    k = len(active)
    inactive = np.ones(m, dtype=np.bool_)
    inactive[active] = False
    excess = np.dot(M, v) - b
    N, h = np.empty((m + len(domain), p)), np.empty(m + len(domain))
    source = np.empty(m + len(domain), dtype=np.int64)
    size = 1.0 + np.max(np.abs(v))
    weight = 1.0 + (np.max(np.abs(multipliers)) if k else 0.0)
    count = 0
    for row in range(m + k):
        if row < m:
            if not inactive[row]:
                continue
            line, scale = excess[row], size + np.max(np.abs(b[row]))
        else:
            line, scale = -multipliers[row - m], weight
        normal = line[1 : 1 + p]
        length = np.sqrt(np.sum(normal * normal))
        if length <= zero * scale:
            sign = line[0] if abs(line[0]) > zero * scale else line[1 + p]
            if sign > 0:
                return False, N, h, source
            continue
        N[count], h[count], source[count] = normal / length, -line[0] / length, row
        count += 1
    for row in range(len(domain)):
        N[count], h[count], source[count] = domain[row, 1:], domain[row, 0], -1
        count += 1
    return True, N[:count].copy(), h[:count].copy(), source[:count].copy()


@compiled
def explore(M: Any, b: Any, c: Any, domain: Any, active: Any, guess: Any, margins: Any, limits: Any) -> Any:
    """Everything about one active set.

    Parameters
    ----------
    M : array of shape (m, n)
    b, c : arrays of shapes (m, p + 2), (n2, p + 2)
    domain : array of shape (r, p + 1)
        Side and normal of each row of the domain of theta.
    active : int array of shape (k,)
    guess : array of shape (p,)
        Near the region.
    margins : array
        Distances tried for the inner point; the last one is the least that counts as inner.
    limits : array of shape (5,)
        Violation, angle, independence, zero, sameness.

    Returns
    -------
    status : int
    centre : array of shape (p,)
    N, h : arrays of shapes (f, p), (f,)
        Facets.
    source : int array of shape (f,)
    points : array of shape (f, p)
        One on each facet.
    shared : bool array of shape (f,)
        Whether another row says the same.
    beyond : int array of shape (q, 3)
        Facet, row that leaves or -1, row that enters or -1.
    lost : int
        Rows that could not be judged.
    """
    violation, angle, independence, zero, same = limits
    p = b.shape[1] - 2
    none = np.zeros((0, p)), np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros((0, p)), np.zeros(0, dtype=np.bool_)
    nowhere = np.zeros((0, 3), dtype=np.int64)
    regular, v, multipliers = stationary(M, b, c, active, angle)
    if not regular:
        return DEPENDENT, guess, none[0], none[1], none[2], none[3], none[4], nowhere, 0
    possible, N, h, source = region_rows(M, b, domain, active, v, multipliers, zero)
    if not possible:
        return EMPTY, guess, none[0], none[1], none[2], none[3], none[4], nowhere, 0
    status, centre = inner_point(N, h, guess, margins, violation, angle)
    if status != FOUND:
        answer = UNCLEAR if status == LOST else EMPTY
        return answer, guess, none[0], none[1], none[2], none[3], none[4], nowhere, 0
    first = same_rows(N, h, same)
    own = np.flatnonzero(first == np.arange(len(first)))
    single, sides = N[own], h[own]
    is_facet, points, lost = facets(single, sides, centre, margins[-1], violation, angle)
    chosen = np.flatnonzero(is_facet)
    rows = own[chosen]
    shared = np.zeros(len(rows), dtype=np.bool_)
    for place in range(len(rows)):
        shared[place] = np.sum(first == rows[place]) > 1
    beyond = _neighbours(M, len(c), active, source[rows], independence)
    return REGION, centre, N[rows], h[rows], source[rows], points[chosen], shared, beyond, lost


@compiled
def _neighbours(M: Any, free: int, active: Any, source: Any, independence: float) -> Any:
    """Rows that leave and enter across each facet."""
    m, n = M.shape
    Qt, R, rank = factor(M[active], 0.0)
    found = np.empty((len(source) * (m + 1), 3), dtype=np.int64)
    count = 0
    for facet in range(len(source)):
        row = source[facet]
        if row >= m:
            count = _leaving(M, free, active, row - m, facet, independence, found, count)
        elif row >= 0:
            count = _entering(M, active, Qt, R, rank, row, facet, independence, found, count)
    return found[:count].copy()


@compiled
def _entering(
    M: Any, active: Any, Qt: Any, R: Any, k: int, row: int, facet: int, independence: float, found: Any, count: int
) -> int:
    d = np.dot(Qt, M[row])
    if k < len(d) and np.sqrt(np.sum(d[k:] * d[k:])) > independence:
        found[count] = facet, -1, row
        return count + 1
    weights = solve_upper(R, k, d[:k].copy().reshape(k, 1))
    for place in range(k):
        if weights[place, 0] > independence:
            found[count] = facet, active[place], row
            count += 1
    return count


@compiled
def _leaving(M: Any, free: int, active: Any, place: int, facet: int, independence: float, found: Any, count: int) -> int:
    m, n = M.shape
    if free == 0:
        found[count] = facet, active[place], -1
        return count + 1
    k = len(active)
    stay = np.arange(k) != place
    flat = np.ascontiguousarray(M[:, n - free :])
    basis = np.ascontiguousarray(flat[active[stay]].T)
    Yt, R, rank = factor(basis, independence)
    if rank == free:
        found[count] = facet, active[place], -1
        return count + 1
    # Columns before number `rank` are independent; the direction combines them to undo that one.
    p = np.zeros(free)
    p[rank] = 1.0
    if rank:
        d = np.dot(Yt, basis[rank])
        p[:rank] = -solve_upper(R, rank, d[:rank].copy().reshape(rank, 1))[:, 0]
    speed = np.dot(flat, p / np.sqrt(np.sum(p * p)))
    if speed[active[place]] > 0:
        speed = -speed
    speed[active] = 0.0
    for row in range(m):
        if speed[row] > independence:
            found[count] = facet, active[place], row
            count += 1
    return count
