"""From what a scheme wrote down to a trajectory: outputs, residuals, energy, events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Record
from hysdel_py.drivetrain.signals import sample
from hysdel_py.drivetrain.structure import multiplier
from hysdel_py.drivetrain.trajectory import ContactMode, DrivetrainTrajectory, Event
from hysdel_py.drivetrain.undetermined import sharing_message, undetermined_torques

__all__ = ["events_of_modes", "law_residuals", "trajectory_of"]

Matrix = NDArray[np.float64]


def law_residuals(torque: Matrix, slip: Matrix, lower: Matrix, upper: Matrix, mobility: Matrix) -> Matrix:
    """How far torque and slip are from a friction law, the greatest over the contacts, as a slip.

    ``|lambda - prox(lambda - gamma / r)| r`` with the slip r that a unit of torque makes in one step: it is the slip of
    a contact that should stick, and what the missing torque would have changed where it slides with the wrong one.

    Parameters
    ----------
    torque, slip, lower, upper : arrays of shape (N, nc)
        Values of lambda, slips, and limits of lambda.
    mobility : array of shape (N, nc)
        ``G_ii dt``, the slip per unit of torque.
    """
    if torque.shape[1] == 0:
        return np.zeros(len(torque))
    nearest = np.clip(torque - slip / mobility, lower, upper)
    worst: Matrix = np.max(np.abs(torque - nearest) * mobility, axis=1)
    return worst


def events_of_modes(t: Matrix, modes: NDArray[np.int64], contacts: Sequence[str]) -> tuple[Event, ...]:
    """One event for each change of a mode between two samples, at the time of the second."""
    rows, columns = np.nonzero(np.diff(modes, axis=0))
    return tuple(
        Event(float(t[k + 1]), contacts[int(i)], ContactMode(int(modes[k, i])), ContactMode(int(modes[k + 1, i])))
        for k, i in zip(rows, columns, strict=True)
    )


def trajectory_of(
    equations: Equations,
    t: Matrix,
    record: Record,
    *,
    events: tuple[Event, ...] | None = None,
    messages: tuple[str, ...] = (),
    info: Mapping[str, Any] | None = None,
    step: Matrix | None = None,
    every: int = 1,
) -> DrivetrainTrajectory:
    """The trajectory of a record.

    Parameters
    ----------
    t : array of shape (N+1,)
    step : array of shape (N+1,), optional
        Step sizes that scale the residuals; the differences of t by default.
    every : int
        Keep each sample whose number is a multiple of it.
    """
    inputs = equations.inputs(t)
    slips = multiplier(equations.W)(record.speeds) + inputs.slip
    if step is None:
        step = np.diff(t, prepend=t[0] - (t[1] - t[0] if len(t) > 1 else 1.0))
    residuals = law_residuals(
        record.torques, slips, record.lower, record.upper, np.maximum(step, 1e-12)[:, None] * equations.mobility
    )
    energy = 0.5 * np.sum(record.speeds * multiplier(equations.M)(record.speeds), axis=1)
    energy += 0.5 * record.twists**2 @ equations.k
    keep = slice(None, None, every)
    undetermined = undetermined_torques(equations.W, record.speeds[keep], slips[keep], record.modes[keep])
    return DrivetrainTrajectory(
        t=t[keep],
        speeds=equations.shaft_speeds(t[keep], record.speeds[keep]),
        twists=record.twists[keep],
        torques=-record.torques[keep],
        slips=slips[keep],
        mode_codes=record.modes[keep],
        residuals=residuals[keep],
        works=record.works[keep],
        energy=energy[keep],
        inputs=sample(equations.signals, t[keep]),
        events=events_of_modes(t, record.modes, equations.names.contacts) if events is None else events,
        names=equations.names,
        signal_names=equations.signal_names,
        messages=messages + sharing_message(t[keep], undetermined, equations.names.contacts),
        undetermined=undetermined,
        info=info or {},
    )
