"""An inner point and the facets of ``{x : N x <= h}``, rows of length one; kernels.

Facets by K. Clarkson, "More output-sensitive geometric algorithms", FOCS 1994: a row is tried against the facets known
so far only, and a row that passes leads to a facet by a ray.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.factor import refactor
from hysdel_py.optimize.parametric.nearest import FOUND, NONE, nearest_in, workspace
from hysdel_py.optimize.parametric.vectors import back_substituted, differs, first_hit, turned

__all__ = ["facets", "inner_point", "inner_point_in", "same_rows"]

_ANGLE = 1e-8
"""Rows of a corner that are closer to dependence prove nothing."""

_UNKNOWN = -2
"""A row that could not be judged."""


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
    x = guess.copy()
    return inner_point_in(N, h, len(h), guess, margins, x, workspace(len(guess)), violation, angle), x


@compiled
def inner_point_in(
    N: Any, h: Any, m: int, guess: Any, margins: Any, x: Any, work: Any, violation: float, angle: float
) -> Any:
    """The same among the first m rows, with the point in a given array."""
    last, least = len(margins) - 1, guess.copy()
    for attempt in range(len(margins)):
        place = attempt - 1
        if attempt < 2:
            place = attempt * last
        x[:] = guess
        status, _ = nearest_in(N, h, m, margins[place], x, work, violation, angle)
        if attempt == 1:
            if status != FOUND:
                return status
            least[:] = x
        elif status == FOUND or last == 0:
            return status
    x[:] = least
    return FOUND


@compiled
def same_rows(N: Any, h: Any, tolerance: float) -> Any:
    """For each row the first one that says the same up to the tolerance, often itself."""
    m, n = N.shape
    first = np.arange(m)
    key = h + np.dot(N, np.cos(1.0 + np.arange(n)))
    order = np.argsort(key)
    for place in range(m):
        row = order[place]
        for later in range(place + 1, m):
            other = order[later]
            if key[other] - key[row] > (n + 1) * tolerance:
                break
            if abs(h[row] - h[other]) <= tolerance and not differs(N, row, other, tolerance):
                least = min(first[row], first[other])
                first[row], first[other] = least, least
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
    work, x, ray = workspace(n), np.empty(n), np.empty(n)
    slack = h - np.dot(N, centre)
    speed = np.empty(m)
    is_facet, points = np.zeros(m, dtype=np.bool_), np.zeros((m, n))
    known, sides = np.empty((m + 1, n)), np.empty(m + 1)
    count: Any = np.int64(0)  # not a literal: kernels would be compiled for it
    for row in range(m):
        hit = first_hit(N, slack, m, N[row], margin, speed)
        if hit >= 0 and not is_facet[hit]:
            _enter(hit, centre, N[row], slack[hit] / speed[hit], is_facet, points)
            known[count], sides[count] = N[hit], h[hit] - margin
            count += 1
    open_rows = ~is_facet
    lost = 0
    for row in range(m):
        while open_rows[row]:
            status, k = _against_known(known, sides, count, N[row], h[row], centre, x, work, violation, angle)
            if status == NONE:
                open_rows[row] = False
                if k == n + 1:
                    _close(N, h, known, sides, count, margin, open_rows, work)
                break
            hit = -1
            if status == FOUND:
                ray[:] = x - centre
                hit = first_hit(N, slack, m, ray, margin, speed)
            if hit >= 0 and not is_facet[hit]:
                _enter(hit, centre, ray, slack[hit] / speed[hit], is_facet, points)
            else:
                x[:] = centre
                hit = _judge(N, h, x, row, open_rows, is_facet, margin, work, violation, angle)
                if hit >= 0:
                    _enter(hit, x, x, 0.0, is_facet, points)
            lost += hit == _UNKNOWN
            open_rows[row if hit < 0 else hit] = False
            if hit >= 0:
                known[count], sides[count] = N[hit], h[hit] - margin
                count += 1
    return is_facet, points, lost


@compiled
def _against_known(
    known: Any, sides: Any, count: int, normal: Any, side: float, centre: Any, x: Any, work: Any, violation: float,
    angle: float,
) -> Any:  # fmt: skip
    """The nearest point where a row is met and the known facets are kept."""
    for i in range(len(normal)):
        known[count, i] = -normal[i]
    sides[count] = -side
    x[:] = centre
    return nearest_in(known, sides, count + 1, 0.0, x, work, violation, angle)


@compiled
def _enter(hit: int, start: Any, ray: Any, length: float, is_facet: Any, points: Any) -> None:
    """Mark a facet and the point where a ray meets it."""
    is_facet[hit] = True
    for i in range(len(start)):
        points[hit, i] = start[i] + length * ray[i]


@compiled
def _close(N: Any, h: Any, known: Any, sides: Any, own: int, margin: float, open_rows: Any, work: Any) -> None:
    """Close the rows that a corner of the known facets holds: non-negative combinations of its rows.

    The corner are the active rows of the nearest-point problem without the row that was tried, number `own`.
    """
    n = N.shape[1]
    Qt, R, active, _, d, weights = work
    corner, ends, count = np.empty((n, n)), np.empty(n), 0
    for place in range(n + 1):
        if active[place] < own:
            corner[count], ends[count] = known[active[place]], sides[active[place]] + margin
            count += 1
    if count < n or refactor(corner, _ANGLE, Qt, R, d) < n:
        return
    for row in range(len(h)):
        if open_rows[row]:
            turned(Qt, N[row], n, d)
            back_substituted(R, d, n, weights)
            least, total = np.inf, 0.0
            for i in range(n):
                least = min(least, weights[i])
                total += weights[i] * ends[i]
            if least >= 0 and total <= h[row]:
                open_rows[row] = False


@compiled
def _judge(
    N: Any, h: Any, x: Any, row: int, open_rows: Any, is_facet: Any, margin: float, work: Any, violation: float,
    angle: float,
) -> int:  # fmt: skip
    """The row with a point of its facet in x, or -1 if it has none, _UNKNOWN if that could not be found out."""
    rows, sides = np.empty(N.shape), np.empty(len(h))
    count: Any = np.int64(0)
    for other in range(len(h)):
        if other == row:
            rows[count], sides[count] = -N[row], -h[row]
            count += 1
        elif open_rows[other] or is_facet[other]:
            rows[count], sides[count] = N[other], h[other] - margin
            count += 1
    status, _ = nearest_in(rows, sides, count, 0.0, x, work, violation, angle)
    if status == FOUND:
        return row
    return -1 if status == NONE else _UNKNOWN
