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
from hysdel_py.demos.shifts.controllers import NODE_LIMIT, part_model, release_brake
from hysdel_py.demos.shifts.judgement import Judgement, drive_torque, judged
from hysdel_py.demos.shifts.lockup import LOCK_STEPS
from hysdel_py.demos.shifts.methods import Method, first_state
from hysdel_py.demos.shifts.plant import SAMPLE_TIME, STEPS_PER_SAMPLE, Deviation, ShiftPlant
from hysdel_py.demos.shifts.ramps import RampTuning
from hysdel_py.demos.shifts.references import torque_reference
from hysdel_py.demos.shifts.sensors import Sensors
from hysdel_py.demos.shifts.transmission import STATES, Transmission
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["ShiftRun", "run_shift"]

Vector = NDArray[np.float64]

_PATIENCE = 60  # samples that part 2 may take beyond its length in the document


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
    controller : str
        Who ran it.
    """

    shift: Shift
    parts: tuple[Trajectory, ...]
    fine: Vector
    judgement: Judgement
    data: Transmission
    controller: str = "hybrid"

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
        return {"shift": self.shift.name, "controller": self.controller} | self.judgement.figures()

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
    controller: str = "hybrid",
    deviation: Deviation | None = None,
    noise: Mapping[str, float] | None = None,
    seed: int = 0,
    observed: bool = True,
    node_limit: int = NODE_LIMIT,
    tuning: RampTuning | None = None,
    progress: Callable[[int, int], Any] | None = None,
) -> ShiftRun:
    """Run a shift on the plant with stick and slip.

    Parameters
    ----------
    shift : Shift
    start : array of shape (7,), optional
        State of the plant; that of the shift by default.
    data : Transmission, optional
    controller : str
        One of :data:`hysdel_py.demos.shifts.methods.METHODS`.
    deviation : Deviation, optional
        Where the plant differs from the model of the controllers.
    noise : mapping of state to float, optional
        Standard deviations of the measurement.
    seed : int
        Of the noise.
    observed : bool
        Whether an observer tells the controllers what clutch and brake really grip, what is behind the noise, and
        where the plant is when a delayed input begins to act.
    node_limit : int
        Nodes of the branch and bound per move.
    tuning : RampTuning, optional
        Of the ramps.
    progress : callable, optional
        Called with the step and the number of steps.
    """
    data, deviation = data or Transmission(), deviation or Deviation()
    begin = first_state(shift, data, deviation.friction) if start is None else np.asarray(start, dtype=float)
    method = Method(
        shift, data, controller, begin, Sensors(noise or {}, seed), deviation.delay, observed=observed,
        just_sticks=start is None, node_limit=node_limit, tuning=tuning or RampTuning(),
    )  # fmt: skip
    parts, fine = _Journey(method, deviation, progress).run(begin)
    return ShiftRun(shift, parts, fine, judged(shift, data, parts, fine), data, controller)


@dataclass(eq=False)
class _Journey:
    """The three stretches of a shift, one after the other."""

    method: Method
    deviation: Deviation
    progress: Callable[[int, int], Any] | None

    def run(self, start: Vector) -> tuple[tuple[Trajectory, ...], Vector]:
        shift = self.method.shift
        release, first = self._part(1, start, _steps(shift.release), np.zeros(3))
        engage, second = self._part(2, release.x[-1], _steps(shift.engage) + _PATIENCE, first.last)
        third = self._plant(2, second.last)
        lock = closed_loop(third, self.method.lockup(), engage.x[-1], LOCK_STEPS)
        return (release, engage, lock), np.vstack([*first.fine, *second.fine, *third.fine])

    def _part(self, part: int, x: Vector, steps: int, last: Vector) -> tuple[Trajectory, ShiftPlant]:
        plant = self._plant(part, last)
        run = closed_loop(
            plant, self.method.controller(part), x, steps, lambda k: k, on_failure=release_brake,
            stop=self.method.met if part == 2 else None, progress=self._told(part),
        )  # fmt: skip
        return run, plant

    def _plant(self, part: int, last: Vector) -> ShiftPlant:
        shift, data = self.method.shift, self.method.data
        plant = ShiftPlant(part_model(shift, part, data), data, shift.gears[part - 1], self.deviation)
        plant.last = last
        return plant

    def _told(self, part: int) -> Callable[[int, int], Any] | None:
        if self.progress is None:
            return None
        shift = self.method.shift
        first, total = _steps(shift.release), _steps(shift.release) + _steps(shift.engage)
        before, told = (0 if part == 1 else first), self.progress
        return lambda k, _steps: told(min(before + k, total), total)


def _steps(part: Part) -> int:
    return round(part.seconds / SAMPLE_TIME)
