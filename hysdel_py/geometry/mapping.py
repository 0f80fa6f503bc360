"""Images of polyhedra under linear maps, as a change of coordinates before coordinates are eliminated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.affine_hull import null_space

__all__ = ["Mapped", "mapped"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_RANK = 1e-10
"""Diagonal entries of a triangular factor below this, relative to the first one, show a dependent row."""


@dataclass(frozen=True, eq=False, slots=True)
class Mapped:
    """``{w : A w <= b}`` in coordinates of which the first are independent rows of ``M w``.

    Attributes
    ----------
    A, b : arrays of shapes (m, n) and (m,)
    chosen : array of int, shape (r,)
        The rows of M that make the first coordinates.
    weights : array of shape (k, r)
        Every row of M as a combination of the chosen ones.
    """

    A: Matrix
    b: Vector
    chosen: NDArray[np.intp]
    weights: Matrix


def mapped(A: Matrix, b: Vector, M: Matrix) -> Mapped:
    """Change the coordinates of a polyhedron.

    Parameters
    ----------
    A : array of shape (m, n)
    b : array of shape (m,)
    M : array of shape (k, n)
    """
    chosen = _independent_rows(M)
    weights = np.linalg.lstsq(M[chosen].T, M.T)[0].T if len(chosen) else np.zeros((len(M), 0))
    lengths = np.linalg.norm(M[chosen], axis=1, keepdims=True)
    rest = null_space(M[chosen] / lengths, _RANK)
    frame = np.vstack([M[chosen], rest.T])
    return Mapped(np.asarray(np.linalg.solve(frame.T, A.T).T), b, chosen, np.asarray(weights, dtype=float))


def _independent_rows(M: Matrix) -> NDArray[np.intp]:
    from scipy.linalg import qr

    if not M.size:
        return np.zeros(0, dtype=np.intp)
    _, R, order = qr(M.T, mode="economic", pivoting=True)
    sizes = np.abs(np.diag(R))
    rank = int(np.sum(sizes > _RANK * sizes[0])) if sizes[0] > 0 else 0
    return np.sort(order[:rank])
