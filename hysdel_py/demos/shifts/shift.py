"""A gear shift from the first move to the locked clutch, and what it looked like at the plant.

Part 1 releases the clutch in the old gear; the gear is changed while the clutch carries nothing; part 2 begins with the
state in which part 1 ended and ends when the relative speed has died away; a simple law then locks the clutch.
Everything is judged at the fine steps of the plant.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.demos.shifts.cases import Part, Shift
from hysdel_py.demos.shifts.controllers import (
    NODE_LIMIT,
    PartController,
    part_model,
    release_brake,
    shift_controller,
)
from hysdel_py.demos.shifts.judgement import Judgement, drive_torque, judged
from hysdel_py.demos.shifts.plant import SAMPLE_TIME, STEPS_PER_SAMPLE, Deviation, ShiftPlant
from hysdel_py.demos.shifts.references import torque_reference
from hysdel_py.demos.shifts.transmission import STATES, Transmission
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["ShiftRun", "run_shift"]

Vector = NDArray[np.float64]

_HANDED_TO_LOCK = 0.4  # rad/s, relative speed below which the lock-up law acts
_LOCK_STEPS = 30
_PATIENCE = 60  # samples that part 2 may take beyond its length in the document
_GENTLE, _FAST = 200.0, 792.0  # N/s, closing a clutch that slips, and one that sticks


@dataclass(frozen=True, eq=False)
class ShiftRun:
    """A shift as it happened.

    Attributes
    ----------
    shift : Shift
    parts : tuple of Trajectory
        Release, engagement, lock-up; as many as were reached.
    fine : array of shape (steps, len(FINE))
        The plant at its own steps.
    judgement : Judgement
    data : Transmission
    """

    shift: Shift
    parts: tuple[Trajectory, ...]
    fine: Vector
    judgement: Judgement
    data: Transmission

    @property
    def done(self) -> bool:
        """Whether the clutch of the new gear locked and stayed locked."""
        return self.judgement.done

    @property
    def end(self) -> Vector:
        """The last state."""
        return self.fine[-1, : len(STATES)].copy()

    @property
    def t(self) -> Vector:
        """Times of the fine steps [s]."""
        return np.asarray(SAMPLE_TIME / STEPS_PER_SAMPLE * np.arange(1, len(self.fine) + 1), dtype=float)

    @property
    def torque(self) -> Vector:
        """Torque of the drive shaft at the fine steps [Nm]."""
        return drive_torque(self.data, self.fine)

    @property
    def reference(self) -> Vector:
        """Its reference [Nm]."""
        return torque_reference(self.shift.torques, self.t, self.shift.fall)

    def figures(self) -> dict[str, Any]:
        """The figures as plain data."""
        return {"shift": self.shift.name} | self.judgement.figures()

    def table(self) -> list[tuple[str, str]]:
        """The figures as lines of text and value."""
        return self.judgement.table()

    def plot(self) -> Figure:
        """Inputs, speeds, flywheel, torque at the wheels and solve times over time."""
        from hysdel_py.plotting.shift import plot_shift

        return plot_shift(self)


def run_shift(
    shift: Shift,
    start: Vector | None = None,
    data: Transmission | None = None,
    *,
    deviation: Deviation | None = None,
    noise: Mapping[str, float] | None = None,
    seed: int = 0,
    node_limit: int = NODE_LIMIT,
    progress: Callable[[int, int], Any] | None = None,
) -> ShiftRun:
    """Run a shift on the plant with stick and slip.

    Parameters
    ----------
    shift : Shift
    start : array of shape (7,), optional
        State of the plant; the stationary state of the shift by default.
    data : Transmission, optional
    deviation : Deviation, optional
        Where the plant differs from the model of the controllers.
    noise : mapping of state to float, optional
        Standard deviations of the measurement.
    seed : int
        Of the noise.
    node_limit : int
        Nodes of the branch and bound per move.
    progress : callable, optional
        Called with the step and the number of steps.
    """
    data, deviation = data or Transmission(), deviation or Deviation()
    if start is None:
        start = np.array(
            list(data.stationary(shift.gears[0], shift.torques[0], shift.speed, deviation.friction).values())
        )
    rng = np.random.default_rng(seed) if noise else None
    journey = _Journey(shift, data, deviation, noise or {}, rng, node_limit, progress, float(start[2]))
    parts, fine = journey.run(np.asarray(start, dtype=float))
    return ShiftRun(shift, parts, fine, judged(shift, data, parts, fine), data)


@dataclass(eq=False)
class _Journey:
    """The three stretches of a shift, one after the other."""

    shift: Shift
    data: Transmission
    deviation: Deviation
    noise: Mapping[str, float]
    rng: Any
    node_limit: int
    progress: Callable[[int, int], Any] | None
    force: float

    def run(self, start: Vector) -> tuple[tuple[Trajectory, ...], Vector]:
        release, first = self._part(1, start, _steps(self.shift.release))
        engage, second = self._part(2, release.x[-1], _steps(self.shift.engage) + _PATIENCE)
        lock, third = self._lock(engage.x[-1], engage.steps)
        return (release, engage, lock), np.vstack([*first.fine, *second.fine, *third.fine])

    def _part(self, part: int, x: Vector, steps: int) -> tuple[Trajectory, ShiftPlant]:
        plant = self._plant(part)
        mpc = shift_controller(self.shift, part, self.data, self.node_limit)
        since = 0.0 if part == 1 else self.shift.release.seconds
        controller = PartController(self.shift, part, self.data, mpc, since, self.force, self.noise, self.rng)
        run = closed_loop(
            plant, controller, x, steps, lambda k: k, on_failure=release_brake,
            stop=self._met if part == 2 else None, progress=self._told(part),
        )  # fmt: skip
        return run, plant

    def _plant(self, part: int) -> ShiftPlant:
        model = part_model(self.shift, part, self.data)
        return ShiftPlant(model, self.data, self.shift.gears[part - 1], self.deviation)

    def _met(self, _k: int, x: Vector) -> bool:
        return abs(self.data.relative_speed(self.shift.gears[1], x[4], x[5])) < _HANDED_TO_LOCK

    def _lock(self, x: Vector, _done: int) -> tuple[Trajectory, ShiftPlant]:
        plant = self._plant(2)
        wanted = self.shift.torques[1] * self.data.overall(self.shift.gears[1])

        def law(x: Vector, _ref: Any) -> Vector:
            """Close gently while the clutch slips, fully once it sticks; engine torque to its stationary value."""
            slip = self.data.relative_speed(self.shift.gears[1], x[4], x[5])
            close = _FAST if abs(slip) < 1e-6 else _GENTLE
            engine = np.clip((wanted - x[0]) / (10 * SAMPLE_TIME), -396.0, 495.0)
            return np.array([engine, -495.0, close])

        return closed_loop(plant, law, x, _LOCK_STEPS), plant

    def _told(self, part: int) -> Callable[[int, int], Any] | None:
        if self.progress is None:
            return None
        first, total = _steps(self.shift.release), _steps(self.shift.release) + _steps(self.shift.engage)
        before, told = (0 if part == 1 else first), self.progress
        return lambda k, _steps: told(min(before + k, total), total)


def _steps(part: Part) -> int:
    return round(part.seconds / SAMPLE_TIME)
