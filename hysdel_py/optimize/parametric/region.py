"""One active set of the canonical problem: its law, its region and its facets.

The canonical problem is ``min 1/2 |v1|^2 + c(theta)'v2  subject to  M1 v1 + M2 v2 <= b(theta)``. Affine functions of
theta are arrays whose columns are the constant, the coefficients, and last the coefficient of an infinitesimal that
breaks ties.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from hysdel_py.optimize.compiled import compiled
from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.facets import facets, inner_point, same_rows
from hysdel_py.optimize.parametric.factor import factor, solve_lower, solve_upper
from hysdel_py.optimize.parametric.nearest import FOUND, LOST
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["DEPENDENT", "EMPTY", "REGION", "UNCLEAR", "Explored", "explore", "region_rows", "stationary"]

REGION, EMPTY, DEPENDENT, UNCLEAR = 0, 1, 2, 3
"""What an active set turned out to be."""


def stationary(M: Any, b: Any, c: Any, active: Any, angle: float) -> tuple[bool, Any, Any]:
    """Solution with the active rows met, and their multipliers, by equation (3) of docs/mpqp.md.

    Returns
    -------
    regular : bool
        Whether the rows are independent and fix v2.
    v : array of shape (n, columns)
    multipliers : array of shape (k, columns)
    """
    n, free, k = M.shape[1], len(c), len(active)
    if k < free or k > n:
        return False, None, None
    if not free:
        return least_distance(M[active], b[active], angle)  # type: ignore[no-any-return]
    first, second = M[active, : n - free], M[active, n - free :]
    Y, R2 = np.linalg.qr(second, mode="complete")
    if np.abs(np.diag(R2)).min() <= angle:
        return False, None, None
    Y1, W = Y[:, :free], Y[:, free:]
    base = -Y1 @ np.linalg.solve(R2[:free].T, c)
    v1 = -first.T @ base
    B = np.ascontiguousarray(W.T @ first)
    regular, step, own = least_distance(B, W.T @ b[active] - B @ v1, angle)
    if not regular:
        return False, None, None
    v1 = v1 + step
    v2 = np.linalg.solve(R2[:free], Y1.T @ (b[active] - first @ v1))
    return True, np.vstack([v1, v2]), base + W @ own


@compiled
def least_distance(rows: Any, right: Any, angle: float) -> Any:
    """Shortest v with ``rows v = right``, column by column, and the multipliers ``v = -rows' multipliers``."""
    k, n = rows.shape
    Qt, R, rank = factor(rows, angle)
    if rank < k:
        return False, np.zeros((n, right.shape[1])), np.zeros(right.shape)
    y = solve_lower(R, k, right)
    return True, np.dot(Qt[:k].T, y), -solve_upper(R, k, y)


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
    size = 1.0 + (np.max(np.abs(v)) if v.size else 0.0)
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


@dataclass(frozen=True, eq=False, slots=True)
class Explored:
    """Everything about one active set.

    Attributes
    ----------
    status : int
        REGION, EMPTY, DEPENDENT or UNCLEAR; the rest has a meaning for REGION only.
    v : array of shape (n, p + 2)
        Law.
    centre : array of shape (p,)
    N, h : arrays of shapes (f, p), (f,)
        Facets.
    source : int array of shape (f,)
        As in :func:`region_rows`.
    points : array of shape (f, p)
        One on each facet.
    shared : bool array of shape (f,)
        Whether another row says the same.
    lost : int
        Rows that could not be judged.
    """

    status: int
    v: Any = None
    centre: Any = None
    N: Any = None
    h: Any = None
    source: Any = None
    points: Any = None
    shared: Any = None
    lost: int = 0


def explore(form: Canonical, active: Any, guess: Any, margins: Any, settings: MpQpSettings) -> Explored:
    """Law, region and facets of an active set; `guess` is a point near the region."""
    violation, angle = settings.violation, settings.angle
    regular, v, multipliers = stationary(form.M, form.b, form.c, active, angle)
    if not regular:
        return Explored(DEPENDENT)
    possible, N, h, source = region_rows(form.M, form.b, form.domain, active, v, multipliers, settings.zero)
    if not possible:
        return Explored(EMPTY)
    status, centre = inner_point(N, h, guess, margins, violation, angle)
    if status != FOUND:
        return Explored(UNCLEAR if status == LOST else EMPTY)
    first = same_rows(N, h, settings.same)
    own = np.flatnonzero(first == np.arange(len(first)))
    is_facet, points, lost = facets(N[own], h[own], centre, settings.radius, violation, angle)
    chosen = np.flatnonzero(is_facet)
    rows = own[chosen]
    shared = np.bincount(first, minlength=len(first))[rows] > 1
    return Explored(REGION, v, centre, N[rows], h[rows], source[rows], points[chosen], shared, int(lost))
