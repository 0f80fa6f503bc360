"""Projection along coordinates: equalities are used up first, then Fourier's elimination without redundant rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.affine_hull import AffineHull
from hysdel_py.geometry.precision import Precision
from hysdel_py.geometry.redundancy import irredundant_rows
from hysdel_py.geometry.solver import LpSolver

__all__ = ["eliminate"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_ZERO = 1e-12
"""Coefficients of unit rows below this are zero."""


def eliminate(
    A: Matrix, b: Vector, hull: AffineHull, columns: Sequence[int], precision: Precision
) -> tuple[Matrix, Vector]:
    """Rows of ``{v : there is w with A (v, w) <= b}``; the columns of w are gone.

    Parameters
    ----------
    A : array of shape (m, n)
    b : array of shape (m,)
    hull : AffineHull
        Of the set, which has a point.
    columns : sequence of int
        Columns of w.
    precision : Precision
    """
    rows, left = np.column_stack([A, b]), list(columns)
    rows, left = _substituted(rows, hull.tight, left)
    while left:
        column = min(left, key=lambda c: _growth(rows, c))
        rows = _without_redundant(_combined(rows, column), hull.origin, precision)
        left.remove(column)
    kept = [c for c in range(A.shape[1]) if c not in set(columns)]
    return rows[:, kept], rows[:, -1]


def _substituted(rows: Matrix, tight: NDArray[np.bool_], columns: list[int]) -> tuple[Matrix, list[int]]:
    """Use the largest entries of the equalities as pivots of the columns that are to go."""
    rows, equal, left = rows.copy(), list(np.flatnonzero(tight)), list(columns)
    while equal and left:
        block = np.abs(rows[equal][:, left])
        i, j = np.unravel_index(int(np.argmax(block)), block.shape)
        if block[i, j] <= _ZERO:
            break
        pivot, column = equal.pop(int(i)), left.pop(int(j))
        factors = rows[:, column] / rows[pivot, column]
        factors[pivot] = 0.0
        rows -= np.outer(factors, rows[pivot])
        rows[:, column] = 0.0
        rows[pivot] = 0.0
    return rows, left


def _growth(rows: Matrix, column: int) -> int:
    """By how many rows the elimination of a column lengthens the list."""
    up, down = int(np.sum(rows[:, column] > _ZERO)), int(np.sum(rows[:, column] < -_ZERO))
    return up * down - up - down


def _combined(rows: Matrix, column: int) -> Matrix:
    """Fourier's step: each pair of an upper and a lower end of the column gives one row without it."""
    coefficient = rows[:, column]
    up, down = rows[coefficient > _ZERO], rows[coefficient < -_ZERO]
    over, under = up / up[:, [column]], down / -down[:, [column]]
    pairs = (over[:, None, :] + under[None, :, :]).reshape(-1, rows.shape[1])
    everything = np.vstack([rows[np.abs(coefficient) <= _ZERO], pairs])
    everything[:, column] = 0.0
    return everything


def _without_redundant(rows: Matrix, inside: Vector, precision: Precision) -> Matrix:
    """Unit rows that are needed; rows without coefficients hold, since the set has a point."""
    lengths = np.linalg.norm(rows[:, :-1], axis=1)
    empty = lengths <= _ZERO * np.maximum(1.0, np.max(np.abs(rows[:, :-1]), axis=1, initial=0.0))
    unit = rows[~empty] / lengths[~empty, None]
    unit[np.abs(unit) <= _ZERO] = 0.0
    needed = irredundant_rows(unit[:, :-1], unit[:, -1], inside[None], LpSolver(precision))
    return np.asarray(unit[list(needed)])
