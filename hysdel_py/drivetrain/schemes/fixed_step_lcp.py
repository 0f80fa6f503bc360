"""The document's event-driven method in fixed steps: a band around zero slip, and an LCP inside it at every stage."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.decomposition import ContactSolver
from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant, Record, empty_record
from hysdel_py.drivetrain.kernels.contact_rules import modes_by_band, sliding_torque
from hysdel_py.drivetrain.kernels.forces import (
    drag_force,
    sliding_limits,
    source_force,
    spring_force,
    sticking_limits,
    twist_rates,
)
from hysdel_py.drivetrain.kernels.time_stepping import STICK, mode_of
from hysdel_py.drivetrain.recording import trajectory_of
from hysdel_py.drivetrain.schemes.fixed_step import METHODS, undriven_band
from hysdel_py.drivetrain.schemes.fixed_step import integrate as compiled_integrate
from hysdel_py.drivetrain.schemes.grid import grid, inputs_at
from hysdel_py.drivetrain.schemes.options import FixedStepLcp, describe
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory

__all__ = ["integrate"]

Matrix = NDArray[np.float64]
Limits = tuple[Matrix, Matrix]


def integrate(
    equations: Equations, u: Matrix, e: Matrix, until: float, scheme: FixedStepLcp, sample: float | None
) -> DrivetrainTrajectory:
    """Run the scheme from speeds u and twists e; see :meth:`Drivetrain.simulate`."""
    if scheme.solver == "active-set":
        return compiled_integrate(equations, u, e, until, scheme, sample)
    steps = grid(equations, until, scheme.dt, sample)
    a, b, nodes, node = METHODS[scheme.integrator]
    inputs, plant = inputs_at(equations, steps, nodes), equations.plant
    band = undriven_band(plant, inputs, steps.dt) if scheme.band is None else scheme.band
    solver = ContactSolver(scheme.decomposition, scheme.solver)
    record = empty_record(len(steps.t) - 1, plant)
    n, m, last = len(u), len(e), len(steps.t) - 1
    for k in range(last + 1):
        rates: list[Matrix] = []
        for s, place in enumerate(node):
            weights = a[s][:s]
            change = steps.dt * sum((w * r for w, r in zip(weights, rates, strict=True)), np.zeros(n + m + 3))
            state = (u + change[:n], e + change[n : n + m])
            row = Inputs(*(array[k, place] for array in inputs))
            rate, torque, limits, mode = _stage(plant, row, *state, band, solver)
            rates.append(rate)
            if s == 0:
                _write(record, k, (u, e), torque, limits, mode)
            if k == last:
                break
        if k < last:
            change = steps.dt * sum((w * r for w, r in zip(b, rates, strict=True)), np.zeros(n + m + 3))
            u, e = u + change[:n], e + change[n : n + m]
            record.works[k + 1] = record.works[k] + change[n + m :]
    info = {"scheme": describe(scheme), "steps": last, "solves": solver.solves, "failures": solver.failures}
    return trajectory_of(equations, steps.t, record, every=steps.every, info=info)


def _stage(
    plant: Plant, inputs: Inputs, u: Matrix, e: Matrix, band: float, solver: ContactSolver
) -> tuple[Matrix, Matrix, Limits, NDArray[np.int64]]:
    """Derivatives of the state, torques lambda, their limits, and modes."""
    count = len(plant.laws)
    slide, stick = (np.zeros(count), np.zeros(count)), (np.zeros(count), np.zeros(count))
    sources = source_force(plant, inputs.force, inputs.throttle, u)
    losses = plant.D @ u + drag_force(plant, u)
    h = sources - losses
    spring_force(plant, e, h)
    slip = u @ plant.W + inputs.slip
    sliding_limits(plant, inputs.pressure, slip, *slide)
    sticking_limits(plant, inputs.pressure, *stick)
    mode = np.zeros(count, dtype=np.int64)
    modes_by_band(slip, stick, band, mode)
    torque = np.array([sliding_torque(mode[i], slide[0][i], slide[1][i]) for i in range(count)])
    index = np.flatnonzero(mode == STICK)
    if len(index):
        free = (plant.Minv @ h) @ plant.W + inputs.slip_rate + plant.G @ torque
        G = np.ascontiguousarray(plant.G[np.ix_(index, index)])
        torque[index] = solver(G, free[index], stick[0][index], stick[1][index])
        for i in index:
            mode[i] = mode_of(torque[i], stick[0][i], stick[1][i])
    powers = [
        sources @ u - torque @ inputs.slip + (plant.k * e) @ inputs.twist,
        -losses @ u,
        torque @ slip,
    ]
    rate = np.concatenate([plant.Minv @ (h + plant.W @ torque), twist_rates(plant, inputs.twist, u), powers])
    inside = np.isin(np.arange(count), index)
    limits = (np.where(inside, stick[0], slide[0]), np.where(inside, stick[1], slide[1]))
    return rate, torque, limits, mode


def _write(
    record: Record, k: int, state: tuple[Matrix, Matrix], torque: Matrix, limits: Limits, mode: NDArray[np.int64]
) -> None:
    record.speeds[k], record.twists[k], record.torques[k], record.modes[k] = *state, torque, mode
    record.lower[k], record.upper[k] = limits
