"""Strictly convex quadratic programs by the dual active-set method, with dense matrices.

``minimise 1/2 v'H v + f'v  subject to  N v >= b``

Source: D. Goldfarb and A. Idnani, "A numerically stable dual method for solving strictly convex quadratic programs",
Mathematical Programming 27, 1983; the factors are those of M. J. D. Powell, "ZQPCVX, a FORTRAN subroutine for convex
quadratic programming", 1983: ``J'H J = I`` and ``J'N_A = [R; 0]`` for the active rows A. What is kept is the transpose
of J, whose rows are what every step runs along.

Every iterate minimises over its active rows, so the dual objective only grows, and the method may stop as soon as it
has passed a value that is not worth beating. It starts from any set of rows: those with a negative multiplier are let
go first.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels.linear import add_multiple, dot, square

__all__ = ["BEATEN", "EMPTY", "LIMIT", "SOLVED", "inverse_factor", "nonzeros", "solve", "start_from", "work_space"]

SOLVED, EMPTY, BEATEN, LIMIT = 0, 1, 2, 3

DEPENDENT = 1e-10
"""A normal whose part outside the active ones is shorter than this, relative to its own length, depends on them."""
SLIGHT = 1e-8
"""A dependent row that is missed by no more than this, relative to its side, is missed by rounding."""


@compiled
def inverse_factor(H):
    """The inverse of the Cholesky factor L; the flag tells whether H is positive definite."""
    n = len(H)
    L = np.zeros((n, n))
    inverse = np.zeros((n, n))
    for i in range(n):
        for j in range(i):
            L[i, j] = (H[i, j] - dot(L[i, :j], L[j, :j])) / L[j, j]
        total = H[i, i] - square(L[i, :i], 0)
        if total <= 0.0:
            return inverse, False
        root = np.sqrt(total)
        L[i, i] = root
        for k in range(i):
            if L[i, k] != 0.0:
                add_multiple(inverse[i], -L[i, k], inverse[k, : k + 1])
        for j in range(i):
            inverse[i, j] /= root
        inverse[i, i] = 1.0 / root
    return inverse, True


@compiled
def work_space(J):
    """Empty active set over a factor: (transposed J, R, active, u, count, v)."""
    n = len(J)
    return J, np.zeros((n, n)), np.zeros(n, dtype=np.int64), np.zeros(n), np.zeros(1, dtype=np.int64), np.zeros(n)


@compiled
def nonzeros(N):
    """Rows in compressed form: where each starts, columns and values. Most rows of a node have a few entries only."""
    start = np.zeros(len(N) + 1, dtype=np.int64)
    for row in range(len(N)):
        start[row + 1] = start[row]
        for a in N[row]:
            if a != 0.0:
                start[row + 1] += 1
    column, value = np.empty(start[-1], dtype=np.int64), np.empty(start[-1])
    at = 0
    for row in range(len(N)):
        for j in range(N.shape[1]):
            if N[row, j] != 0.0:
                column[at], value[at] = j, N[row, j]
                at += 1
    return start, column, value


@compiled
def solve(rows, b, f, work, cutoff, settings):
    """Run from the active set of the work space.

    Parameters
    ----------
    rows : (start, column, value)
        Rows of unit length, compressed; see :func:`nonzeros`.
    b : array of shape (m,)
    f : array of shape (n,)
    work : (J, R, active, u, count, v)
        Factors, rows of the active set in the order of the columns of R, their multipliers, an array with their
        number as its only entry, and the point; changed in place. See :func:`work_space`.
    cutoff : float
        Value of ``1/2 v'H v + f'v`` that is not worth beating.
    settings : (tolerance, iterations)

    Returns
    -------
    status, iterations, row
        `row` is the one that cannot be satisfied, if the problem is empty; the multipliers of the ray are then 1 for
        it and those in the work space for the active rows.
    """
    v, multipliers = work[5], work[3]
    d, z, r = np.zeros(len(v)), np.zeros(len(v)), np.zeros(len(v))
    minimise_over_active(b, f, work)
    iterations = 0
    while True:
        row = most_violated(rows, b, v, settings[0])
        if row < 0:
            return SOLVED, iterations, -1
        if dual_value(v, f, b, work) >= cutoff:
            return BEATEN, iterations, -1
        paid = 0.0
        while True:
            iterations += 1
            if iterations > settings[1]:
                return LIMIT, iterations, -1
            directions(row, rows, work, d, z, r)
            curvature = square(d, work[4][0])
            partial, leaving = longest_dual_step(r, work)
            full = np.inf
            if curvature > DEPENDENT * DEPENDENT * square(d, 0):
                full = (b[row] - product(row, rows, v)) / curvature
            step = min(partial, full)
            if step == np.inf:
                if b[row] - product(row, rows, v) <= SLIGHT * (1.0 + abs(b[row])):
                    return SOLVED, iterations, -1
                for i in range(work[4][0]):
                    multipliers[i] = -r[i]
                return EMPTY, iterations, row
            for i in range(work[4][0]):
                multipliers[i] -= step * r[i]
            paid += step
            if full < np.inf:
                add_multiple(v, step, z)
            if full <= partial:
                add(row, paid, d, work)
                break
            drop(leaving, work)


@leaf
def product(row, rows, v):
    """Inner product of a row and a vector."""
    start, column, value = rows
    total = 0.0
    for at in range(start[row], start[row + 1]):
        total += value[at] * v[column[at]]
    return total


@leaf
def most_violated(rows, b, v, tolerance):
    """Row that is missed by most, -1 if all hold."""
    worst, at = tolerance, -1
    for row in range(len(b)):
        missing = b[row] - product(row, rows, v)
        if missing > worst * (1.0 + abs(b[row])):
            worst, at = missing / (1.0 + abs(b[row])), row
    return at


@leaf
def dual_value(v, f, b, work):
    """Value at the minimiser over the active rows: half of f'v plus half of u'b."""
    total = dot(f, v)
    for i in range(work[4][0]):
        total += work[3][i] * b[work[2][i]]
    return 0.5 * total


@leaf
def directions(row, rows, work, d, z, r):
    """Write ``d = J'normal`` for the normal of a row, the primal direction ``J2 d2`` and the dual one ``R^-1 d1``."""
    J, R, count = work[0], work[1], work[4][0]
    z[:] = 0.0
    for j in range(len(d)):
        d[j] = product(row, rows, J[j])
        if j >= count:
            add_multiple(z, d[j], J[j])
    solve_upper(R, d, r, count)


@leaf
def solve_upper(R, right, x, count):
    """Solve ``R' x = right``, where the transposed R, upper triangular, is kept by its columns."""
    for i in range(count):
        x[i] = right[i]
    for i in range(count - 1, -1, -1):
        x[i] /= R[i, i]
        add_multiple(x, -x[i], R[i, :i])


@leaf
def longest_dual_step(r, work):
    """Step at which the first multiplier becomes zero, and its place."""
    step, leaving = np.inf, -1
    for i in range(work[4][0]):
        if r[i] > 0.0 and work[3][i] < step * r[i]:
            step, leaving = work[3][i] / r[i], i
    return max(step, 0.0), leaving


@leaf
def add(row, multiplier, d, work):
    """Put a row into the active set; `d` is J times its normal."""
    J, R, count = work[0], work[1], work[4][0]
    for j in range(len(d) - 1, count, -1):
        if d[j] != 0.0:
            length = np.hypot(d[j - 1], d[j])
            turn(J[j - 1], J[j], d[j - 1] / length, d[j] / length)
            d[j - 1], d[j] = length, 0.0
    for i in range(count + 1):
        R[count, i] = d[i]
    work[2][count] = row
    work[3][count] = multiplier
    work[4][0] = count + 1


@leaf
def turn(first, second, c, s):
    """Turn a pair of rows of the transposed J, or of columns of R."""
    for i in range(len(first)):
        a, b = first[i], second[i]
        first[i] = c * a + s * b
        second[i] = c * b - s * a


@leaf
def drop(place, work):
    """Take a row out of the active set."""
    J, R, active, u, count = work[0], work[1], work[2], work[3], work[4][0]
    for k in range(place, count - 1):
        active[k], u[k] = active[k + 1], u[k + 1]
        for i in range(k + 2):
            R[k, i] = R[k + 1, i]
    for k in range(place, count - 1):
        length = np.hypot(R[k, k], R[k, k + 1])
        c, s = R[k, k] / length, R[k, k + 1] / length
        R[k, k], R[k, k + 1] = length, 0.0
        for j in range(k + 1, count - 1):
            a, b = R[j, k], R[j, k + 1]
            R[j, k] = c * a + s * b
            R[j, k + 1] = c * b - s * a
        turn(J[k], J[k + 1], c, s)
    work[4][0] = count - 1


@leaf
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
    g, w = np.zeros(n), np.zeros(n)
    for j in range(n):
        g[j] = dot(J[j], f)
        w[j] = -g[j]
    for i in range(count):
        w[i] = (b[active[i]] - dot(R[i, :i], w[:i])) / R[i, i]
    for i in range(count):
        g[i] += w[i]
    solve_upper(R, g, u, count)
    v[:] = 0.0
    for j in range(n):
        add_multiple(v, w[j], J[j])


@compiled
def start_from(rows, N, work):
    """Build the factors of a wished active set; rows that depend on those before are left out."""
    J, n = work[0], len(work[5])
    d = np.zeros(n)
    for row in rows:
        if work[4][0] >= n:
            return
        for j in range(n):
            d[j] = dot(J[j], N[row])
        if square(d, work[4][0]) > 1e-12 * square(d, 0):
            add(row, 0.0, d, work)
