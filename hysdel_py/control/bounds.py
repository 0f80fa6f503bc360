"""Bounds of the decision variables, and which of them are decided by branching."""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.layout import Layout
from hysdel_py.control.limits import Band, ResolvedLimits
from hysdel_py.systems.mld import Mld

__all__ = ["branching_variables", "real_inputs", "variable_bounds"]

Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]


def variable_bounds(layout: Layout, limits: ResolvedLimits) -> tuple[Matrix, Matrix]:
    """Return the lower and upper bounds: declared ranges within hard limits, 0 and 1 for Boolean variables."""
    low = np.array([0.0 if v.is_bool else v.low for v in layout.stage_variables])
    high = np.array([1.0 if v.is_bool else v.high for v in layout.stage_variables])
    slacks = len(layout.slacks)
    lb = np.concatenate([np.tile(low, layout.horizon), np.zeros(slacks)])
    ub = np.concatenate([np.tile(high, layout.horizon), np.full(slacks, inf)])
    for band in limits.bands:
        if band.group != "y" and limits.slack_of(band) is None:
            where = _places(layout, band)
            lb[where] = np.maximum(lb[where], band.low)
            ub[where] = np.minimum(ub[where], band.high)
    return lb, ub


def _places(layout: Layout, band: Band) -> list[int]:
    N = layout.horizon
    times = {"u": range(N), "x": range(1, N + 1), "terminal": range(N, N + 1)}[band.group]
    return [layout.start("u" if band.group == "u" else "x", k) + band.column for k in times]


def branching_variables(layout: Layout) -> tuple[Indices, Indices]:
    """Return the variables that must be 0 or 1, in the order of the stages, and the stage of each.

    These are the Boolean inputs and auxiliaries, and those Boolean states whose update does not make them integers.
    """
    mld = layout.mld
    states = [v.is_bool and not implied for v, implied in zip(mld.x, _implied_states(mld), strict=True)]
    inputs = [v.is_bool for v in mld.u]
    mask = np.array([*inputs, *([True] * mld.nd), *([False] * mld.nz), *states], dtype=bool)
    columns = np.flatnonzero(mask)
    stages = np.repeat(np.arange(layout.horizon), len(columns))
    return np.tile(columns, layout.horizon) + stages * layout.stage_size, stages


def _implied_states(mld: Mld) -> list[bool]:
    """Say which states are integers because their update is an integer combination of Booleans."""
    x_real, u_real = (np.array([not v.is_bool for v in group], dtype=bool) for group in (mld.x, mld.u))
    whole = np.column_stack([mld.A, mld.B1, mld.B2, mld.B3, mld.B5])
    return [
        not (mld.A[i, x_real].any() or mld.B1[i, u_real].any() or mld.B3[i].any())
        and bool((whole[i] == np.round(whole[i])).all())
        for i in range(mld.nx)
    ]


def real_inputs(layout: Layout) -> Indices:
    """Return the indices of the real inputs of all stages, which with the binaries settle everything else."""
    columns = np.flatnonzero([not v.is_bool for v in layout.mld.u])
    return np.concatenate([columns + layout.start("u", k) for k in range(layout.horizon)])
