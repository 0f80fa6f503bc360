"""Linear systems with the rows and columns of the free unknowns: dense, banded or sparse, as the matrix is."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.lcp.problem import Lcp

__all__ = ["Blocks"]

Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]

WIDEST = 20
"""Half bandwidth up to which a sparse matrix is treated as banded."""


@dataclass(slots=True)
class Blocks:
    """Solver for ``M_ff x = r`` with varying sets f.

    Attributes
    ----------
    problem : Lcp
    shift : float
        Added to the diagonal where the block is singular.
    """

    problem: Lcp
    shift: float
    _band: Vector | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        if self.problem.is_sparse:
            self._band = _as_band(self.problem.M)

    def solve(self, free: Mask, right: Vector) -> Vector | None:
        """The entries of the free unknowns, at first without shift; None where both fail."""
        if not free.any():
            return np.zeros(0)
        for shift in (0.0, self.shift):
            x = self._attempt(free, right, shift)
            if x is not None and np.isfinite(x).all():
                return x
        return None

    def _attempt(self, free: Mask, right: Vector, shift: float) -> Vector | None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # singular blocks are told by their values
            try:
                if self._band is not None:
                    return _solve_band(self._band, free, right, shift)
                return (
                    self._solve_sparse(free, right, shift)
                    if self.problem.is_sparse
                    else self._dense(free, right, shift)
                )
            except (np.linalg.LinAlgError, RuntimeError):
                return None

    def _dense(self, free: Mask, right: Vector, shift: float) -> Vector | None:
        block = self.problem.M[np.ix_(free, free)]
        x = np.linalg.solve(block + shift * np.eye(len(block)), right)
        return x if shift or _solves(block, x, right) else None

    def _solve_sparse(self, free: Mask, right: Vector, shift: float) -> Vector | None:
        from scipy.sparse import csc_array, eye_array
        from scipy.sparse.linalg import splu

        block = csc_array(self.problem.M[free][:, free])
        x = np.asarray(splu(block + shift * eye_array(block.shape[0], format="csc")).solve(right))
        return x if shift or _solves(block, x, right) else None


def _solves(block: Any, x: Vector, right: Vector, accuracy: float = 1e-8) -> bool:
    """Whether x is neither huge nor inaccurate, as it would be for a block that is singular up to rounding."""
    size = max(1e-300, float(np.abs(right).max()))
    return bool(np.abs(block @ x - right).max() <= accuracy * size and np.abs(x).max() <= size / accuracy)


def _as_band(M: Any) -> Vector | None:
    """Diagonals in the layout of :func:`scipy.linalg.solve_banded`; None where there are too many."""
    entries = M.tocoo()
    row, column = entries.coords if hasattr(entries, "coords") else (entries.row, entries.col)
    half = int(np.abs(row - column).max()) if len(row) else 0
    if half > WIDEST:
        return None
    band = np.zeros((2 * half + 1, M.shape[0]))
    np.add.at(band, (half + row - column, column), entries.data)
    return band


def _solve_band(band: Vector, free: Mask, right: Vector, shift: float) -> Vector | None:
    """Rows and columns of fixed unknowns become those of the identity, which keeps the band."""
    from scipy.linalg import solve_banded

    half, n = (len(band) - 1) // 2, band.shape[1]
    row = np.arange(n) + np.arange(-half, half + 1)[:, None]
    inside = (row >= 0) & (row < n)
    kept = np.where(inside, free[np.clip(row, 0, n - 1)], False) & free
    matrix = np.where(kept, band, 0.0)
    matrix[half] += np.where(free, shift, 1.0)
    full = np.zeros(n)
    full[free] = right
    x = np.asarray(solve_banded((half, half), matrix, full))[free]
    size = max(1e-300, float(np.abs(right).max()))
    return x if shift or np.abs(x).max() <= 1e8 * size else None
