"""Matrices as compressed rows: products cost what the matrix has entries, not what it has places."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import compiled

__all__ = ["Rows", "add_transposed", "rows_of", "times"]


class Rows(NamedTuple):
    """Row i has ``value[k]`` in ``column[k]`` for k from ``start[i]`` to ``start[i + 1] - 1``."""

    start: NDArray[np.int64]
    column: NDArray[np.int64]
    value: NDArray[np.float64]


def rows_of(matrix: NDArray[np.float64]) -> Rows:
    """The entries of a matrix that are not zero."""
    row, column = np.nonzero(matrix)
    start = np.searchsorted(row, np.arange(len(matrix) + 1)).astype(np.int64)
    return Rows(start, column.astype(np.int64), np.array(matrix[row, column], dtype=float))


@compiled
def times(rows, x):
    """Product of the matrix and x."""
    product = np.zeros(len(rows.start) - 1)
    for i in range(len(product)):
        for k in range(rows.start[i], rows.start[i + 1]):
            product[i] += rows.value[k] * x[rows.column[k]]
    return product


@compiled
def add_transposed(rows, x, total):
    """Add the product of the transposed matrix and x to `total`."""
    for i in range(len(rows.start) - 1):
        if x[i] != 0.0:
            for k in range(rows.start[i], rows.start[i + 1]):
                total[rows.column[k]] += rows.value[k] * x[i]
