"""Linear programs in few variables over the same rows, solved by the kernels of :mod:`hysdel_py.geometry.kernels`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.head_start import loops_are_fast, programs

__all__ = ["GreatestValues", "are_small", "greatest_radius", "greatest_values", "needed_among"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_MOST_VARIABLES = 20
_MOST_ENTRIES = 5000
_MOST_ENTRIES_PLAIN = 8
"""Without a compiler the loops of the kernels lose against PIQP from here on."""
_NO_MARGIN = -1.0


@dataclass(frozen=True, eq=False, slots=True)
class GreatestValues:
    """Answers of linear programs over the same rows, one for each row of costs.

    Attributes
    ----------
    is_feasible : bool
        Whether there is a point at all; without one the rest means nothing.
    points, multipliers : arrays of shapes (k, n) and (k, m)
    values, bounds : arrays of shape (k,)
        Infinite where a program is unbounded; the bounds are proven by the multipliers.
    """

    is_feasible: bool
    points: Matrix
    multipliers: Matrix
    values: Vector
    bounds: Vector


def are_small(m: int, n: int) -> bool:
    """Whether programs of m rows and n variables are solved fastest here."""
    return 0 < n <= _MOST_VARIABLES and m * n <= (_MOST_ENTRIES if loops_are_fast() else _MOST_ENTRIES_PLAIN)


def greatest_values(
    costs: Matrix, A: Matrix, b: Vector, lb: Vector, ub: Vector, *, tolerance: float
) -> GreatestValues | None:
    """Greatest value of each row of costs over ``A w <= b, lb <= w <= ub``; None unless all answers stand the check.

    Parameters
    ----------
    costs : array of shape (k, n)
    A, b : arrays of shapes (m, n) and (m,)
        An infinite side is a row that never matters.
    lb, ub : arrays of shape (n,)
    tolerance : float
        By which unit rows may be exceeded, and values miss their bounds, relative to 1 and their size.
    """
    given = np.array(costs, dtype=float, order="C"), np.array(A, dtype=float, order="C"), np.array(b, dtype=float)
    return _greatest_values(*given, np.array(lb, dtype=float), np.array(ub, dtype=float), tolerance=tolerance)


def greatest_radius(A: Matrix, b: Vector, most: float, tolerance: float) -> Vector | None:
    """Centre and radius of a greatest ball in ``A w <= b``, together in one array.

    None if there are no rows or no coordinates, if a row has no coefficients, or if the answer does not stand the
    check.

    Parameters
    ----------
    A, b : arrays of shapes (m, n) and (m,)
    most : float
        The radius where it could grow without end.
    tolerance : float
        As of :func:`greatest_values`.
    """
    m, n = A.shape
    rows, costs, free = np.empty((m, n + 1)), np.zeros((1, n + 1)), np.empty(n + 1)
    rows[:, :n] = A
    rows[:, n] = lengths = np.sqrt(np.einsum("ij,ij->i", A, A))
    if not m or not n or not np.minimum.reduce(lengths):
        return None
    free.fill(np.inf)
    costs[0, n] = 1.0
    sides = np.array(b, dtype=float)
    found = _greatest_values(costs, rows, sides, -free, free, tolerance=tolerance)
    if found is not None and found.values[0] == np.inf:
        free[n] = most
        found = _greatest_values(costs, rows, sides, -free, free, tolerance=tolerance)
    return None if found is None or not found.is_feasible else found.points[0]


def _greatest_values(
    costs: Matrix, A: Matrix, b: Vector, lb: Vector, ub: Vector, *, tolerance: float
) -> GreatestValues | None:
    """As :func:`greatest_values`, of arrays that the kernel can take as they are."""
    (m, n), k = A.shape, len(costs)
    W, Y, values, bounds = np.empty((k, n)), np.empty((k, m)), np.zeros(k), np.empty(k)
    kernels = programs(k * m * n)
    status = kernels.maximised(costs, A, b, lb, ub, tolerance, _NO_MARGIN, W, Y, values, bounds, *_room(m, n))
    is_told = status in (kernels.OPTIMAL, kernels.INFEASIBLE)
    return GreatestValues(status == kernels.OPTIMAL, W, Y, values, bounds) if is_told else None


def needed_among(
    A: Matrix, b: Vector, inside: Matrix, *, parallel: float, margin: float, tolerance: float
) -> tuple[tuple[int, ...], int] | None:
    """Rows that can't be left out, in their order, and how many linear programs it took to tell.

    Each row that can be left out is left out before the next is asked for. None unless all answers stand the check.

    Parameters
    ----------
    A, b : arrays of shapes (m, n) and (m,)
    inside : array of shape (k, n)
        Inner points; rays from them tell some rows without a program.
    parallel : float
        Unit rows that differ by less are parallel.
    margin : float
        A row is needed if it is exceeded by more than this without it, for a normal of unit length.
    tolerance : float
        As of :func:`greatest_values`.
    """
    m, n = A.shape
    G, h, rows, known = np.empty((m, n)), np.empty(m), np.empty(m, np.int64), np.zeros(m, np.bool_)
    given = np.array(A, dtype=float, order="C"), np.array(b, dtype=float), np.array(inside, dtype=float, order="C")
    kernels = programs(m * m * n)
    count = kernels.screened(*given, parallel, G, h, rows, np.empty(m), known)
    G, h, rows, known = G[:count], h[:count], rows[:count], known[:count]
    asked = int(count - np.count_nonzero(known))
    if asked:
        values, far, W = np.where(known, np.inf, 0.0), np.full(n, np.inf), np.empty((count, n))
        outs = W, np.empty((1, 1)), values, np.empty(count)
        if kernels.maximised(G, G, h, -far, far, tolerance, margin, *outs, *_room(count, n)) != kernels.OPTIMAL:
            return None
        rows = rows[values > h + margin]
    return tuple(sorted(rows.tolist())), asked


def _room(m: int, n: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Matrix, Matrix, Matrix, Matrix]:
    """Arrays that the kernel works in."""
    basis, rows = np.empty(n, np.int64), np.empty(m, np.int64)
    return basis, rows, np.empty((n, n)), np.empty((5, n)), np.empty((m, n)), np.empty((2, m))
