"""A polyhedron as a cone in round coordinates, and its vertices and rays from those of the cone.

With a point p inside, sizes s of the coordinates and ``w = p + s v / t`` the polyhedron ``A w <= b`` is the part
``t = 1`` of ``{(t, v) : (b - A p) t - A s v >= 0, t >= 0}``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import leaf, step

__all__ = ["generated", "homogeneous"]

_ROUNDS = 2
_NOISE = 1e-15
"""What sums of a few terms are off by, relative to the sizes of the terms."""
_AT_INFINITY = 1e-10
"""A ray of the cone whose t is below this, of unit length, is a ray of the polyhedron."""
_SWEEPS = 2


@step
def _middle(A: Any, margin: Any, point: Any, j: int, least: float) -> float:
    """Move a point to the middle of the set along a coordinate, or to a distance of 1 from its only end.

    Returns the size of the set there, 1 if it has none.
    """
    up = down = np.inf
    for i in range(len(A)):
        if A[i, j] > 0.0:
            up = min(up, max(margin[i], 0.0) / A[i, j])
        elif A[i, j] < 0.0:
            down = min(down, max(margin[i], 0.0) / -A[i, j])
    if up < np.inf and down < np.inf:
        move, size = (up - down) / 2.0, (up + down) / 2.0
    elif up < np.inf:
        move, size = max(up - 1.0, 0.0), min(up, 1.0)
    elif down < np.inf:
        move, size = -max(down - 1.0, 0.0), min(down, 1.0)
    else:
        return 1.0
    point[j] += move
    for i in range(len(A)):
        margin[i] -= A[i, j] * move
    return size if size > least else 1.0


@leaf
def homogeneous(A: Any, b: Any, least: float, point: Any, scale: Any, margin: Any, H: Any) -> bool:
    """Fill in the rows of the cone, of unit length; whether each row clearly leaves room at the point or clearly none.

    Parameters
    ----------
    A, b : arrays of shapes (m, n) and (m,)
    least : float
        Room that counts, of a row of unit length.
    point : array of shape (n,)
        Of the polyhedron; it moves to the middle.
    scale, margin, H : arrays of shapes (n,), (m,) and (m + 1, n + 1)
        Filled in.
    """
    m, n = A.shape
    for i in range(m):
        margin[i] = b[i]
        for j in range(n):
            margin[i] -= A[i, j] * point[j]
    for _ in range(_ROUNDS):
        for j in range(n):
            scale[j] = _middle(A, margin, point, j, least)
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
        H[i, 0] = margin[i] / total
        for j in range(n):
            H[i, j + 1] = -A[i, j] * scale[j] / total
    for j in range(n):
        H[m, j + 1] = 0.0
    return True


@step
def _polished(A: Any, b: Any, active: Any, k: int, found: Any) -> None:
    """Move a vertex onto the rows that meet there, one after the other: what is left are errors of rounding."""
    for _ in range(_SWEEPS):
        for i in range(len(A)):
            if not (active[k, i >> 6] >> np.uint64(i & 63)) & np.uint64(1):
                continue
            left, length = b[i], 0.0
            for j in range(A.shape[1]):
                left -= A[i, j] * found[k, j]
                length += A[i, j] * A[i, j]
            if length > 0.0 and left != 0.0:
                for j in range(A.shape[1]):
                    found[k, j] += left / length * A[i, j]


@leaf
def generated(A: Any, b: Any, point: Any, scale: Any, rays: Any, bits: Any, count: int, found: Any, is_ray: Any) -> int:
    """Vertices and rays of the polyhedron from the rays of its cone; how many of them are vertices."""
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
        _polished(A, b, bits, k, found)
    return vertices
