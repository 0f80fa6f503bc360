"""A drive: the supervisor picks gears and torques along a pedal trace, and every shift runs under its controllers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model
from hysdel_py.demos.shifts.judgement import drive_torque
from hysdel_py.demos.shifts.plant import FINE, STEPS_PER_SAMPLE, ShiftPlant
from hysdel_py.demos.shifts.shift import ShiftRun, run_shift
from hysdel_py.demos.shifts.supervisor import Decision, Supervisor
from hysdel_py.demos.shifts.tracking import DAMPING, ClosedClutch
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["PEDAL", "DriveRun", "drive"]

Vector = NDArray[np.float64]

PEDAL = ((0.0, 0.7), (7.0, 0.7), (7.5, 0.22), (12.0, 0.22), (12.3, 1.0), (17.0, 1.0))
"""Pairs of second and pedal: away through the gears, slow roll, kick-down."""
START_SPEED = 12.0
SAMPLE_TIME = 0.02
"""Of the drive between two shifts [s]."""
_WANTED_RATE = 1500.0  # Nm/s of the wanted torque at the wheels between shifts
_CLOSED = 1.05  # clutch force between shifts as a share of what sticking needs
_LEAST_FORCE = 20.0


@dataclass(frozen=True, eq=False)
class DriveRun:
    """A drive.

    Attributes
    ----------
    t : array of shape (n,)
        [s]
    fine : array of shape (n, len(FINE))
    gear, pedal, wanted : arrays of shape (n,)
        Gear in place, pedal, torque that the supervisor wants [Nm].
    shifts : tuple of (float, ShiftRun)
        Each with its begin.
    decisions : tuple of (float, Decision)
        Shifts begun and refused, each change of mind once.
    data : Transmission
    """

    t: Vector
    fine: Vector
    gear: Vector
    pedal: Vector
    wanted: Vector
    shifts: tuple[tuple[float, ShiftRun], ...]
    decisions: tuple[tuple[float, Decision], ...]
    data: Transmission

    @property
    def done(self) -> bool:
        """Whether every shift that was begun ended with a locked clutch."""
        return all(run.done for _, run in self.shifts)

    @property
    def torque(self) -> Vector:
        """Torque of the drive shaft [Nm]."""
        return drive_torque(self.data, self.fine)

    def figures(self) -> dict[str, Any]:
        """The figures as plain data."""
        wv = self.fine[:, FINE.index("wv")]
        return {
            "done": self.done,
            "seconds": float(self.t[-1]),
            "wheels_first": float(wv[0]), "wheels_most": float(wv.max()), "wheels_last": float(wv[-1]),
            "shifts": [{"begin": begin} | run.figures() for begin, run in self.shifts],
            "decisions": [{"time": t, "gear": d.gear, "torque": d.torque, "shift": d.shift is not None,
                           "reason": d.reason} for t, d in self.decisions],
        }  # fmt: skip

    def table(self) -> list[tuple[str, str]]:
        """The figures as lines of text and value."""
        f = self.figures()
        speeds = f"{f['wheels_first']:.1f}, {f['wheels_most']:.1f}, {f['wheels_last']:.1f} rad/s"
        lines = [("time", f"{f['seconds']:.1f} s"), ("speed of the wheels: first, greatest, last", speeds)]
        for begin, run in self.shifts:
            lines.append((f"{begin:6.2f} s: shift {run.shift.name}", _told(run)))
        refused = [(f"{t:6.2f} s: no shift", d.reason) for t, d in self.decisions if d.shift is None]
        return lines + refused

    def plot(self) -> Figure:
        """Pedal, gears, speeds and torque over time."""
        from hysdel_py.plotting.shift import plot_drive

        return plot_drive(self)


def _told(run: ShiftRun) -> str:
    j, (before, after) = run.judgement, run.shift.torques
    end = "not locked" if j.shift_time is None else f"locked after {j.shift_time:.2f} s"
    off = max(j.deviation_release, j.deviation_engage)
    return f"{before:.0f} to {after:.0f} Nm, {end}, torque off by {off:.0f} Nm at most"


def drive(
    pedal: Sequence[tuple[float, float]] = PEDAL,
    start: float = START_SPEED,
    supervisor: Supervisor | None = None,
    *,
    damping: float = DAMPING,
    progress: Callable[[int, int], Any] | None = None,
) -> DriveRun:
    """Drive along a pedal trace, from first gear with the clutch closed.

    Parameters
    ----------
    pedal : sequence of (second, pedal)
        Straight lines in between; the drive ends with the last one.
    start : float
        Speed of the wheels [rad/s].
    supervisor : Supervisor, optional
    damping : float
        Ratio of the damping of the drive shaft that the engine provides between shifts.
    progress : callable, optional
        Called with the hundredths of a second that are done, and all of them.

    Raises
    ------
    ArgumentError
        The times of the pedal do not ascend from 0.
    """
    times = [t for t, _ in pedal]
    if len(times) < 2 or times[0] != 0.0 or any(b <= a for a, b in pairwise(times)):
        raise ArgumentError("the times of the pedal have to ascend from 0, two or more")
    return _Drive(tuple(pedal), supervisor or Supervisor(), damping, progress).run(start)


class _Drive:
    """A drive as it grows."""

    def __init__(
        self, pedal: tuple[tuple[float, float], ...], supervisor: Supervisor, damping: float, progress: Any
    ) -> None:
        self._pedal, self._supervisor, self._damping, self._progress = pedal, supervisor, damping, progress
        self._data, self._wanted = supervisor.data, 0.0
        self._t, self._gear, self._last_shift = 0.0, 1, -10.0
        self._pieces: list[tuple[Vector, Vector, int, float]] = []
        self._shifts: list[tuple[float, ShiftRun]] = []
        self._decisions: list[tuple[float, Decision]] = []
        self._plants: dict[int, ShiftPlant] = {}

    def run(self, start: float) -> DriveRun:
        end = self._pedal[-1][0]
        x = np.array(list(self._data.stationary(1, self._data.b_v * start, start).values()))
        x[2], self._wanted = _LEAST_FORCE, self._data.b_v * start
        while self._t < end - 1e-9:
            decision = self._asked(x)
            x = self._shift(decision) if self._begins(decision, x) else self._roll(x, decision.torque)
            if self._progress is not None:
                self._progress(min(round(100 * self._t), round(100 * end)), round(100 * end))
        return self._finished()

    def _pedal_at(self, t: Any) -> Any:
        times, values = np.array(self._pedal).T
        return np.interp(t, times, values)

    def _asked(self, x: Vector) -> Decision:
        torque = float(drive_torque(self._data, x[None, :])[0])
        self._x = x
        return self._supervisor.decide(
            self._gear, float(x[6]), float(self._pedal_at(self._t)), torque, self._t - self._last_shift
        )

    def _begins(self, decision: Decision, _x: Vector) -> bool:
        """Whether a shift begins; new reasons are kept."""
        told = [d.reason.split(":")[0] for _, d in self._decisions[-1:]]
        if decision.shift is not None or ("refused" in decision.reason and decision.reason.split(":")[0] not in told):
            self._decisions.append((round(self._t, 6), decision))
        return decision.shift is not None

    def _shift(self, decision: Decision) -> Vector:
        shift = decision.shift
        assert shift is not None
        run = run_shift(shift, self._x, self._data)
        self._shifts.append((round(self._t, 6), run))
        changed = run.parts[0].steps * STEPS_PER_SAMPLE
        for rows, gear in ((slice(0, changed), shift.gears[0]), (slice(changed, None), shift.gears[1])):
            self._pieces.append((self._t + run.t[rows], run.fine[rows], gear, decision.torque))
        self._t += float(run.t[-1])
        self._gear, self._last_shift, self._wanted = shift.gears[1], self._t, shift.torques[1]
        return run.end

    def _roll(self, x: Vector, torque: float) -> Vector:
        """One sample with the clutch closed: the engine follows the wanted torque, the clutch the engine."""
        plant = self._plant()
        step = _WANTED_RATE * SAMPLE_TIME
        self._wanted += float(np.clip(torque - self._wanted, -step, step))
        rate = ClosedClutch(self._data, self._gear, SAMPLE_TIME, self._damping).rate(x, self._wanted)
        force = max(_LEAST_FORCE, _CLOSED * (x[0] + SAMPLE_TIME * max(rate, 0.0)) / self._data.mu)
        x1 = plant.step(x, np.array([rate, -400.0, np.clip((force - x[2]) / SAMPLE_TIME, -495.0, 792.0)]))
        rows = plant.fine.pop()
        times = self._t + SAMPLE_TIME / STEPS_PER_SAMPLE * np.arange(1, len(rows) + 1)
        self._pieces.append((np.asarray(times, dtype=float), rows, self._gear, torque))
        self._t += SAMPLE_TIME
        return x1

    def _plant(self) -> ShiftPlant:
        if self._gear not in self._plants:
            model = part_model(SHIFTS["upshift-12"], 2, self._data)
            self._plants[self._gear] = ShiftPlant(model, self._data, self._gear, sample_time=SAMPLE_TIME)
        return self._plants[self._gear]

    def _finished(self) -> DriveRun:
        t = np.concatenate([piece[0] for piece in self._pieces])
        sizes = [len(piece[0]) for piece in self._pieces]
        gear, wanted = (np.repeat([float(piece[i]) for piece in self._pieces], sizes) for i in (2, 3))
        fine = np.vstack([piece[1] for piece in self._pieces])
        pedal: Vector = self._pedal_at(t)
        return DriveRun(t, fine, gear, pedal, wanted, tuple(self._shifts), tuple(self._decisions), self._data)
