"""Many polyhedra with their rows stacked: inner points, which of them meet another one, whether neighbours meet.

Kernels. Polyhedron i is ``A[starts[i]:starts[i + 1]] x <= b[starts[i]:starts[i + 1]]``, rows of length one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.facets import inner_point_in
from hysdel_py.optimize.parametric.nearest import FOUND, NONE, nearest_in, workspace

__all__ = ["covered_facets", "inner_points", "meeting", "samples"]

_PARALLEL = 1e-9
"""A row whose part along a facet is shorter says nothing there."""


@compiled
def inner_points(A: Any, b: Any, starts: Any, margins: Any, violation: float, angle: float) -> Any:
    """For each polyhedron whether it has a point at the least margin, and one at the greatest that it has."""
    count, p = len(starts) - 1, A.shape[1]
    found, points, work = np.zeros(count, dtype=np.bool_), np.zeros((count, p)), workspace(p)
    guess = np.zeros(p)
    for i in range(count):
        N, h = A[starts[i] : starts[i + 1]], b[starts[i] : starts[i + 1]]
        found[i] = inner_point_in(N, h, len(h), guess, margins, points[i], work, violation, angle) == FOUND
    return found, points


@compiled
def samples(A: Any, b: Any, starts: Any, centres: Any, directions: Any, share: float) -> Any:
    """Points of each polyhedron: its centre, and near both ends of the chords through it in some directions."""
    count, p = centres.shape
    points = np.empty((count, 2 * len(directions) + 1, p))
    for i in range(count):
        points[i, 0] = centres[i]
        N, h = A[starts[i] : starts[i + 1]], b[starts[i] : starts[i + 1]]
        room = h - np.dot(N, centres[i])
        for k in range(len(directions)):
            speed = np.dot(N, directions[k])
            low, high = -np.inf, np.inf
            for row in range(len(h)):
                if speed[row] > 0:
                    high = min(high, max(room[row], 0.0) / speed[row])
                elif speed[row] < 0:
                    low = max(low, max(room[row], 0.0) / speed[row])
            if not np.isfinite(high):
                high = 0.0
            if not np.isfinite(low):
                low = 0.0
            points[i, 2 * k + 1] = centres[i] + share * low * directions[k]
            points[i, 2 * k + 2] = centres[i] + share * high * directions[k]
    return points


@compiled
def meeting(
    A: Any, b: Any, starts: Any, chosen: Any, centres: Any, N: Any, h: Any, first: bool, violation: float, angle: float
) -> Any:
    """Which of the chosen polyhedra have a point of ``{x : N x <= h}``; with `first`, the search ends at one.

    What could not be decided counts as meeting.
    """
    p = A.shape[1]
    most, own = 0, len(h)
    for place in range(len(chosen)):
        most = max(most, starts[chosen[place] + 1] - starts[chosen[place]])
    rows, sides, x, work = np.empty((most + own, p)), np.empty(most + own), np.empty(p), workspace(p)
    rows[:own], sides[:own] = N, h
    answer = np.zeros(len(chosen), dtype=np.bool_)
    for place in range(len(chosen)):
        i = chosen[place]
        size = own + starts[i + 1] - starts[i]
        rows[own:size], sides[own:size] = A[starts[i] : starts[i + 1]], b[starts[i] : starts[i + 1]]
        x[:] = centres[i]
        status, _ = nearest_in(rows, sides, size, 0.0, x, work, violation, angle)
        answer[place] = status != NONE
        if first and answer[place]:
            break
    return answer


@compiled
def covered_facets(
    A: Any, b: Any, starts: Any, owner: Any, rows: Any, beyond: Any, bounds: Any, margin: float, tolerance: float,
    most: int, violation: float, angle: float,
) -> Any:  # fmt: skip
    """Whether polyhedra on the other side of its hyperplane cover each facet, but for what holds no small ball.

    Parameters
    ----------
    owner, rows : int arrays of shape (k,)
        Polyhedron and row of each facet.
    beyond, bounds : int arrays
        Polyhedra with a facet on the other side: those of facet i are ``beyond[bounds[i]:bounds[i + 1]]``.
    margin : float
        Radius of the ball, within the facet.
    tolerance : float
        Distance up to which a point belongs to a polyhedron.
    most : int
        Parts of one facet that are looked at; beyond that it counts as not covered.
    """
    answer = np.zeros(len(rows), dtype=np.bool_)
    for place in range(len(rows)):
        others = beyond[bounds[place] : bounds[place + 1]]
        answer[place] = _covered(
            A, b, starts, owner[place], rows[place], others, margin, tolerance, most, violation, angle
        )
    return answer


@compiled
def _covered(
    A: Any, b: Any, starts: Any, own: int, row: int, others: Any, margin: float, tolerance: float, most: int,
    violation: float, angle: float,
) -> bool:  # fmt: skip
    """A part without a cover at its inner point is open; else what it has outside that cover is looked at."""
    if A.shape[1] == 1 or len(others) == 0:
        return len(others) > 0
    basis, foot = _basis(A[row]), A[row] * b[row]
    N, h = _along(A[starts[own] : starts[own + 1]], b[starts[own] : starts[own + 1]], basis, foot)
    q = N.shape[1]
    margins, work, x, guess = np.full(1, margin), workspace(q), np.empty(q), np.zeros(q)
    pending = [(N, h)]
    for _ in range(most):
        if len(pending) == 0:
            return True
        N, h = pending.pop()
        status = inner_point_in(N, h, len(h), guess, margins, x, work, violation, angle)
        if status == NONE:
            continue
        cover = -1
        if status == FOUND:
            cover = _holding(A, b, starts, others, foot + np.dot(basis, x), tolerance)
        if cover < 0:
            return False
        M, g = _along(A[starts[cover] : starts[cover + 1]], b[starts[cover] : starts[cover + 1]], basis, foot)
        rows, sides = np.concatenate((N, M)), np.concatenate((h, g))
        for k in range(len(h), len(sides)):
            part, limits = rows[: k + 1].copy(), sides[: k + 1].copy()
            part[k], limits[k] = -rows[k], -sides[k]
            pending.append((part, limits))
    return len(pending) == 0


@compiled
def _holding(A: Any, b: Any, starts: Any, others: Any, point: Any, tolerance: float) -> Any:
    """The first of the polyhedra that holds a point, -1 if none does."""
    for i in others:
        holds = True
        for row in range(starts[i], starts[i + 1]):
            if np.dot(A[row], point) > b[row] + tolerance:
                holds = False
                break
        if holds:
            return i
    return -1


@compiled
def _basis(normal: Any) -> Any:
    """Orthonormal columns that span what is orthogonal to a vector of length one: a reflection without a column."""
    p = len(normal)
    lead = np.argmax(np.abs(normal))
    v = normal.copy()
    v[lead] += 1.0 if normal[lead] >= 0 else -1.0
    reflection = np.eye(p) - 2.0 * np.outer(v, v) / np.dot(v, v)
    basis = np.empty((p, p - 1))
    basis[:, :lead], basis[:, lead:] = reflection[:, :lead], reflection[:, lead + 1 :]
    return basis


@compiled
def _along(A: Any, b: Any, basis: Any, foot: Any) -> Any:
    """Rows of a polyhedron in the coordinates of a hyperplane, of length one, without those parallel to it."""
    N, h = np.dot(A, basis), b - np.dot(A, foot)
    kept = np.zeros(len(b), dtype=np.bool_)
    for row in range(len(b)):
        length = np.sqrt(np.sum(N[row] ** 2))
        if length > _PARALLEL:
            N[row] /= length
            h[row] /= length
            kept[row] = True
    return N[kept], h[kept]
