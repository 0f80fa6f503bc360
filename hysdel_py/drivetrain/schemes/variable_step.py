"""Time-stepping with error control by step doubling, over the theta scheme with theta = 1/2.

A step is done once with dt and twice with dt/2. Where all three agree on the modes, the solution is smooth, the error
is of third order in dt, and extrapolation to (4 fine - coarse)/3 raises the order; elsewhere an event lies inside,
whose error of first order drives the step down.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant, Record, empty_record
from hysdel_py.drivetrain.kernels.rows import rows_of
from hysdel_py.drivetrain.kernels.time_stepping import OPEN, STICK, run
from hysdel_py.drivetrain.recording import trajectory_of
from hysdel_py.drivetrain.schemes.grid import sample_times
from hysdel_py.drivetrain.schemes.options import VariableStepMoreau, describe
from hysdel_py.drivetrain.schemes.segments import Segment, segments
from hysdel_py.drivetrain.schemes.time_stepping import ACTIVE_SET, effective_delassus
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory

__all__ = ["integrate"]

Matrix = NDArray[np.float64]
Modes = NDArray[np.int64]
_Row = tuple[float, Matrix, Matrix, Matrix, Matrix, Matrix, Modes, Matrix]

_THETA = 0.5
_SAFETY, _GROW, _SHRINK = 0.9, 4.0, 0.2
_EVENT_SHRINK = 0.5
_SOLVES = 3


@dataclass(slots=True)
class _Run:
    """The state of a run, and what it has written."""

    plant: Plant
    scheme: VariableStepMoreau
    t: float
    u: Matrix
    e: Matrix
    modes: Modes
    dt: float
    frequency: float
    rows: list[_Row] = field(default_factory=list)
    works: Matrix = field(default_factory=lambda: np.zeros(3))
    steps: int = 0
    solves: int = 0
    rejected: int = 0
    failures: int = 0


@dataclass(frozen=True, eq=False, slots=True)
class _Attempt:
    """One step whole and in two halves."""

    u: Matrix
    e: Matrix
    error: float
    smooth: bool
    fine: Record
    modes: Modes


def integrate(
    equations: Equations, u: Matrix, e: Matrix, until: float, scheme: VariableStepMoreau, sample: float | None
) -> DrivetrainTrajectory:
    """Run the scheme from speeds u and twists e; see :meth:`Drivetrain.simulate`."""
    plant, wanted = equations.plant, sample_times(until, sample)
    first = equations.inputs(np.zeros(1))
    slip = u @ plant.W + first.slip[0]
    modes = np.sign(np.where(np.abs(slip) <= 1e-12 * (1 + np.abs(u) @ np.abs(plant.W)), 0.0, slip)).astype(np.int64)
    state = _Run(plant, scheme, 0.0, u, e, modes, scheme.dt, _frequency(plant))
    zero = np.zeros(len(modes))
    state.rows.append((0.0, u, e, zero, zero, zero, np.where(first.pressure[0] > 0, modes, OPEN), state.works))
    for segment in segments(equations, until):
        _go_through(state, segment, wanted)
    return _trajectory(equations, state)


def _go_through(state: _Run, segment: Segment, wanted: Matrix | None) -> None:
    """Steps up to the end of a segment."""
    least = state.scheme.min_step
    while state.t < segment.end:
        left = segment.end - state.t
        dt = left if left <= 1.01 * state.dt else min(state.dt, 0.5 * left)
        attempt = _attempt(state, segment, dt)
        state.solves += _SOLVES
        if attempt.error > 1.0 and dt > least * 1.01:
            state.rejected += 1
            state.dt = max(least, dt * (_factor(attempt) if attempt.smooth else _EVENT_SHRINK))
            continue
        end = segment.end if dt == left else state.t + dt
        _sample(state, segment, attempt, end, wanted)
        _accept(state, attempt, end)
        proposed = max(dt * _factor(attempt), state.dt if dt < state.dt else 0.0)
        state.dt = float(np.clip(proposed, least, state.scheme.max_step))


def _sample(state: _Run, segment: Segment, attempt: _Attempt, end: float, wanted: Matrix | None) -> None:
    """Write the samples up to the end of an accepted step; those inside it are steps of their own that lead nowhere."""
    times = [end] if wanted is None else wanted[(wanted > state.t) & (wanted <= end)].tolist()
    for t in times:
        state.rows.append(_row(state, t, attempt if t == end else _attempt(state, segment, t - state.t)))


def _row(state: _Run, t: float, attempt: _Attempt) -> _Row:
    fine = attempt.fine
    works = state.works + fine.works[-1]
    contacts = (fine.torques[-1], fine.lower[-1], fine.upper[-1], attempt.modes.copy())
    return (t, attempt.u, attempt.e, *contacts, works)


def _factor(attempt: _Attempt) -> float:
    """Growth of the step from its error, which is of third order, or of second beside an event."""
    order = 3 if attempt.smooth else 2
    if attempt.error == 0.0:
        return _GROW
    return float(np.clip(_SAFETY * attempt.error ** (-1.0 / order), _SHRINK, _GROW))


def _attempt(state: _Run, segment: Segment, dt: float) -> _Attempt:
    """The step with dt, and with twice dt/2."""
    coarse, _ = _steps(state, segment, dt, 1)
    fine, modes = _steps(state, segment, 0.5 * dt, 2)
    error = max(
        float(np.max(np.abs(fine.speeds[-1] - coarse.speeds[-1]), initial=0.0)) / 3.0,
        float(np.max(np.abs(fine.twists[-1] - coarse.twists[-1]) * state.frequency, initial=0.0)) / 3.0,
    )
    smooth = bool(
        np.array_equal(fine.modes[1], fine.modes[2])
        and np.array_equal(fine.modes[2], coarse.modes[1])
        and np.array_equal(coarse.modes[1], state.modes)
    )
    error = max(error, _late_break_away(state.plant, fine, dt))
    u, e = fine.speeds[-1], fine.twists[-1]
    if smooth and state.scheme.extrapolate:
        u, e = (4 * u - coarse.speeds[-1]) / 3, (4 * e - coarse.twists[-1]) / 3
    elif not smooth:
        error *= 3.0
    return _Attempt(u, e, error / state.scheme.tolerance, smooth, fine, modes)


def _late_break_away(plant: Plant, fine: Record, dt: float) -> float:
    """Slip that is missed where a sticking contact passes its limit behind the middle of the last half step.

    A step knows mean torques only; the torque at its end is extrapolated from those of the two halves.
    """
    torque, lower, upper = (1.5 * a[2] - 0.5 * a[1] for a in (fine.torques, fine.lower, fine.upper))
    excess = np.where(fine.modes[2] == STICK, np.maximum(torque - upper, lower - torque), 0.0)
    return 0.25 * dt * float(np.max(np.maximum(excess, 0.0) * np.diag(plant.G), initial=0.0))


def _frequency(plant: Plant) -> float:
    """Greatest frequency of the springs [1/s], which compares twists with speeds."""
    if not len(plant.k):
        return 1.0
    stiffness = plant.B @ (plant.k[:, None] * plant.B.T)
    return float(np.sqrt(max(np.abs(np.linalg.eigvals(plant.Minv @ stiffness)).max(), 1.0)))


def _steps(state: _Run, segment: Segment, dt: float, count: int) -> tuple[Record, Modes]:
    """Steps of equal size from the present state."""
    middles = [segment.at(state.t + (k + 0.5) * dt) for k in range(count)]
    ends = [segment.at(state.t + (k + 1) * dt) for k in range(count)]
    inputs = Inputs(*(np.stack(parts) for parts in zip(*middles, strict=True)))
    inputs = inputs._replace(slip=np.stack([end.slip for end in ends]))
    record, modes = empty_record(count, state.plant), state.modes.copy()
    G, rows = effective_delassus(state.plant, _THETA, dt), rows_of(np.zeros((0, 0)))
    run(state.plant, inputs, G, rows, (_THETA, _THETA), dt, ACTIVE_SET, state.u, state.e, modes, record)
    return record, modes


def _accept(state: _Run, attempt: _Attempt, end: float) -> None:
    state.t, state.u, state.e, state.modes = end, attempt.u, attempt.e, attempt.modes
    state.works = state.works + attempt.fine.works[-1]
    state.steps += 1
    state.failures += int(np.sum(attempt.fine.effort < 0))


def _trajectory(equations: Equations, state: _Run) -> DrivetrainTrajectory:
    t, speeds, twists, torques, lower, upper, modes, works = (
        np.array(column) for column in zip(*state.rows, strict=True)
    )  # fmt: skip
    record = Record(speeds, twists, torques, lower, upper, modes, works, np.zeros(0, dtype=np.int64))
    if len(t) > 1:
        for array in (torques, lower, upper):
            array[0] = array[1]
    info = {
        "scheme": describe(state.scheme),
        "steps": state.steps,
        "rejected": state.rejected,
        "solves": state.solves,
        "failures": state.failures,
    }
    messages = (f"the contact problem did not converge in {state.failures} half steps",) if state.failures else ()
    return trajectory_of(equations, t, record, info=info, messages=messages)
