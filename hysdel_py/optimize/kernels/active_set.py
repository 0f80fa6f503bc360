"""Strictly convex quadratic programs by the dual active-set method, with dense matrices.

``minimise 1/2 v'H v + f'v  subject to  N v >= b``

Source: D. Goldfarb and A. Idnani, "A numerically stable dual method for solving strictly convex quadratic programs",
Mathematical Programming 27, 1983; the factors are those of M. J. D. Powell, "ZQPCVX, a FORTRAN subroutine for convex
quadratic programming", 1983: ``J'H J = I`` and ``J'N_A = [R; 0]`` for the active rows A.

Every iterate minimises over its active rows, so the dual objective only grows, and the method may stop as soon as it
has passed a value that is not worth beating. It starts from any set of rows: those with a negative multiplier are let
go first.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.optimize.compiled import compiled

__all__ = ["BEATEN", "EMPTY", "LIMIT", "SOLVED", "inverse_factor", "solve", "start_from"]

SOLVED, EMPTY, BEATEN, LIMIT = 0, 1, 2, 3

DEPENDENT = 1e-10
"""A normal whose part outside the active ones is shorter than this, relative to its own length, depends on them."""


@compiled
def inverse_factor(H):
    """The transposed inverse of the Cholesky factor; the flag tells whether H is positive definite."""
    n = len(H)
    L = np.zeros((n, n))
    for j in range(n):
        total = H[j, j]
        for k in range(j):
            total -= L[j, k] * L[j, k]
        if total <= 0.0:
            return L, False
        root = np.sqrt(total)
        L[j, j] = root
        for i in range(j + 1, n):
            total = H[i, j]
            for k in range(j):
                total -= L[i, k] * L[j, k]
            L[i, j] = total / root
    J = np.zeros((n, n))
    for column in range(n):  # column of the inverse of L, which is a row of J transposed
        J[column, column] = 1.0 / L[column, column]
        for i in range(column + 1, n):
            total = 0.0
            for k in range(column, i):
                total -= L[i, k] * J[column, k]
            J[column, i] = total / L[i, i]
    return J, True


@compiled
def solve(N, b, f, work, cutoff, settings):
    """Run from the active set of the work space.

    Parameters
    ----------
    N : array of shape (m, n)
        Rows of unit length.
    b : array of shape (m,)
    f : array of shape (n,)
    work : (J, R, active, u, count, v)
        Factors, rows of the active set in the order of the columns of R, their multipliers, an array with their
        number as its only entry, and the point; changed in place.
    cutoff : float
        Value of ``1/2 v'H v + f'v`` that is not worth beating.
    settings : (tolerance, iterations)

    Returns
    -------
    status, iterations, row
        `row` is the one that cannot be satisfied, if the problem is empty; the multipliers of the ray are then 1 for
        it and those in the work space for the active rows.
    """
    v = work[5]
    minimise_over_active(b, f, work)
    iterations = 0
    while True:
        row = most_violated(N, b, v, settings[0])
        if row < 0:
            return SOLVED, iterations, -1
        if dual_value(v, f, b, work) >= cutoff:
            return BEATEN, iterations, -1
        paid = 0.0
        while True:
            iterations += 1
            if iterations > settings[1]:
                return LIMIT, iterations, -1
            d, z, r = directions(N[row], work)
            curvature = square(d, work[4][0])
            partial, leaving = longest_dual_step(r, work)
            full = np.inf
            if curvature > DEPENDENT * DEPENDENT * square(d, 0):
                full = (b[row] - dot(N[row], v)) / curvature
            step = min(partial, full)
            if step == np.inf:
                for i in range(work[4][0]):
                    work[3][i] = -r[i]
                return EMPTY, iterations, row
            for i in range(work[4][0]):
                work[3][i] -= step * r[i]
            paid += step
            if full < np.inf:
                for i in range(len(v)):
                    v[i] += step * z[i]
            if full <= partial:
                add(row, paid, d, work)
                break
            drop(leaving, work)


@compiled
def dot(a, b):
    """Inner product."""
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total


@compiled
def square(d, first):
    """Squared length of the entries from `first` on."""
    total = 0.0
    for i in range(first, len(d)):
        total += d[i] * d[i]
    return total


@compiled
def most_violated(N, b, v, tolerance):
    """Row that is missed by most, -1 if all hold."""
    worst, at = tolerance, -1
    for row in range(len(b)):
        missing = b[row] - dot(N[row], v)
        if missing > worst * (1.0 + abs(b[row])):
            worst, at = missing / (1.0 + abs(b[row])), row
    return at


@compiled
def dual_value(v, f, b, work):
    """Value at the minimiser over the active rows: half of f'v plus half of u'b."""
    total = dot(f, v)
    for i in range(work[4][0]):
        total += work[3][i] * b[work[2][i]]
    return 0.5 * total


@compiled
def directions(normal, work):
    """``d = J'normal``, the primal direction ``J2 d2`` and the dual one ``R^-1 d1``."""
    J, R, count = work[0], work[1], work[4][0]
    n = len(normal)
    d = np.zeros(n)
    for i in range(n):
        a = normal[i]
        if a != 0.0:
            for j in range(n):
                d[j] += J[i, j] * a
    z = np.zeros(n)
    for i in range(n):
        total = 0.0
        for j in range(count, n):
            total += J[i, j] * d[j]
        z[i] = total
    r = np.zeros(n)
    for i in range(count - 1, -1, -1):
        total = d[i]
        for k in range(i + 1, count):
            total -= R[i, k] * r[k]
        r[i] = total / R[i, i]
    return d, z, r


@compiled
def longest_dual_step(r, work):
    """Step at which the first multiplier becomes zero, and its place."""
    step, leaving = np.inf, -1
    for i in range(work[4][0]):
        if r[i] > 0.0 and work[3][i] < step * r[i]:
            step, leaving = work[3][i] / r[i], i
    return max(step, 0.0), leaving


@compiled
def add(row, multiplier, d, work):
    """Put a row into the active set; `d` is J times its normal."""
    J, R, count = work[0], work[1], work[4][0]
    n = len(d)
    for j in range(n - 1, count, -1):
        if d[j] != 0.0:
            rotate(J, d, j)
    for i in range(count + 1):
        R[i, count] = d[i]
    work[2][count] = row
    work[3][count] = multiplier
    work[4][0] = count + 1


@compiled
def rotate(J, d, j):
    """Turn columns j-1 and j of J so that entry j of d vanishes."""
    length = np.hypot(d[j - 1], d[j])
    c, s = d[j - 1] / length, d[j] / length
    d[j - 1], d[j] = length, 0.0
    for i in range(len(J)):
        first, second = J[i, j - 1], J[i, j]
        J[i, j - 1] = c * first + s * second
        J[i, j] = c * second - s * first


@compiled
def drop(place, work):
    """Take a row out of the active set."""
    J, R, active, u, count = work[0], work[1], work[2], work[3], work[4][0]
    for k in range(place, count - 1):
        active[k], u[k] = active[k + 1], u[k + 1]
        for i in range(k + 2):
            R[i, k] = R[i, k + 1]
    for k in range(place, count - 1):
        length = np.hypot(R[k, k], R[k + 1, k])
        c, s = R[k, k] / length, R[k + 1, k] / length
        R[k, k], R[k + 1, k] = length, 0.0
        for j in range(k + 1, count - 1):
            first, second = R[k, j], R[k + 1, j]
            R[k, j] = c * first + s * second
            R[k + 1, j] = c * second - s * first
        for i in range(len(J)):
            first, second = J[i, k], J[i, k + 1]
            J[i, k] = c * first + s * second
            J[i, k + 1] = c * second - s * first
    work[4][0] = count - 1


@compiled
def minimise_over_active(b, f, work):
    """Point and multipliers of the active rows taken as equations; rows with negative multipliers are let go."""
    while True:
        point_of_active(b, f, work)
        least, place = 0.0, -1
        for i in range(work[4][0]):
            if work[3][i] < least:
                least, place = work[3][i], i
        if place < 0:
            return
        drop(place, work)


@compiled
def point_of_active(b, f, work):
    """With w = J^-1 v: ``R'w1 = b_A``, ``w2 = -J2'f``, ``R u = w1 + J1'f``."""
    J, R, active, u, count, v = work[0], work[1], work[2], work[3], work[4][0], work[5]
    n = len(v)
    g = np.zeros(n)
    for i in range(n):
        for j in range(n):
            g[j] += J[i, j] * f[i]
    w = -g
    for i in range(count):
        total = b[active[i]]
        for k in range(i):
            total -= R[k, i] * w[k]
        w[i] = total / R[i, i]
    for i in range(count - 1, -1, -1):
        total = w[i] + g[i]
        for k in range(i + 1, count):
            total -= R[i, k] * u[k]
        u[i] = total / R[i, i]
    for i in range(n):
        v[i] = dot(J[i], w)


@compiled
def start_from(rows, N, work):
    """Build the factors of a wished active set; rows that depend on those before are left out."""
    for row in rows:
        if work[4][0] >= len(work[5]):
            return
        d, _, _ = directions(N[row], work)
        if square(d, work[4][0]) > 1e-12 * square(d, 0):
            add(row, 0.0, d, work)
