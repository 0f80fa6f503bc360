"""The times of schemes with fixed steps."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Inputs

__all__ = ["Grid", "grid", "inputs_at", "sample_times"]

Matrix = NDArray[np.float64]

_SNAP = 1e-9
"""A time this close to a kink of an input, as a share of the step, is that kink."""

_SHORT_OF = 1e-12
"""The end of a step is read this share of a step earlier, so that a jump there belongs to the next one."""


@dataclass(frozen=True, eq=False, slots=True)
class Grid:
    """Equal steps.

    Attributes
    ----------
    t : array of shape (N+1,)
    dt : float
    every : int
        Steps between two samples.
    """

    t: Matrix
    dt: float
    every: int


def grid(equations: Equations, until: float, dt: float, sample: float | None) -> Grid:
    """Steps of at most `dt` that divide the time span, or the interval between samples, evenly."""
    span = until if sample is None else sample
    per_span = max(1, ceil(span / dt - 1e-9))
    steps = per_span * round(until / span)
    t = until * np.arange(steps + 1) / steps
    step = until / steps
    for signal in equations.signals:
        for knot in signal.knots:
            near = int(np.argmin(np.abs(t - knot)))
            if abs(t[near] - knot) <= _SNAP * step:
                t[near] = knot
    return Grid(t, step, 1 if sample is None else per_span)


def inputs_at(equations: Equations, steps: Grid, nodes: tuple[float, ...]) -> Inputs:
    """Inputs at the nodes (shares of a step) of all steps and of one more behind them, shape (N+1, nodes, size)."""
    shares = np.array([node if node < 1.0 else 1.0 - _SHORT_OF for node in nodes])
    return equations.inputs(steps.t[:, None] + steps.dt * shares)


def sample_times(until: float, sample: float | None) -> Matrix | None:
    """Times at which a scheme with variable steps writes samples; None: at its own steps."""
    if sample is None:
        return None
    count = round(until / sample)
    return until * np.arange(count + 1) / count
