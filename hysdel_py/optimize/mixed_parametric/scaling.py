"""Centres and half widths of the entries of w, from their ranges and rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.mixed_parametric.problem import MpMiqp

__all__ = ["scales"]

Vector = NDArray[np.float64]


def scales(problem: MpMiqp) -> tuple[Vector, Vector]:
    """Centre and half width of each entry of w: those of its range, or what its rows make of it without one.

    The range of an auxiliary of a cost, say, is not known; it is as large as the largest of the terms that it stands
    beside in a row.
    """
    finite = np.isfinite(problem.lb) & np.isfinite(problem.ub)
    low, high = (np.where(finite, end, 0.0) for end in (problem.lb, problem.ub))
    centre, half = (low + high) / 2, (high - low) / 2
    half[finite & (half == 0)] = 1.0
    if not finite.all():
        half[~finite] = _beside(problem, half, ~finite)
    return centre, half


def _beside(problem: MpMiqp, half: Vector, missing: NDArray[np.bool_]) -> Vector:
    """For each entry without range the greatest sum of the other terms of a row over its own coefficient."""
    rows = abs(problem.A)
    others = rows @ np.where(missing, 0.0, half)
    table = rows[:, np.flatnonzero(missing)].tocoo()
    most = np.zeros(table.shape[1])
    np.maximum.at(most, table.coords[1], others[table.coords[0]] / table.data)
    return np.where(most > 0, most, 1.0)
