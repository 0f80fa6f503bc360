"""Orthogonal factor of a growing and shrinking list of vectors.

``a_0 .. a_k-1`` are the columns of ``Q R``; `Qt` holds Q transposed, so that the rows of ``Qt[k:]`` span what is
orthogonal to all of them. A vector enters by one Householder reflection and leaves by plane rotations (G. Golub and
C. Van Loan, "Matrix computations", 2013, sections 5.1 and 6.5). All functions are kernels.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.optimize.compiled import compiled

__all__ = ["append", "factor", "remove", "solve_lower", "solve_upper"]


@compiled
def append(Qt: Any, R: Any, k: int, d: Any) -> None:
    """Let a vector enter as number k; `d` is ``Qt a`` and ``d[k:]`` is not zero."""
    R[:k, k] = d[:k]
    tail = d[k:].copy()
    length = np.sqrt(np.dot(tail, tail))
    if tail[0] > 0:
        length = -length
    R[k, k] = length
    tail[0] -= length
    square = np.dot(tail, tail)
    if square > 0:
        coefficients = np.dot(tail, Qt[k:]) * (2.0 / square)
        for row in range(len(tail)):
            Qt[k + row] -= tail[row] * coefficients


@compiled
def remove(Qt: Any, R: Any, k: int, leaving: int) -> None:
    """Let vector number `leaving` of k go; the later ones move up."""
    for column in range(leaving, k - 1):
        R[: column + 2, column] = R[: column + 2, column + 1]
    for row in range(leaving, k - 1):
        a, b = R[row, row], R[row + 1, row]
        length = np.hypot(a, b)
        cosine, sine = a / length, b / length
        upper = cosine * R[row, row : k - 1] + sine * R[row + 1, row : k - 1]
        R[row + 1, row : k - 1] = cosine * R[row + 1, row : k - 1] - sine * R[row, row : k - 1]
        R[row, row : k - 1] = upper
        direction = cosine * Qt[row] + sine * Qt[row + 1]
        Qt[row + 1] = cosine * Qt[row + 1] - sine * Qt[row]
        Qt[row] = direction


@compiled
def factor(rows: Any, tolerance: float) -> Any:
    """Factor of the given rows, ``rows' = Q R``.

    Returns
    -------
    Qt : array of shape (n, n)
    R : array of shape (k, k)
    rank : int
        k, or the number of rows before the first that depends on those before it up to `tolerance`.
    """
    k, n = rows.shape
    Qt, R = np.eye(n), np.zeros((k, k))
    for row in range(k):
        if row >= n:
            return Qt, R, row
        d = np.dot(Qt, rows[row])
        rest = d[row:]
        if np.sqrt(np.dot(rest, rest)) <= tolerance:
            return Qt, R, row
        append(Qt, R, row, d)
    return Qt, R, k


@compiled
def solve_upper(R: Any, k: int, right: Any) -> Any:
    """``R^-1 right`` for the leading block of size k; right has shape (k, columns)."""
    x = right.copy()
    for row in range(k - 1, -1, -1):
        for later in range(row + 1, k):
            x[row] -= R[row, later] * x[later]
        x[row] /= R[row, row]
    return x


@compiled
def solve_lower(R: Any, k: int, right: Any) -> Any:
    """``R'^-1 right`` for the leading block of size k; right has shape (k, columns)."""
    x = right.copy()
    for row in range(k):
        x[row] /= R[row, row]
        for later in range(row + 1, k):
            x[later] -= R[row, later] * x[row]
    return x
