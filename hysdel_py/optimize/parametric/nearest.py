"""Nearest point of a polyhedron: ``min 1/2 |x - c|^2  subject to  N x <= h``.

Dual active set method of D. Goldfarb and A. Idnani ("A numerically stable dual method for solving strictly convex
quadratic programs", Mathematical Programming 27, 1983) for a Hessian that is the identity. Kernels.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.factor import append, remove
from hysdel_py.optimize.parametric.vectors import back_substituted, move, turned, worst_row

__all__ = ["FOUND", "LOST", "NONE", "nearest", "nearest_in", "workspace"]

_NOTHING = 1e-14
"""A multiplier that falls more slowly never limits a step."""

FOUND, NONE, LOST = 0, 1, 2
"""Answers: a point; there is none (with multipliers that prove it); too many steps."""


@compiled
def workspace(n: int) -> Any:
    """Arrays for problems with n variables: Qt, R, active, multipliers, and two vectors."""
    return (
        np.empty((n, n)), np.zeros((n, n)), np.zeros(n + 1, dtype=np.int64), np.zeros(n + 1), np.empty(n + 1),
        np.empty(n + 1),
    )  # fmt: skip


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
    work, x = workspace(len(centre)), centre.copy()
    status, k = nearest_in(N, h, len(h), 0.0, x, work, violation, angle)
    return status, x, work[2][:k].copy(), work[3][:k].copy()


@compiled
def nearest_in(N: Any, h: Any, m: int, margin: float, x: Any, work: Any, violation: float, angle: float) -> Any:
    """The same among the first m rows, with sides ``h - margin``, in place.

    Parameters
    ----------
    x : array of shape (n,)
        The centre before, the point after.
    work : tuple
        See :func:`workspace`; holds factor, active rows and multipliers afterwards.

    Returns
    -------
    status, k : int
        `k` is the number of active rows.
    """
    Qt, R, active, u, d, r = work
    n = len(x)
    k: Any = np.int64(0)  # not a literal: kernels would be compiled for each
    Qt[:] = 0.0
    for i in range(n):
        Qt[i, i] = 1.0
    for _ in range(20 * (m + n) + 50):
        entering, excess = worst_row(N, h, m, x)
        excess += margin
        if excess <= violation:
            return FOUND, k
        u[k], active[k] = 0.0, entering
        while True:
            rest = turned(Qt, N[entering], k, d)
            back_substituted(R, d, k, r)
            step, leaving = _longest_dual_step(u, r, k)
            full = np.inf
            if k < n and rest > angle * angle:
                full = excess / rest
            if step == np.inf and full == np.inf:
                for i in range(k):
                    u[i] = max(-r[i], 0.0)
                u[k] = 1.0
                return NONE, k + 1
            length = min(step, full)
            for i in range(k):
                u[i] -= length * r[i]
            u[k] += length
            if full < np.inf:
                move(x, Qt, d, k, length)
                excess -= length * rest
            if full <= step:
                append(Qt, R, k, d)
                k += 1
                break
            remove(Qt, R, k, leaving)
            for i in range(leaving, k):
                active[i], u[i] = active[i + 1], u[i + 1]
            k -= 1
    return LOST, k


@compiled
def _longest_dual_step(u: Any, r: Any, k: int) -> Any:
    """How far the multipliers may go along -r, and the place that becomes zero then."""
    step, leaving = np.inf, k
    for i in range(k):
        if r[i] > _NOTHING and u[i] < step * r[i]:
            step, leaving = u[i] / r[i], i
    return step, leaving
