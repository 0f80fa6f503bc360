"""Orthogonal factor of a growing and shrinking list of vectors.

``a_0 .. a_k-1`` are the columns of ``Q R``; `Qt` holds Q transposed, so that the rows of ``Qt[k:]`` span what is
orthogonal to all of them. A vector enters by one Householder reflection and leaves by plane rotations (G. Golub and
C. Van Loan, "Matrix computations", 2013, sections 5.1 and 6.5). All functions are kernels.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.vectors import reflect, rotate, turned

__all__ = ["append", "factor", "refactor", "remove"]


@compiled
def append(Qt: Any, R: Any, k: int, d: Any) -> None:
    """Let a vector enter as number k; `d` is ``Qt a``, ``d[k:]`` is not zero and is overwritten."""
    n = len(Qt)
    square = 0.0
    for i in range(k):
        R[i, k] = d[i]
    for i in range(k, n):
        square += d[i] * d[i]
    length = np.sqrt(square)
    if d[k] > 0:
        length = -length
    R[k, k] = length
    square -= d[k] * d[k]
    d[k] -= length
    square += d[k] * d[k]
    if square > 0:
        reflect(Qt, d, k, 2.0 / square)


@compiled
def remove(Qt: Any, R: Any, k: int, leaving: int) -> None:
    """Let vector number `leaving` of k go; the later ones move up."""
    for column in range(leaving, k - 1):
        for row in range(column + 2):
            R[row, column] = R[row, column + 1]
    for row in range(leaving, k - 1):
        length = np.hypot(R[row, row], R[row + 1, row])
        cosine, sine = R[row, row] / length, R[row + 1, row] / length
        rotate(R, row, row, k - 1, cosine, sine)
        rotate(Qt, row, 0, len(Qt), cosine, sine)


@compiled
def refactor(rows: Any, tolerance: float, Qt: Any, R: Any, d: Any) -> int:
    """Factor of the given rows, ``rows' = Q R``, into given arrays.

    Returns
    -------
    int
        The number of rows, or of those before the first that depends on the ones before it up to `tolerance`.
    """
    Qt[:] = 0.0
    for i in range(len(Qt)):
        Qt[i, i] = 1.0
    for row in range(len(rows)):
        if row >= len(Qt) or turned(Qt, rows[row], row, d) <= tolerance * tolerance:
            return row
        append(Qt, R, row, d)
    return len(rows)


@compiled
def factor(rows: Any, tolerance: float) -> Any:
    """Factor of the given rows.

    Returns
    -------
    Qt : array of shape (n, n)
    R : array of shape (k, k)
    rank : int
        As :func:`refactor`.
    """
    k, n = rows.shape
    Qt, R = np.empty((n, n)), np.zeros((k, k))
    return Qt, R, refactor(rows, tolerance, Qt, R, np.empty(n))
