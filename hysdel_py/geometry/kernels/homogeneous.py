"""A polyhedron as a cone in round coordinates, and its vertices and rays from those of the cone.

With a point p inside, sizes s of the coordinates and ``w = p + s v / t`` the polyhedron ``A w <= b`` is the part
``t = 1`` of ``{(t, v) : (b - A p) t - A s v >= 0, t >= 0}``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import leaf

__all__ = ["dual", "generated", "homogeneous", "sort"]

_ROUNDS = 2
_ALONG = 1e-9
"""A row of unit length with less than this of a coordinate is no end of it."""
_NOISE = 1e-15
"""What sums of a few terms are off by, relative to the sizes of the terms."""
_AT_INFINITY = 1e-10
"""A ray of the cone whose t is below this, of unit length, is a ray of the polyhedron."""
_LEAST_ROOM = 1e-10
"""Room at the point, relative to the size of the set, that the signs of the double description method can tell."""
_SWEEPS = 2


@leaf
def _middle(A: Any, margin: Any, point: Any, j: int, least: float, size: float) -> float:
    """Move a point to the middle of the set along a coordinate, or near its only end, by a size that is given.

    Returns the size of the set there, the given one if it has none.
    """
    up = down = np.inf
    for i in range(len(A)):
        if abs(A[i, j]) <= _ALONG:
            continue
        if A[i, j] > 0.0:
            up = min(up, max(margin[i], 0.0) / A[i, j])
        else:
            down = min(down, max(margin[i], 0.0) / -A[i, j])
    if up < np.inf and down < np.inf:
        move, half = (up - down) / 2.0, (up + down) / 2.0
    elif up < np.inf:
        move, half = max(up - size, 0.0), min(up, size)
    elif down < np.inf:
        move, half = -max(down - size, 0.0), min(down, size)
    else:
        return size
    point[j] += move
    for i in range(len(A)):
        margin[i] -= A[i, j] * move
    return half if half > least else size


@leaf
def homogeneous(A: Any, b: Any, least: float, point: Any, scale: Any, margin: Any, H: Any) -> bool:
    """Fill in the rows of the cone, of unit length; whether each row clearly leaves room at the point or clearly none.

    Parameters
    ----------
    A, b : arrays of shapes (m, n) and (m,)
        Rows of about unit length.
    least : float
        Room that counts, of a row of unit length.
    point : array of shape (n,)
        Of the polyhedron; it moves to the middle.
    scale : array of shape (n,)
        About the sizes of the coordinates, which are filled in where the set has a middle.
    margin, H : arrays of shapes (m,) and (m + 1, n + 1)
        Filled in.
    """
    m, n = A.shape
    for i in range(m):
        margin[i] = b[i]
        for j in range(n):
            margin[i] -= A[i, j] * point[j]
    for _ in range(_ROUNDS):
        for j in range(n):
            scale[j] = _middle(A, margin, point, j, least, scale[j])
    H[m, 0] = 1.0
    for i in range(m):
        noise, length, total = _NOISE * abs(b[i]), 0.0, 0.0
        margin[i] = b[i]
        for j in range(n):
            margin[i] -= A[i, j] * point[j]
            noise += _NOISE * abs(A[i, j] * point[j])
            length += A[i, j] * A[i, j]
        if length == 0.0 or b[i] == np.inf:
            H[i, 0] = 1.0
            for j in range(n):
                H[i, j + 1] = 0.0
            continue
        if abs(margin[i]) <= noise:
            margin[i] = 0.0
        elif margin[i] <= least * np.sqrt(length):
            return False
        total = margin[i] * margin[i]
        for j in range(n):
            total += A[i, j] * scale[j] * A[i, j] * scale[j]
        total = np.sqrt(total)
        if 0.0 < margin[i] < _LEAST_ROOM * total:
            return False
        H[i, 0] = margin[i] / total
        for j in range(n):
            H[i, j + 1] = -A[i, j] * scale[j] / total
    for j in range(n):
        H[m, j + 1] = 0.0
    return True


@leaf
def _digits(value: float, size: float) -> float:
    return float(np.rint(value / size * 1e9))


@leaf
def sort(rows: Any, scale: Any, order: Any) -> None:
    """Fill in the order of rows, by nine digits of their entries in coordinates of given sizes; equal ones stay."""
    for k in range(len(rows)):
        place = k
        while place > 0:
            before = order[place - 1]
            j = 0
            while j < rows.shape[1] - 1 and _digits(rows[k, j], scale[j]) == _digits(rows[before, j], scale[j]):
                j += 1
            if not _digits(rows[k, j], scale[j]) < _digits(rows[before, j], scale[j]):
                break
            order[place] = before
            place -= 1
        order[place] = k


@leaf
def dual(points: Any, rays: Any, lines: Any, least: float, middle: Any, sizes: Any, H: Any) -> None:
    """Fill in the rows ``(1, -(p - middle) / sizes)`` of points, ``(0, -r / sizes)`` of rays and lines, of unit length.

    The sizes of the coordinates are those of the points; where they are flat, that of the largest, or 1.

    Parameters
    ----------
    points, rays, lines : arrays of shapes (p, n), (r, n) and (l, n)
    least : float
        A size that counts.
    middle, sizes, H : arrays of shapes (n,), (n,) and (p + r + 2 l, n + 1)
        Filled in.
    """
    p, n = points.shape
    whole = noise = 0.0
    for j in range(n):
        middle[j] = sizes[j] = 0.0
        for i in range(p):
            middle[j] += points[i, j] / p
            noise = max(noise, 4e-16 * abs(points[i, j]))
        for i in range(p):
            sizes[j] = max(sizes[j], abs(points[i, j] - middle[j]))
        whole = max(whole, sizes[j])
    for j in range(n):
        if whole <= noise:
            sizes[j] = 1.0
        elif sizes[j] <= max(least, noise):
            sizes[j] = whole
    for i in range(len(H)):
        total = H[i, 0] = 1.0 if i < p else 0.0
        for j in range(n):
            if i < p:
                H[i, j + 1] = (middle[j] - points[i, j]) / sizes[j]
            elif i < p + len(rays):
                H[i, j + 1] = -rays[i - p, j] / sizes[j]
            elif i < p + len(rays) + len(lines):
                H[i, j + 1] = -lines[i - p - len(rays), j] / sizes[j]
            else:
                H[i, j + 1] = lines[i - p - len(rays) - len(lines), j] / sizes[j]
            total += H[i, j + 1] * H[i, j + 1]
        for j in range(n + 1):
            H[i, j] /= max(np.sqrt(total), 1e-300)


@leaf
def _polished(A: Any, b: Any, active: Any, k: int, found: Any) -> float:
    """Move a vertex onto the rows that meet there, one after the other: what is left are errors of rounding.

    Returns by how much the rows are missed at the end, relative to 1 and their sides.
    """
    worst = 0.0
    for sweep in range(_SWEEPS + 1):
        for i in range(len(A)):
            is_active = (active[k, i >> 6] >> np.uint64(i & 63)) & np.uint64(1) == np.uint64(1)
            if b[i] == np.inf or (sweep < _SWEEPS and not is_active):
                continue
            left, length = b[i], 0.0
            for j in range(A.shape[1]):
                left -= A[i, j] * found[k, j]
                length += A[i, j] * A[i, j]
            if sweep == _SWEEPS:
                miss = abs(left) if is_active else max(-left, 0.0)
                worst = max(worst, miss / max(np.sqrt(length), abs(b[i])) if miss > 0.0 else 0.0)
            elif length > 0.0 and left != 0.0:
                for j in range(A.shape[1]):
                    found[k, j] += left / length * A[i, j]
    return worst


@leaf
def generated(
    A: Any, b: Any, point: Any, scale: Any, rays: Any, bits: Any, count: int, miss: float, found: Any, is_ray: Any
) -> int:
    """Vertices and rays of the polyhedron from the rays of its cone; how many of them are vertices.

    It is -1 if a vertex misses a row by more than a share of 1, for a row of unit length, or of its side.
    """
    n, vertices = A.shape[1], 0
    for k in range(count):
        is_ray[k] = rays[k, 0] <= _AT_INFINITY
        if is_ray[k]:
            total = 0.0
            for j in range(n):
                found[k, j] = rays[k, j + 1] * scale[j]
                total += found[k, j] * found[k, j]
            for j in range(n):
                found[k, j] /= np.sqrt(total)
            continue
        vertices += 1
        for j in range(n):
            found[k, j] = point[j] + rays[k, j + 1] / rays[k, 0] * scale[j]
        if not _polished(A, b, bits, k, found) <= miss:
            return -1
    return vertices
