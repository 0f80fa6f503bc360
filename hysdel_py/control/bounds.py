"""Bounds of the decision variables, and which of them are decided by branching."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.bands import Band, ResolvedLimits
from hysdel_py.control.layout import Layout
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

__all__ = ["branching_variables", "interval_product", "real_inputs", "signal_ends", "variable_bounds"]

Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]


def variable_bounds(layout: Layout, limits: ResolvedLimits) -> tuple[Matrix, Matrix]:
    """Return the lower and upper bounds: declared ranges within hard limits, 0 and 1 for Boolean variables."""
    low, high = signal_ends(layout.stage_variables)
    beyond = np.zeros(len(layout.slacks) + len(layout.terms))
    lb = np.concatenate([np.tile(low, layout.horizon), beyond])
    ub = np.concatenate([np.tile(high, layout.horizon), beyond + np.inf])
    ub[layout.slack(0) : layout.term(0)] = _largest_slacks(layout.mld, limits)
    for band in limits.bands:
        if band.group in _TIMES and limits.slack_of(band) is None:
            for time, where in _places(layout, band):
                least, most = limits.ends(band, time)
                lb[where], ub[where] = max(lb[where], least), min(ub[where], most)
    return lb, ub


def _largest_slacks(mld: Mld, limits: ResolvedLimits) -> Matrix:
    """By how much the declared ranges let each softened limit be exceeded; no plan needs a larger slack.

    Finite bounds of the slacks let the branch and bound certify its bounds.
    """
    x = signal_ends(mld.x)
    y = _output_ends(mld)
    signals = {"x": x, "terminal": x, "y": y, "final": y}
    largest = np.zeros(len(limits.slacks))
    for band in limits.bands:
        slack = limits.slack_of(band)
        if slack is not None:
            low, high = (ends[band.column] for ends in signals[band.group])
            largest[slack] = max(largest[slack], max(band.lows) - low, high - min(band.highs))
    if limits.polytope is not None and limits.polytope_slack is not None:
        excess = interval_product(limits.polytope.S, x)[1] - limits.polytope.T
        largest[limits.polytope_slack] = max(0.0, excess.max(initial=0.0))
    return largest


def signal_ends(variables: tuple[Variable, ...]) -> tuple[Matrix, Matrix]:
    """Lower and upper ends of the ranges; those of a Boolean are equal where it has only one value."""
    low = np.array([max(0.0, v.low) if v.is_bool else v.low for v in variables], dtype=float)
    high = np.array([min(1.0, v.high) if v.is_bool else v.high for v in variables], dtype=float)
    return low, high


def _output_ends(mld: Mld) -> tuple[Matrix, Matrix]:
    low, high = signal_ends((*mld.x, *mld.u, *mld.d, *mld.z))
    below, above = interval_product(np.hstack([mld.C, mld.D1, mld.D2, mld.D3]), (low, high))
    return below + mld.D5, above + mld.D5


def interval_product(matrix: Matrix, ends: tuple[Matrix, Matrix]) -> tuple[Matrix, Matrix]:
    """Smallest and largest values of ``matrix v`` for v between the ends; a zero entry cancels an infinite end."""
    low, high = ends
    with np.errstate(invalid="ignore"):
        one, other = matrix * low, matrix * high
    one, other = (np.where(matrix == 0, 0.0, product) for product in (one, other))
    below: Matrix = np.minimum(one, other).sum(axis=1)
    above: Matrix = np.maximum(one, other).sum(axis=1)
    return below, above


_TIMES: dict[str, Callable[[int], range]] = {
    "u": range,
    "x": lambda N: range(1, N + 1),
    "terminal": lambda N: range(N, N + 1),
}
"""At which times a hard limit is a bound of a variable."""


def _places(layout: Layout, band: Band) -> Iterator[tuple[int, int]]:
    """Times of a limit, and the variable that it bounds there."""
    for time in _TIMES[band.group](layout.horizon):
        yield time, layout.start("u" if band.group == "u" else "x", time) + band.column


def branching_variables(layout: Layout, exact: int) -> tuple[Indices, Indices]:
    """Return the variables that must be 0 or 1, in the order of the first `exact` stages, and the stage of each.

    These are the Boolean inputs and auxiliaries, and those Boolean states whose update does not make them integers.
    """
    mld = layout.mld
    states = [v.is_bool and not implied for v, implied in zip(mld.x, _implied_states(mld), strict=True)]
    inputs = [v.is_bool for v in mld.u]
    mask = np.array([*inputs, *([True] * mld.nd), *([False] * mld.nz), *states], dtype=bool)
    columns = np.flatnonzero(mask)
    stages = np.repeat(np.arange(exact), len(columns))
    return np.tile(columns, exact) + stages * layout.stage_size, stages


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
