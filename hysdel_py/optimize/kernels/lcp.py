"""Inner loops of the methods for linear complementarity problems.

Lemke's method follows R. W. Cottle, J.-S. Pang and R. E. Stone, "The Linear Complementarity Problem", 1992, section
4.4, with the lexicographic rule that excludes cycles.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled

__all__ = ["LIMIT", "RAY", "SOLVED", "equilibrate", "lemke", "sweeps"]

SOLVED, RAY, LIMIT = 0, 1, 2


@compiled
def equilibrate(M, rounds):
    """Positive scale d with which the largest entry of each row and column of ``d M d`` tends to 1."""
    n = len(M)
    d = np.ones(n)
    largest = np.zeros(n)
    for _ in range(rounds):
        largest[:] = 0.0
        for i in range(n):
            for j in range(n):
                size = abs(M[i, j]) * d[i] * d[j]
                largest[i] = max(largest[i], size)
                largest[j] = max(largest[j], size)
        for i in range(n):
            if largest[i] > 0.0:
                d[i] /= np.sqrt(largest[i])
    return d


@compiled
def lemke(M, q, limit, small):
    """Follow Lemke's path from the vertex ``z = 0``.

    Columns of the tableau: 0 to n-1 are w, n to 2n-1 are z, 2n is the covering variable, 2n+1 is the right-hand side.
    The columns of w hold the inverse of the basis, whose rows break ties.

    Returns
    -------
    outcome : int
    pivots : int
    basis : array of int64, shape (n,)
        Column that is basic in each row.
    T : array of shape (n, 2 n + 2)
        Last tableau.
    entering : int
        Column that could not enter, where the outcome is a ray.
    """
    n = len(q)
    T = np.zeros((n, 2 * n + 2))
    basis = np.arange(n)
    for i in range(n):
        T[i, i] = 1.0
        for j in range(n):
            T[i, n + j] = -M[i, j]
        T[i, 2 * n] = -1.0
        T[i, 2 * n + 1] = q[i]
    row = _most_negative(T, n)
    if row < 0:
        return SOLVED, 0, basis, T, -1
    entering = 2 * n
    for count in range(1, limit + 1):
        leaving = basis[row]
        _pivot(T, row, entering)
        basis[row] = entering
        if leaving == 2 * n:
            return SOLVED, count, basis, T, -1
        entering = leaving + n if leaving < n else leaving - n
        row = _blocking_row(T, basis, entering, small)
        if row < 0:
            return RAY, count, basis, T, entering
    return LIMIT, limit, basis, T, entering


@compiled
def _most_negative(T, n):
    """The lexicographically least row of (q, I) if its first entry is negative, else -1."""
    row = -1
    for i in range(n):
        value = T[i, 2 * n + 1]
        if value < 0.0 and (row < 0 or value <= T[row, 2 * n + 1]):
            row = i  # of equal entries the last: its unit vector is the least
    return row


@compiled
def _blocking_row(T, basis, entering, small):
    """Row that keeps the right-hand side lexicographically positive when a column enters; -1 on a ray.

    The covering variable leaves as soon as it may: that ends the path.
    """
    n = len(T)
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(T[i, entering]))
    least = small * max(1.0, largest)
    row = -1
    for i in range(n):
        if T[i, entering] <= least:
            continue
        if row < 0 or _comes_before(T, i, row, entering, small):
            row = i
    if row < 0:
        return -1
    best = T[row, 2 * n + 1] / T[row, entering]
    for i in range(n):
        if basis[i] == 2 * n and T[i, entering] > least and T[i, 2 * n + 1] / T[i, entering] <= best + small:
            return i
    return row


@compiled
def _comes_before(T, i, row, entering, small):
    n = len(T)
    for k in range(-1, n):
        column = 2 * n + 1 if k < 0 else k
        first, second = T[i, column] / T[i, entering], T[row, column] / T[row, entering]
        if abs(first - second) > small * max(1.0, abs(first), abs(second)):
            return first < second
    return False


@compiled
def _pivot(T, row, column):
    m, width = T.shape
    divisor = T[row, column]
    for j in range(width):
        T[row, j] /= divisor
    for i in range(m):
        factor = T[i, column]
        if i == row or factor == 0.0:
            continue
        for j in range(width):
            T[i, j] -= factor * T[row, j]
        T[i, column] = 0.0


@compiled
def sweeps(start, entries, values, diagonal, q, bounds, z, limit, tolerance):
    """Projected Gauss-Seidel sweeps over a matrix in compressed rows; z is overwritten.

    Returns
    -------
    outcome, sweeps : int
    """
    lo, hi = bounds
    n = len(q)
    for count in range(1, limit + 1):
        worst = 0.0
        for i in range(n):
            w = q[i]
            for k in range(start[i], start[i + 1]):
                w += values[k] * z[entries[k]]
            moved = abs(min(max(z[i] - w, lo[i]), hi[i]) - z[i])
            if not moved <= worst:  # true also for what is not a number
                worst = moved
            z[i] = min(max(z[i] - w / diagonal[i], lo[i]), hi[i])
        if worst <= tolerance:
            return SOLVED, count
        if not np.isfinite(worst):
            return LIMIT, count
    return LIMIT, limit
