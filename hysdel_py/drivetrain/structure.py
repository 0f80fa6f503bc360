"""How the equations of a plant are coupled, and from it the form of its Delassus operator: a matrix, or a band.

A chain of shafts couples neighbours only. In the right order its inertia matrix and its contacts form a narrow band,
whatever the names and the order of its components are; the order is found from the graph of the couplings.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.kernels.banded import Band, factor
from hysdel_py.drivetrain.kernels.delassus import Delassus, is_dense, slips
from hysdel_py.drivetrain.kernels.rows import Rows, rows_of

__all__ = ["Multiplier", "delassus_of", "delassus_of_matrix", "dense_delassus", "inverse_of", "multiplier"]

Matrix = NDArray[np.float64]
Places = NDArray[np.int64]

SMALLEST_BAND = 40
"""Speeds and contacts from which a band may be used."""

WIDEST_BAND = 16
"""Half bandwidth up to which it is; beyond it there are more operations in a band than in a matrix of this size."""


def delassus_of(N: Matrix, W: Matrix) -> Delassus:
    """The operator ``W' N^-1 W`` of an inertia matrix N, shape (n, n), and directions of contacts W, shape (n, nc)."""
    rows = rows_of(W.T)
    symmetric = np.array_equal(N, N.T)  # to the last bit, as the band is of one half
    if symmetric and W.shape[1] and len(N) + W.shape[1] >= SMALLEST_BAND:
        speeds, contacts = _places(N, rows)
        half = _half_bandwidth(N, rows, speeds, contacts)
        if half <= WIDEST_BAND:
            return _banded(N, rows, speeds, contacts, half)
    return _dense(N, W, rows)


def delassus_of_matrix(G: Matrix) -> Delassus:
    """The operator of which only the matrix is known."""
    empty = Rows(np.zeros(len(G) + 1, np.int64), np.zeros(0, np.int64), np.zeros(0))
    G = np.ascontiguousarray(G)
    return Delassus(G, np.zeros((0, 0)), np.diag(G).copy(), np.zeros(0), empty, _no_band())


def dense_delassus(G: Delassus) -> Matrix:
    """The matrix of an operator, shape (nc, nc)."""
    if is_dense(G):
        return G.dense
    nothing = np.zeros(len(G.diagonal))
    matrix = np.array([slips(G, nothing, unit) for unit in np.eye(len(nothing))])
    symmetric: Matrix = 0.5 * (matrix + matrix.T)
    return symmetric


@dataclass(frozen=True, eq=False, slots=True)
class Multiplier:
    """The function ``values -> values @ matrix``; of a large matrix its entries alone count."""

    matrix: Any

    def __call__(self, values: Matrix) -> Matrix:
        """Product for values of any shape (..., rows of the matrix)."""
        if isinstance(self.matrix, np.ndarray):
            product: Matrix = values @ self.matrix
            return product
        found = values.reshape(-1, values.shape[-1]) @ self.matrix
        return np.asarray(found).reshape(*values.shape[:-1], self.matrix.shape[1])


def multiplier(matrix: Matrix) -> Multiplier:
    """The multiplier of a matrix."""
    if matrix.size < SMALLEST_BAND**2:
        return Multiplier(matrix)
    from scipy.sparse import csr_array

    return Multiplier(csr_array(matrix))


def inverse_of(N: Matrix) -> Matrix:
    """Inverse of an inertia matrix, at once where it is diagonal."""
    inertia = np.diag(N)
    if np.count_nonzero(N) == np.count_nonzero(inertia):
        return np.diag(1.0 / inertia)
    inverse = np.linalg.inv(N)
    return np.ascontiguousarray(0.5 * (inverse + inverse.T))


def _dense(N: Matrix, W: Matrix, rows: Rows) -> Delassus:
    inverse = inverse_of(N)
    G = np.ascontiguousarray(W.T @ inverse @ W)
    return Delassus(G, inverse, np.diag(G).copy(), np.diag(N).copy(), rows, _no_band())


def _no_band() -> Band:
    nothing = np.zeros(0, np.int64)
    return Band(np.zeros((0, 1)), nothing, nothing, np.zeros((0, 0)), np.zeros(0))


def _banded(N: Matrix, W: Rows, speeds: Places, contacts: Places, half: int) -> Delassus:
    entries = np.zeros((len(speeds) + len(contacts), half + 1))
    entries[contacts, half] = 1.0
    row, column = np.nonzero(N)
    below = speeds[column] <= speeds[row]
    a, b = speeds[row[below]], speeds[column[below]]
    entries[a, half + b - a] = N[row[below], column[below]]
    inertia, none = np.diag(N).copy(), np.zeros(len(contacts), dtype=bool)
    diagonal = np.add.reduceat(W.value**2 / inertia[W.column], W.start[:-1])
    band = Band(entries, speeds, contacts, *factor(entries, contacts, speeds, W, diagonal, none))
    empty = np.zeros((0, 0))
    return Delassus(empty, empty, diagonal, inertia, W, band)


def _places(N: Matrix, W: Rows) -> tuple[Places, Places]:
    """Places of the speeds, coupled ones near to each other, and of the contacts, each behind its last speed."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    n, count = len(N), len(W.start) - 1
    across = csr_array((W.value, W.column, W.start), shape=(count, n))
    graph = csr_array((np.abs(csr_array(N)) + abs(across).T @ abs(across)) != 0)
    order = np.asarray(reverse_cuthill_mckee(graph, symmetric_mode=True), dtype=np.int64)
    rank = np.empty(n, dtype=np.int64)
    rank[order] = np.arange(n)
    last = np.maximum.reduceat(rank[W.column], W.start[:-1])
    keys = np.concatenate([rank, last])  # a stable order keeps each speed before its contacts
    place = np.empty(n + count, dtype=np.int64)
    place[np.argsort(keys, kind="stable")] = np.arange(n + count)
    return place[:n], place[n:]


def _half_bandwidth(N: Matrix, W: Rows, speeds: Places, contacts: Places) -> int:
    row, column = np.nonzero(N)
    inside = np.abs(speeds[row] - speeds[column]).max(initial=0)
    owner = np.repeat(contacts, np.diff(W.start))
    return int(max(inside, np.abs(owner - speeds[W.column]).max(initial=0)))
