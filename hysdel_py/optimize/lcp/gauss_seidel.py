"""Projected Gauss-Seidel sweeps: one unknown after the other is solved for and cut to its bounds.

Converges for symmetric positive definite M, and in practice for positive diagonals that dominate. A zero on the
diagonal, as in the one-sided form of friction, excludes it. Sweeps grow with the square of the length of a chain that
sticks; it pays where few unknowns are coupled or a good guess is at hand.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.kernels import lcp as kernels
from hysdel_py.optimize.lcp.problem import Lcp, LcpSettings, LcpStatus

__all__ = ["sweep"]

Vector = NDArray[np.float64]
Indices = NDArray[np.int64]


def sweep(problem: Lcp, guess: Vector, settings: LcpSettings) -> tuple[LcpStatus, Vector, int]:
    """Sweep over a scaled problem.

    Returns
    -------
    status : LcpStatus
        SOLVED, ITERATION_LIMIT, also where the sweeps diverge, or SINGULAR where a diagonal entry is not positive.
    z : array of shape (n,)
    sweeps : int
    """
    z = np.clip(guess, problem.lo, problem.hi)
    diagonal = np.array(problem.M.diagonal(), dtype=float)
    if (diagonal <= settings.singular).any():
        return LcpStatus.SINGULAR, z, 0
    outcome, count = kernels.sweeps(
        *_rows(problem), diagonal, problem.q, (problem.lo, problem.hi), z, settings.sweeps, 0.1 * settings.tolerance
    )
    if not np.isfinite(z).all():
        return LcpStatus.ITERATION_LIMIT, np.clip(guess, problem.lo, problem.hi), count
    return (LcpStatus.SOLVED if outcome == kernels.SOLVED else LcpStatus.ITERATION_LIMIT), z, count


def _rows(problem: Lcp) -> tuple[Indices, Indices, Vector]:
    """Starts, columns and values of the rows."""
    n = problem.n
    if problem.is_sparse:
        M = problem.M
        return M.indptr.astype(np.int64), M.indices.astype(np.int64), M.data
    return np.arange(n + 1) * n, np.tile(np.arange(n), n), np.ascontiguousarray(problem.M).ravel()
