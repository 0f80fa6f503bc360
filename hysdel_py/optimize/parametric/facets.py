"""An inner point and the facets of ``{x : N x <= h}``, rows of length one; kernels.

Facets by K. Clarkson, "More output-sensitive geometric algorithms", FOCS 1994: a row is tried against the facets known
so far only, and a row that passes leads to a facet by a ray.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.optimize.compiled import compiled
from hysdel_py.optimize.parametric.factor import factor, solve_upper
from hysdel_py.optimize.parametric.nearest import FOUND, NONE, nearest

__all__ = ["facets", "inner_point", "same_rows"]

_ANGLE = 1e-8
"""Rows of a corner that are closer to dependence prove nothing."""


@compiled
def inner_point(N: Any, h: Any, guess: Any, margins: Any, violation: float, angle: float) -> Any:
    """A point that keeps a distance from all rows: the greatest of the falling margins for which there is one.

    If there is none for the first, the last one is tried at once: what has little room often has none.

    Returns
    -------
    status : int
        FOUND, NONE or LOST.
    point : array of shape (n,)
    """
    status, x, _, _ = nearest(N, h - margins[0], guess, violation, angle)
    if status == FOUND or len(margins) == 1:
        return status, x
    least = nearest(N, h - margins[-1], guess, violation, angle)
    if least[0] != FOUND:
        return least[0], least[1]
    for margin in margins[1:-1]:
        status, x, _, _ = nearest(N, h - margin, guess, violation, angle)
        if status == FOUND:
            return status, x
    return least[0], least[1]


@compiled
def same_rows(N: Any, h: Any, tolerance: float) -> Any:
    """For each row the first one that says the same up to the tolerance, often itself."""
    m, n = N.shape
    first = np.arange(m)
    key = h + np.dot(N, np.cos(1.0 + np.arange(n)))
    for row in range(m):
        for other in np.flatnonzero(np.abs(key[row + 1 :] - key[row]) <= (n + 1) * tolerance) + row + 1:
            if abs(h[row] - h[other]) <= tolerance and np.max(np.abs(N[row] - N[other])) <= tolerance:
                first[other] = min(first[row], first[other])
    return first


@compiled
def facets(N: Any, h: Any, centre: Any, margin: float, violation: float, angle: float) -> Any:
    """Rows without which the polyhedron would be larger, and a point on each such facet.

    Parameters
    ----------
    N, h : arrays of shapes (m, n), (m,)
        No two rows may be the same.
    centre : array of shape (n,)
        An inner point.
    margin : float
        A facet has a point that keeps this distance from all other rows.

    Returns
    -------
    is_facet : bool array of shape (m,)
    points : array of shape (m, n)
    lost : int
        Rows that could not be judged; they count as no facets.
    """
    m, n = N.shape
    slack = h - np.dot(N, centre)
    is_facet, points = np.zeros(m, dtype=np.bool_), np.zeros((m, n))
    known, sides = np.empty((m + 1, n)), np.empty(m + 1)
    count = _shoot(N, slack, centre, margin, is_facet, points, known, sides, h)
    open_rows = ~is_facet
    lost = 0
    for row in range(m):
        while open_rows[row]:
            known[count], sides[count] = -N[row], -h[row]
            status, x, active, _ = nearest(known[: count + 1], sides[: count + 1], centre, violation, angle)
            if status == NONE:
                open_rows[row] = False
                if len(active) == n + 1:
                    _close(N, h, known[active[active < count]], sides[active[active < count]] + margin, open_rows)
                break
            hit = _first_hit(N, slack, x - centre, margin) if status == FOUND else -1
            if hit >= 0 and not is_facet[hit]:
                point = centre + (slack[hit] / np.dot(N[hit], x - centre)) * (x - centre)
            else:
                hit, point = _judge(N, h, centre, row, open_rows | is_facet, margin, violation, angle)
            if hit >= 0:
                is_facet[hit], open_rows[hit] = True, False
                points[hit] = point
                known[count], sides[count] = N[hit], h[hit] - margin
                count += 1
            else:
                lost -= hit + 1
                open_rows[row] = False
    return is_facet, points, lost


@compiled
def _close(N: Any, h: Any, corner: Any, sides: Any, open_rows: Any) -> None:
    """Close the rows that a corner of the known facets holds: non-negative combinations of its rows."""
    n = N.shape[1]
    Qt, R, rank = factor(corner, _ANGLE)
    if rank < n or len(corner) != n:
        return
    rows = np.flatnonzero(open_rows)
    weights = solve_upper(R, n, np.dot(Qt, N[rows].T))
    for place in range(len(rows)):
        own = weights[:, place].copy()
        if np.min(own) >= 0 and np.sum(own * sides) <= h[rows[place]]:
            open_rows[rows[place]] = False


@compiled
def _shoot(
    N: Any, slack: Any, centre: Any, margin: float, is_facet: Any, points: Any, known: Any, sides: Any, h: Any
) -> int:
    """Mark what rays from the centre along the normals hit first; number of facets found."""
    count = 0
    for ray in range(len(slack)):
        direction = N[ray]
        hit = _first_hit(N, slack, direction, margin)
        if hit >= 0 and not is_facet[hit]:
            is_facet[hit] = True
            points[hit] = centre + (slack[hit] / np.dot(N[hit], direction)) * direction
            known[count], sides[count] = N[hit], h[hit] - margin
            count += 1
    return count


@compiled
def _first_hit(N: Any, slack: Any, direction: Any, margin: float) -> int:
    """Row that a ray from the centre meets first, or -1 if another one is closer than the margin there."""
    speed = np.dot(N, direction)
    rate = speed / slack
    hit = int(rate.argmax())
    if rate[hit] <= 0:
        return -1
    left = slack - speed / rate[hit]
    left[hit] = np.inf
    return hit if left.min() > margin else -1


@compiled
def _judge(N: Any, h: Any, centre: Any, row: int, others: Any, margin: float, violation: float, angle: float) -> Any:
    """The row with a point of its facet, or -1 if it has none, -2 if that could not be found out."""
    kept = np.flatnonzero(others)
    rows, sides = N[kept], h[kept] - margin
    place = int(np.searchsorted(kept, row))
    rows[place], sides[place] = -N[row], -h[row]
    status, x, _, _ = nearest(rows, sides, centre, violation, angle)
    if status == FOUND:
        return row, x
    return (-1 if status == NONE else -2), x
