"""Explicit Runge-Kutta methods with fixed steps: smoothing, Karnopp, Switch Model, wait state."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant, empty_record
from hysdel_py.drivetrain.kernels.contact_rules import HELD, KARNOPP, SMOOTH, SWITCH
from hysdel_py.drivetrain.kernels.fixed_step import run
from hysdel_py.drivetrain.recording import trajectory_of
from hysdel_py.drivetrain.schemes.grid import grid, inputs_at
from hysdel_py.drivetrain.schemes.options import (
    FixedStepLcp,
    Karnopp,
    Smoothing,
    SwitchModel,
    WaitState,
    describe,
)
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory

__all__ = ["METHODS", "integrate", "undriven_band"]

Matrix = NDArray[np.float64]
Method = tuple[Matrix, Matrix, NDArray[np.int64]]

METHODS: dict[str, tuple[list[list[float]], list[float], tuple[float, ...], list[int]]] = {
    "euler": ([[0.0]], [1.0], (0.0,), [0]),
    "rk3": (
        [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.75, 0.0]],
        [2 / 9, 1 / 3, 4 / 9],
        (0.0, 0.5, 0.75),
        [0, 1, 2],
    ),
    "rk4": (
        [[0.0] * 4, [0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        [1 / 6, 1 / 3, 1 / 3, 1 / 6],
        (0.0, 0.5, 1.0),
        [0, 1, 1, 2],
    ),
}
"""Coefficients a and b, nodes at which inputs are read, and the node of each stage; rk3 is Bogacki and Shampine's."""

_TAU_IN_STEPS = 2.0

_UNDRIVEN_SHARE = 0.5
"""Where nothing reduces the slip inside the band, its width is an error: the narrowest that is not jumped over."""


def integrate(
    equations: Equations,
    u: Matrix,
    e: Matrix,
    until: float,
    scheme: Smoothing | Karnopp | SwitchModel | WaitState | FixedStepLcp,
    sample: float | None,
) -> DrivetrainTrajectory:
    """Run a scheme from speeds u and twists e; see :meth:`Drivetrain.simulate`."""
    assert scheme.dt is not None
    steps = grid(equations, until, scheme.dt, sample)
    a, b, nodes, node = METHODS[scheme.integrator]
    inputs = inputs_at(equations, steps, nodes)
    plant = equations.plant
    record = empty_record(len(steps.t) - 1, plant)
    rule, options = _rule(scheme, plant, inputs, steps.dt)
    method = (np.array(a), np.array(b), np.array(node, dtype=np.int64))
    mode = np.zeros(len(equations.laws), dtype=np.int64)
    run(plant, inputs, method, steps.dt, rule, options, u, e, mode, record)
    info = {"scheme": describe(scheme), "steps": len(steps.t) - 1, "evaluations": (len(steps.t) - 1) * len(b)}
    messages: tuple[str, ...] = ()
    if not np.all(np.isfinite(record.speeds[-1])):
        messages = ("the run grew beyond all numbers: the step is too long for these stiffnesses",)
    return trajectory_of(equations, steps.t, record, every=steps.every, info=info, messages=messages)


def _rule(
    scheme: Smoothing | Karnopp | SwitchModel | WaitState | FixedStepLcp, plant: Plant, inputs: Inputs, dt: float
) -> tuple[int, tuple[float, float, float]]:
    """Rule of the contact torques and its options: band, rate, steepness."""
    match scheme:
        case Smoothing(steepness=steepness):
            return SMOOTH, (0.0, 0.0, float(steepness))
        case Karnopp(band=band):
            return KARNOPP, (undriven_band(plant, inputs, dt) if band is None else float(band), 0.0, 0.0)
        case SwitchModel(band=band, tau=tau):
            rate = 1.0 / (_TAU_IN_STEPS * dt if tau is None else tau)
            return SWITCH, (natural_band(plant, inputs, dt) if band is None else float(band), rate, 0.0)
        case FixedStepLcp(band=band):  # the Switch Model that nothing drives to zero slip
            return SWITCH, (undriven_band(plant, inputs, dt) if band is None else float(band), 0.0, 0.0)
        case WaitState(band=band):
            return HELD, (float(band), 0.0, 0.0)


def undriven_band(plant: Plant, inputs: Inputs, dt: float) -> float:
    """Band of the rules that do not drive the slip to zero [rad/s]."""
    return _UNDRIVEN_SHARE * natural_band(plant, inputs, dt)


def natural_band(plant: Plant, inputs: Inputs, dt: float) -> float:
    """What the slip of a contact can move in one step by its own greatest torque [rad/s]."""
    pressure = inputs.pressure.reshape(-1, inputs.pressure.shape[-1])
    greatest = plant.laws[:, 0] * pressure.max(axis=0, initial=0.0)
    return float(np.max(np.diag(plant.G) * greatest, initial=0.0)) * dt + np.finfo(float).tiny
