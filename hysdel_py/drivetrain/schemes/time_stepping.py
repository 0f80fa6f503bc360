"""Time-stepping with fixed steps: Moreau's scheme, the theta scheme, and both with prox iterations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant, Record, empty_record
from hysdel_py.drivetrain.kernels.delassus import Delassus
from hysdel_py.drivetrain.kernels.prox import JACOBI, SEIDEL
from hysdel_py.drivetrain.kernels.rows import rows_of
from hysdel_py.drivetrain.kernels.time_stepping import OPEN, STICK, run
from hysdel_py.drivetrain.recording import trajectory_of
from hysdel_py.drivetrain.schemes.explicit_lcp import run_with_lcp
from hysdel_py.drivetrain.schemes.grid import Grid, grid
from hysdel_py.drivetrain.schemes.options import AugmentedLagrangian, Moreau, describe
from hysdel_py.drivetrain.structure import delassus_of, dense_delassus, inverse_of, multiplier
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory
from hysdel_py.errors import ArgumentError

__all__ = ["ACTIVE_SET", "effective_delassus", "effective_inverse", "first_modes", "integrate", "weights_of"]

Matrix = NDArray[np.float64]

ACTIVE_SET = (0.0, 0.0, 0.0, 0.0)
"""The active-set solver, in the form in which the kernels take a solver."""

_SYMMETRY = 1e-12
"""Share by which entries of a symmetric matrix may differ."""


def integrate(
    equations: Equations,
    u: Matrix,
    e: Matrix,
    until: float,
    scheme: Moreau | AugmentedLagrangian,
    sample: float | None,
) -> DrivetrainTrajectory:
    """Run a scheme from speeds u and twists e; see :meth:`Drivetrain.simulate`."""
    plant, steps = equations.plant, grid(equations, until, scheme.dt, sample)
    inputs = step_inputs(equations, steps, scheme.inputs)
    record = empty_record(len(steps.t) - 1, plant)
    mode = first_modes(plant, inputs, u)
    record.modes[0] = np.where(inputs.pressure[0] > 0, mode, OPEN)
    G, weights = effective_delassus(plant, scheme.theta, steps.dt), weights_of(scheme.theta)
    if isinstance(scheme, Moreau) and scheme.solver != "active-set":
        run_with_lcp(plant, inputs, G, weights, steps.dt, scheme, u, e, mode, record)
    else:
        solver = _solver(scheme)
        rows = rows_of(dense_delassus(G) if solver[0] == SEIDEL else np.zeros((0, 0)))
        run(plant, inputs, G, rows, weights, steps.dt, solver, u, e, mode, record)
    return _trajectory(equations, steps, record, scheme)


def step_inputs(equations: Equations, steps: Grid, when: str) -> Inputs:
    """One row per step: inputs in its middle or at its start; prescribed slips at its end."""
    t = steps.t[:-1]
    inputs = equations.inputs(t + 0.5 * steps.dt if when == "middle" else t)
    return inputs._replace(slip=equations.inputs(steps.t[1:]).slip)


def _solver(scheme: Moreau | AugmentedLagrangian) -> tuple[float, float, float, float]:
    if isinstance(scheme, Moreau):
        return ACTIVE_SET
    if scheme.steepness is None:
        return (SEIDEL, 1.0, float(scheme.tolerance), float(scheme.iterations))
    return (JACOBI, float(scheme.steepness), float(scheme.tolerance), float(scheme.iterations))


def effective_inertia(plant: Plant, theta: float, dt: float) -> Matrix:
    """The mass matrix with damping and stiffness, in which the theta scheme is implicit.

    Raises
    ------
    ArgumentError
        The damping matrix is not symmetric: then this is no inertia, and contact problems are no programs.
    """
    if not np.allclose(plant.D, plant.D.T, rtol=_SYMMETRY, atol=0.0):
        raise ArgumentError(
            "D is not symmetric: schemes with theta need a symmetric one; take hys.EventDriven(), hys.Exact() or "
            "hys.Moreau(theta=None)"
        )
    stiffness: Matrix = multiplier(plant.B.T)(plant.B * plant.k)
    return plant.M + theta * dt * plant.D + (theta * dt) ** 2 * stiffness


def effective_inverse(plant: Plant, theta: float | None, dt: float) -> Matrix:
    """``A``: inverse of the mass matrix, with damping and stiffness where the scheme is implicit in them."""
    if theta is None:
        return plant.Minv
    return inverse_of(effective_inertia(plant, theta, dt))


def effective_delassus(plant: Plant, theta: float | None, dt: float) -> Delassus:
    """The operator ``W'A W``."""
    return plant.mass if theta is None else delassus_of(effective_inertia(plant, theta, dt), plant.W)


def weights_of(theta: float | None) -> tuple[float, float]:
    """Weight of the new speeds in the twists, and in the damping."""
    return (0.5, 0.0) if theta is None else (float(theta), float(theta))


def first_modes(plant: Plant, inputs: Inputs, u: Matrix) -> NDArray[np.int64]:
    """Contacts without slip may stick with the static coefficient from the start."""
    slip = u @ plant.W + inputs.slip[0]
    scale = np.finfo(float).eps * 16 * (np.abs(u) @ np.abs(plant.W) + np.abs(inputs.slip[0]))
    return np.where(np.abs(slip) <= scale, STICK, np.sign(slip)).astype(np.int64)


def _trajectory(
    equations: Equations, steps: Grid, record: Record, scheme: Moreau | AugmentedLagrangian
) -> DrivetrainTrajectory:
    if len(record.torques) > 1:
        for array in (record.torques, record.lower, record.upper):
            array[0] = array[1]
    failures = int(np.sum(record.effort < 0))
    info = {
        "scheme": describe(scheme),
        "steps": len(record.effort),
        "solves": int(np.sum(np.maximum(record.effort, 0))),
        "failures": failures,
    }
    messages = (
        (f"the contact problem did not converge in {failures} of {len(record.effort)} steps",) if failures else ()
    )
    return trajectory_of(equations, steps.t, record, every=steps.every, info=info, messages=messages)
