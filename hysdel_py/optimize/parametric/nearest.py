"""Nearest point of a polyhedron: ``min 1/2 |x - c|^2  subject to  N x <= h``.

Dual active set method of D. Goldfarb and A. Idnani ("A numerically stable dual method for solving strictly convex
quadratic programs", Mathematical Programming 27, 1983) for a Hessian that is the identity. A kernel.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.optimize.compiled import compiled
from hysdel_py.optimize.parametric.factor import append, remove

__all__ = ["FOUND", "LOST", "NONE", "nearest"]

_NOTHING = 1e-14
"""A multiplier that falls more slowly never limits a step."""

FOUND, NONE, LOST = 0, 1, 2
"""Answers: a point; there is none (with multipliers that prove it); too many steps."""


@compiled
def nearest(N: Any, h: Any, centre: Any, violation: float, angle: float) -> Any:
    """Point of ``{x : N x <= h}`` nearest to the centre.

    Parameters
    ----------
    N : array of shape (m, n), C-contiguous
        Rows of length one.
    h : array of shape (m,)
    centre : array of shape (n,)
    violation, angle : float
        A row holds if it is exceeded by less than `violation`; a normal whose part orthogonal to the active ones is
        shorter than `angle` depends on them.

    Returns
    -------
    status : int
        FOUND, NONE or LOST.
    x : array of shape (n,)
    active : int array of shape (k,)
        Rows that hold with equality, of independent normals.
    multipliers : array of shape (k,)
        Positive. After NONE the last active row is one that cannot be met, its multiplier is 1, and the combination of
        the active rows by the multipliers reads ``0 <= something negative``.
    """
    m, n = N.shape
    x = centre.copy()
    Qt, R = np.eye(n), np.zeros((n, n))
    active, u = np.zeros(n + 1, dtype=np.int64), np.zeros(n + 1)
    k = 0
    for _ in range(20 * (m + n) + 50):
        excess = np.dot(N, x) - h
        entering = int(excess.argmax()) if m else 0
        if m == 0 or excess[entering] <= violation:
            return FOUND, x, active[:k].copy(), u[:k].copy()
        u[k], active[k] = 0.0, entering
        while True:
            d = np.dot(Qt, N[entering])
            r = d[:k].copy()
            for i in range(k - 1, -1, -1):
                r[i] = (r[i] - np.dot(R[i, i + 1 : k], r[i + 1 :])) / R[i, i]
            rest = np.dot(d[k:], d[k:])
            step, leaving = np.inf, -1
            for i in range(k):
                if r[i] > _NOTHING and u[i] < step * r[i]:
                    step, leaving = u[i] / r[i], i
            full = np.inf
            if k < n and np.sqrt(rest) > angle:
                full = (np.dot(N[entering], x) - h[entering]) / rest
            if step == np.inf and full == np.inf:
                u[:k] = np.maximum(-r, 0.0)
                u[k] = 1.0
                return NONE, x, active[: k + 1].copy(), u[: k + 1].copy()
            length = min(step, full)
            u[:k] -= length * r
            u[k] += length
            if full < np.inf:
                x -= length * np.dot(d[k:], Qt[k:])
            if full <= step:
                append(Qt, R, k, d)
                k += 1
                break
            remove(Qt, R, k, leaving)
            for i in range(leaving, k):
                active[i], u[i] = active[i + 1], u[i + 1]
            k -= 1
    return LOST, x, active[:k].copy(), u[:k].copy()
