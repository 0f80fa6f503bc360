"""Smooth friction with variable steps by the implicit Radau method."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant, Record
from hysdel_py.drivetrain.kernels.contact_rules import SMOOTH
from hysdel_py.drivetrain.kernels.fixed_step import stage
from hysdel_py.drivetrain.recording import trajectory_of
from hysdel_py.drivetrain.schemes.grid import sample_times
from hysdel_py.drivetrain.schemes.options import Smoothing, describe
from hysdel_py.drivetrain.schemes.segments import Segment, segments
from hysdel_py.drivetrain.schemes.smooth_jacobian import jacobian_of, limits_at
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory

__all__ = ["integrate"]

Matrix = NDArray[np.float64]

_WORK_TOLERANCE = 1e6
"""Works do not take part in the error control."""


def integrate(
    equations: Equations, u: Matrix, e: Matrix, until: float, scheme: Smoothing, sample: float | None
) -> DrivetrainTrajectory:
    """Run the scheme from speeds u and twists e; see :meth:`Drivetrain.simulate`."""
    plant, wanted = equations.plant, sample_times(until, sample)
    z = np.concatenate([u, e, np.zeros(3)])
    times, states = [np.zeros(1)], [z[None, :]]
    steps, evaluations, message = 0, 0, ""
    for segment in segments(equations, until):
        inner = None if wanted is None else wanted[(wanted > segment.start) & (wanted <= segment.end)]
        answer = _solve(plant, segment, z, scheme, inner)
        steps, evaluations = steps + answer.t.size, evaluations + answer.nfev
        if not answer.success:
            message = f"the integration stopped at t = {answer.t[-1]:.6g} s: {answer.message}"
        times.append(answer.t[1:] if inner is None else inner[: answer.t.size])
        states.append(answer.y.T[1:] if inner is None else answer.y.T[: len(times[-1])])
        z = answer.final
        if message:
            break
    t, Z = np.concatenate(times), np.concatenate(states)
    info = {"scheme": describe(scheme), "steps": steps, "evaluations": evaluations}
    record = _record(equations, plant, t, Z, scheme.steepness)
    return trajectory_of(
        equations, t, record, info=info, messages=(message,) if message else (), step=np.full(len(t), 1e-3)
    )  # fmt: skip


class _Answer:
    """What an integration over one segment gives."""

    __slots__ = ("final", "message", "nfev", "success", "t", "y")

    def __init__(self, found: Any, wanted: Matrix | None) -> None:
        self.success, self.message, self.nfev = found.success, found.message, found.nfev
        self.final = found.y[:, -1]
        self.t, self.y = found.t, found.y
        if wanted is not None:
            self.t = found.t[: len(wanted)]
            self.y = found.y[:, : len(wanted)]


def _solve(plant: Plant, segment: Segment, z: Matrix, scheme: Smoothing, wanted: Matrix | None) -> _Answer:
    from scipy.integrate import solve_ivp

    n, m, count = len(plant.M), len(plant.k), len(plant.laws)
    slide, stick = (np.zeros(count), np.zeros(count)), (np.zeros(count), np.zeros(count))
    mode, torque, rate = np.zeros(count, dtype=np.int64), np.zeros(count), np.zeros(n + m + 3)
    options = (0.0, 0.0, float(scheme.steepness))

    def rates(t: float, state: Matrix) -> Matrix:
        inputs = Inputs(*(array[None, None, :] for array in segment.at(t)))
        u, e = np.ascontiguousarray(state[:n]), np.ascontiguousarray(state[n : n + m])
        stage(plant, inputs, 0, 0, u, e, SMOOTH, options, mode, slide, stick, torque, rate)
        return rate.copy()

    atol = np.concatenate([np.full(n + m, scheme.atol), np.full(3, _WORK_TOLERANCE)])
    ends = (segment.start, segment.end)
    at = None if wanted is None else np.unique(np.append(wanted, segment.end))
    max_step = np.inf if segment.is_linear else scheme.max_step
    found = solve_ivp(
        rates, ends, z, method="Radau", rtol=scheme.rtol, atol=atol, t_eval=at, max_step=max_step,
        jac=jacobian_of(plant, segment, float(scheme.steepness)),
    )  # fmt: skip
    return _Answer(found, wanted)


def _record(equations: Equations, plant: Plant, t: Matrix, Z: Matrix, steepness: float) -> Record:
    """Torques and modes at the samples."""
    n, m = len(plant.M), len(plant.k)
    inputs = equations.inputs(t)
    slip = Z[:, :n] @ plant.W + inputs.slip
    lower, upper = limits_at(plant, inputs.pressure, slip)
    torque = 0.5 * (upper + lower) - (upper - lower) / np.pi * np.arctan(steepness * slip)
    modes = np.where(upper <= lower, 2, np.where(slip > 0, 1, -1)).astype(np.int64)
    return Record(
        Z[:, :n], Z[:, n : n + m], torque, lower, upper, modes, Z[:, n + m :], np.zeros(0, dtype=np.int64)
    )  # fmt: skip
