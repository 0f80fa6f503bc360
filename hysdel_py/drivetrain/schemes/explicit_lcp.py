"""Time-stepping with an explicit LCP in each step, decomposed and solved as the options say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.decomposition import ContactSolver
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant, Record
from hysdel_py.drivetrain.kernels.delassus import Delassus, pushed
from hysdel_py.drivetrain.kernels.time_stepping import (
    advance,
    count_work,
    free_motion,
    limits_of,
    may_hold,
    record,
)
from hysdel_py.drivetrain.schemes.options import Moreau
from hysdel_py.drivetrain.structure import dense_delassus

__all__ = ["run_with_lcp"]

Matrix = NDArray[np.float64]


def run_with_lcp(
    plant: Plant,
    inputs: Inputs,
    G: Delassus,
    weights: tuple[float, float],
    dt: float,
    scheme: Moreau,
    u: Matrix,
    e: Matrix,
    mode: NDArray[np.int64],
    out: Record,
) -> None:
    """As the compiled `run`, with another solver of the contact problem."""
    solver = ContactSolver(scheme.decomposition, scheme.solver)
    matrix = dense_delassus(G)
    lo, hi = np.zeros(len(mode)), np.zeros(len(mode))
    before = u.copy()
    out.speeds[0], out.twists[0] = u, e
    slip = u @ plant.W + inputs.slip[0]
    slip_before = slip
    for k in range(len(inputs.force)):
        middle = 1.5 * u - 0.5 * before
        free = free_motion(plant, G, weights[0], dt, inputs.force[k], inputs.throttle[k], inputs.twist[k], u, e, middle)
        c = free @ plant.W + inputs.slip[k]
        limits_of(plant, inputs.pressure[k], 1.5 * slip - 0.5 * slip_before, mode, dt, lo, hi)
        failures = solver.failures
        P = solver(matrix, c, lo, hi)
        if may_hold(plant, G, c, inputs.pressure[k], slip, mode, dt, P, lo, hi):
            P = solver(matrix, c, lo, hi)
        out.effort[k] = -1 if solver.failures > failures else 1
        u1 = free + pushed(G, P)
        e1 = advance(plant, weights[0], dt, inputs.twist[k], u, e, u1)
        count_work(plant, inputs, k, weights, dt, (u, u1), (e, e1), middle, P, out.works)
        before, u, e = u, u1, e1
        slip_before, slip = slip, u @ plant.W + inputs.slip[k]
        record(out, k + 1, u, e, P, lo, hi, mode, dt)
