"""The hyperplane that splits a set of polyhedra best, as a node of a search tree needs it; kernels.

Samples of the polyhedra guess the sides and rank the hyperplanes; for the best of them what the samples leave open is
decided by nearest-point problems within the cell of the node.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.nearest import NONE, nearest_in, workspace

__all__ = ["best_split"]


@compiled
def best_split(
    A: Any, b: Any, starts: Any, centres: Any, points: Any, groups: Any, regions: Any, inside: Any, N: Any, h: Any,
    normals: Any, offsets: Any, few: int, most: int, depth: float, violation: float, angle: float,
) -> Any:  # fmt: skip
    """The hyperplane that leaves the fewest groups on its fuller side.

    Parameters
    ----------
    A, b, starts : arrays
        All polyhedra, stacked.
    centres, points : arrays of shapes (count, p), (count, samples, p)
        A point of each, and more points.
    groups : int array of shape (count,)
    regions : int array of shape (n,)
        Polyhedra at the node.
    inside : Boolean array of shape (n, samples)
        Which of their points lie in the cell of the node.
    N, h : arrays
        Rows of the cell.
    normals, offsets : arrays of shapes (k, p), (k,)
        Hyperplanes ``normal x + offset = 0``.
    few, most : int
        At most `most` of the first `few` hyperplanes that separate something are compared; without one, the first of
        the others is taken.
    depth : float
        A polyhedron is on a side if it has points at this distance from the hyperplane.

    Returns
    -------
    number : int
        Of the hyperplane, -1 if none separates anything.
    below, above : Boolean arrays of shape (n,)
    work : int
        Nearest-point problems solved.
    """
    n, own = len(regions), groups[regions]
    stamp = np.zeros(groups.max() + 1, dtype=np.int64)
    best, chosen, work = np.int64(-1), np.int64(-1), np.int64(0)
    below, above = np.zeros(n, dtype=np.bool_), np.zeros(n, dtype=np.bool_)
    found = 0
    for begin, end, limit in ((0, min(few, len(offsets)), most), (min(few, len(offsets)), len(offsets), 1)):
        low, high = _seen(points, regions, inside, normals[begin:end], offsets[begin:end], depth)
        keys = np.empty(end - begin, dtype=np.int64)
        for place in range(end - begin):
            keys[place] = _cost(own, low[place], high[place], stamp)
        found = 0
        for place in np.argsort(keys, kind="mergesort"):
            work += _decide(
                A, b, starts, centres, regions, N, h, normals[begin + place], offsets[begin + place], depth, low[place],
                high[place], violation, angle,
            )  # fmt: skip
            if max(low[place].sum(), high[place].sum()) == n:
                continue
            cost = _cost(own, low[place], high[place], stamp)
            if best < 0 or cost < best:
                best, chosen = cost, begin + place
                below[:], above[:] = low[place], high[place]
            found += 1
            if found == limit:
                break
        if found > 0:
            break
    return chosen, below, above, work


@compiled
def _seen(points: Any, regions: Any, inside: Any, normals: Any, offsets: Any, depth: float) -> Any:
    """Polyhedra of which points in the cell lie on either side of the hyperplanes."""
    n, count, p = len(regions), points.shape[1], points.shape[2]
    low = np.zeros((len(offsets), n), dtype=np.bool_)
    high = np.zeros((len(offsets), n), dtype=np.bool_)
    for place in range(len(offsets)):
        for k in range(n):
            for s in range(count):
                if inside[k, s]:
                    value = offsets[place]
                    for j in range(p):
                        value += normals[place, j] * points[regions[k], s, j]
                    if value < -depth:
                        low[place, k] = True
                    elif value > depth:
                        high[place, k] = True
                    if low[place, k] and high[place, k]:
                        break
    return low, high


@compiled
def _cost(own: Any, below: Any, above: Any, stamp: Any) -> Any:
    """Groups on the fuller side, then groups on both, then polyhedra on both, in one number."""
    first, second = _groups_on(own, below, stamp), _groups_on(own, above, stamp)
    size = 2 * len(own) + 1
    return (max(first, second) * size + first + second) * size + below.sum() + above.sum()


@compiled
def _groups_on(own: Any, flags: Any, stamp: Any) -> int:
    """Number of different groups of the polyhedra that are marked; the stamps are all zero before and after."""
    count = 0
    for k in range(len(own)):
        if flags[k] and stamp[own[k]] == 0:
            stamp[own[k]] = 1
            count += 1
    for k in range(len(own)):
        stamp[own[k]] = 0
    return count


@compiled
def _decide(
    A: Any, b: Any, starts: Any, centres: Any, regions: Any, N: Any, h: Any, normal: Any, offset: float, depth: float,
    low: Any, high: Any, violation: float, angle: float,
) -> int:  # fmt: skip
    """Complete the sides in place; a polyhedron that has none is too thin to matter, and gets that of its point."""
    p, path, longest, work = A.shape[1], len(h), 0, 0
    for i in regions:
        longest = max(longest, starts[i + 1] - starts[i])
    rows, sides = np.empty((path + 1 + longest, p)), np.empty(path + 1 + longest)
    x, space = np.empty(p), workspace(p)
    rows[:path], sides[:path] = N, h
    for k in range(len(regions)):
        if low[k] and high[k]:
            continue
        i = regions[k]
        size = path + 1 + starts[i + 1] - starts[i]
        rows[path + 1 : size], sides[path + 1 : size] = A[starts[i] : starts[i + 1]], b[starts[i] : starts[i + 1]]
        for sign in (-1.0, 1.0):
            if (low[k] and sign < 0) or (high[k] and sign > 0):
                continue
            for j in range(p):
                rows[path, j] = -sign * normal[j]
            sides[path] = sign * offset - depth
            x[:] = centres[i]
            status, _ = nearest_in(rows, sides, size, 0.0, x, space, violation, angle)
            work += 1
            if sign < 0:
                low[k] = status != NONE
            else:
                high[k] = status != NONE
        if not (low[k] or high[k]):
            value = offset + np.dot(normal, centres[i])
            low[k], high[k] = value <= 0, value > 0
    return work
