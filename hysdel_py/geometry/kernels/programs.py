"""Linear programs by the dozen over the same rows, with answers that are checked.

The point of an answer is checked against the rows, its value against the bound that the multipliers prove. What does
not stand the check is UNKNOWN, and the caller asks another solver.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import leaf

# Relative, for this module is loaded under the name of hysdel_py.geometry.interpreted, too.
from .linear_program import INFEASIBLE, OPTIMAL, UNBOUNDED, UNKNOWN, solved

__all__ = ["INFEASIBLE", "OPTIMAL", "maximised", "screened"]

_EPS = float(np.finfo(float).eps)
_CLEARLY_FIRST = 1e-6
"""A ray proves a row only if it meets all others later by this much, relative to its length."""


@leaf
def _unit_rows(A: Any, b: Any, G: Any, h: Any, rows: Any, least: float) -> int:
    """Rows of unit length that have coefficients and a finite side, with their numbers.

    It is -1 if a row without coefficients has a side below the least one.
    """
    count = 0
    for i in range(len(b)):
        total = 0.0
        for j in range(A.shape[1]):
            total += A[i, j] * A[i, j]
        if total == 0.0 and b[i] < least:
            return -1
        if total == 0.0 or b[i] == np.inf:
            continue
        length = np.sqrt(total)
        for j in range(A.shape[1]):
            G[count, j] = A[i, j] / length
        h[count] = b[i] / length
        rows[count] = i
        count += 1
    return count


@leaf
def _is_sound(c: Any, G: Any, h: Any, m: int, lb: Any, ub: Any, w: Any, y: Any, tolerance: float) -> bool:
    """Whether a point fulfils unit rows, and its value is within a tolerance of what the multipliers prove near it."""
    value = bound = 0.0
    for i in range(m):
        excess = -h[i]
        for j in range(len(c)):
            excess += G[i, j] * w[j]
        if not excess <= tolerance * max(1.0, abs(h[i])):
            return False
        if y[i] > 0.0:
            bound += y[i] * h[i]
    for j in range(len(c)):
        size = max(1.0, abs(w[j]))
        if not (lb[j] - tolerance * size <= w[j] <= ub[j] + tolerance * size):
            return False
        reduced = c[j]
        for i in range(m):
            reduced -= y[i] * G[i, j]
        high = ub[j] if ub[j] < np.inf else w[j] + size
        low = lb[j] if lb[j] > -np.inf else w[j] - size
        bound += reduced * (high if reduced > 0.0 else low)
        value += c[j] * w[j]
    return bound - value <= tolerance * max(1.0, abs(value))


@leaf
def _proven(c: Any, A: Any, b: Any, lb: Any, ub: Any, y: Any) -> float:
    """Upper bound of the value from multipliers of the rows as they are given, with an allowance for rounding."""
    m, n = A.shape
    rounding = _EPS * 2 * (m + n + 8)
    bound = 0.0
    for i in range(m):
        if y[i] > 0.0:
            bound += y[i] * (b[i] + rounding * abs(b[i]))
    for j in range(n):
        reduced, noise = c[j], abs(c[j])
        for i in range(m):
            if y[i] > 0.0:
                reduced -= y[i] * A[i, j]
                noise += y[i] * abs(A[i, j])
        most, least = reduced + rounding * noise, reduced - rounding * noise
        gain = 0.0 if noise == 0.0 else -np.inf
        if most != 0.0:
            gain = max(gain, most * (ub[j] if most > 0.0 else lb[j]))
        if least != 0.0:
            gain = max(gain, least * (ub[j] if least > 0.0 else lb[j]))
        bound += gain
    return bound


@leaf
def _priced(A: Any, rows: Any, count: int, prices: Any, y: Any) -> None:
    """Multipliers of the rows as they are given from those of the unit rows."""
    for i in range(len(y)):
        y[i] = 0.0
    for i in range(count):
        total = 0.0
        for j in range(A.shape[1]):
            total += A[rows[i], j] * A[rows[i], j]
        y[rows[i]] = prices[i] / np.sqrt(total)


@leaf
def _distinct(G: Any, h: Any, rows: Any, count: int, parallel: float) -> int:
    """Of parallel rows keep the tightest, of equal ones the first; returns how many are left."""
    kept = 0
    for i in range(count):
        place = kept
        for k in range(kept):
            apart = 0.0
            for j in range(G.shape[1]):
                apart = max(apart, abs(G[i, j] - G[k, j]))
                if apart > parallel:
                    break
            if apart <= parallel:
                place = k
                break
        if place == kept:
            kept += 1
        elif not h[i] < h[place] - 1e-15 * abs(h[i]):
            continue
        for j in range(G.shape[1]):
            G[place, j] = G[i, j]
        h[place], rows[place] = h[i], rows[i]
    return kept


@leaf
def _met_first(G: Any, h: Any, count: int, inside: Any, point: int, distance: Any, known: Any) -> None:
    """Mark the rows that a ray from an inner point along some row's normal meets first, and no other nearly as soon."""
    n = G.shape[1]
    for i in range(count):
        distance[i] = h[i]
        for j in range(n):
            distance[i] -= G[i, j] * inside[point, j]
        if distance[i] <= 0.0:
            return
    for k in range(count):
        first, soonest, second = -1, np.inf, np.inf
        for i in range(count):
            speed = 0.0
            for j in range(n):
                speed += G[i, j] * G[k, j]
            if speed <= 0.0:
                continue
            time = distance[i] / speed
            if time < soonest:
                first, soonest, second = i, time, soonest
            elif time < second:
                second = time
        if first >= 0 and second > soonest * (1.0 + _CLEARLY_FIRST):
            known[first] = True


@leaf
def screened(A: Any, b: Any, inside: Any, parallel: float, G: Any, h: Any, rows: Any, distance: Any, known: Any) -> int:
    """Rows of unit length that may be needed, with their numbers, and which of them surely are; how many there are.

    Parameters
    ----------
    A, b, inside : arrays of shapes (m, n), (m,) and (k, n)
        Rows and inner points; rows without coefficients or without a finite side are left out.
    parallel : float
        Unit rows that differ by less are parallel: the tightest stays, the first of equal ones.
    G, h, rows, distance, known : arrays of shapes (m, n), (m,), (m,) of int, (m,) and (m,) of bool
        Filled in, but for the distances, which are room to work in; none is known at the start.
    """
    count = _distinct(G, h, rows, _unit_rows(A, b, G, h, rows, -np.inf), parallel)
    for k in range(len(inside)):
        _met_first(G, h, count, inside, k, distance, known)
    return count


@leaf
def _dropped(G: Any, h: Any, row: int) -> None:
    h[row] = np.inf
    for j in range(G.shape[1]):
        G[row, j] = 0.0


@leaf
def maximised(
    C: Any,
    A: Any,
    b: Any,
    lb: Any,
    ub: Any,
    tolerance: float,
    margin: float,
    W: Any,
    Y: Any,
    values: Any,
    bounds: Any,
    basis: Any,
    rows: Any,
    inverse: Any,
    space: Any,
    G: Any,
    sides: Any,
) -> int:
    """Solve a linear program for each row of costs; fill in points, multipliers, values and proven bounds.

    An unbounded program has an infinite value. The first one without an answer that stands the check, or without a
    point, ends the work; its status is returned, else OPTIMAL.

    With a margin that is not negative the costs are the rows themselves, of unit length, and the question is which are
    needed: each one moves outwards by one while its program is solved, and is left out from then on unless the
    value exceeds its side by the margin. A value that is infinite at the start says that the row is known to be needed.

    Parameters
    ----------
    C, W, Y, values, bounds : arrays of shapes (k, n), (k, n), (k, m), (k,) and (k,)
    basis, rows, inverse, space, G, sides : arrays of shapes (n,) and (m,) of int, (n, n), (5, n), (m, n) and (2, m)
        Room to work in.
    """
    n = A.shape[1]
    h, prices = sides[0], sides[1]
    count = _unit_rows(A, b, G, h, rows, 0.0)
    if count < 0:
        return INFEASIBLE
    for k in range(len(C)):
        if margin >= 0.0:
            if values[k] == np.inf:
                continue
            h[k] += 1.0
        status = solved(C[k], G, h, count, lb, ub, W[k], prices, basis, inverse, space)
        bounds[k] = values[k] = np.inf
        if status == UNBOUNDED:
            continue
        if status != OPTIMAL:
            return status
        if not _is_sound(C[k], G, h, count, lb, ub, W[k], prices, tolerance):
            return UNKNOWN
        values[k] = 0.0
        for j in range(n):
            W[k, j] = min(max(W[k, j], lb[j]), ub[j])
            values[k] += C[k, j] * W[k, j]
        if margin >= 0.0:
            h[k] -= 1.0
            if values[k] <= h[k] + margin:
                _dropped(G, h, k)
            continue
        _priced(A, rows, count, prices, Y[k])
        bounds[k] = _proven(C[k], A, b, lb, ub, Y[k])
    return OPTIMAL
