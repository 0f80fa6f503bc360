"""Who runs a shift: the hybrid controllers of the document, or one of those that they are compared with.

* ``hybrid``: both controllers of the document, with the switches of the models as decisions.
* ``linear``: the same weights, limits and horizon, with the sequence of modes fixed beforehand; see
  :mod:`hysdel_py.demos.shifts.fixed_modes`.
* ``ramps``: what is done without a predictive controller; see :mod:`hysdel_py.demos.shifts.ramps`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.cases import Shift
from hysdel_py.demos.shifts.controllers import NO_RULE, NODE_LIMIT, PartController, shift_controller
from hysdel_py.demos.shifts.fixed_modes import FixedModes, linear_controller
from hysdel_py.demos.shifts.lockup import CLOSE, CLOSE_SAMPLES, HANDED_OVER, Lockup
from hysdel_py.demos.shifts.observer import ShiftObserver
from hysdel_py.demos.shifts.plant import SAMPLE_TIME
from hysdel_py.demos.shifts.ramps import RampController, RampTuning
from hysdel_py.demos.shifts.release_program import least_deviation
from hysdel_py.demos.shifts.sensors import Sensors
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.errors import ArgumentError

__all__ = ["METHODS", "Method", "first_state"]

Vector = NDArray[np.float64]

METHODS = ("hybrid", "linear", "ramps")
"""Names of the controllers."""
_CLUTCH = 2
_PASSES = 1.2  # rad/s in a sample: the engine passes the new gear, as it does in a downshift
_GUARDED = (1.0, 0.5, 0.0)
"""Shares of the slip of the guard, of which the first that leaves a plan is taken."""


def first_state(shift: Shift, data: Transmission, grip: float = 1.0) -> Vector:
    """State of the plant in which a shift begins; the clutch just sticks, with the friction that it has."""
    begin = data.rolling if shift.rolling else data.stationary
    state = np.array(list(begin(shift.gears[0], shift.torques[0], shift.speed).values()))
    state[_CLUTCH] /= grip
    return state


@dataclass(eq=False)
class Method:
    """The controllers of both parts, and what they share.

    Parameters
    ----------
    shift : Shift
    data : Transmission
    name : str
        One of METHODS.
    start : array of shape (7,)
        First state of the plant.
    sensors : Sensors
    delay : float
        Seconds until an input takes effect, as far as the controllers know.
    observed : bool
        Whether an observer stands between measurement and controllers.
    just_sticks : bool
        Whether the clutch has no force to spare when the shift begins.
    node_limit : int
    tuning : RampTuning, optional
        Of the ramps.

    Raises
    ------
    ArgumentError
        Another name.
    """

    shift: Shift
    data: Transmission
    name: str
    start: Vector
    sensors: Sensors
    delay: float = 0.0
    observed: bool = True
    just_sticks: bool = True
    node_limit: int = NODE_LIMIT
    tuning: RampTuning = field(default_factory=RampTuning)
    _observer: ShiftObserver | None = field(init=False, default=None)
    _planned: PartController | None = field(init=False, default=None)
    _close: int = field(init=False, default=0)
    _before: float | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        if self.name not in METHODS:
            raise ArgumentError(f"controller is {self.name!r}: one of {', '.join(METHODS)} was expected")
        if self.observed:
            gear, grip = self.shift.gears[0], self._first_grip()
            self._observer = ShiftObserver(self.data, gear, SAMPLE_TIME, grip, self.delay, settled=self.just_sticks)

    def controller(self, part: int) -> Any:
        """The controller of part 1 or 2."""
        if self._observer is not None and part == 2:
            self._observer.change_gear(self.shift.gears[1])
        if self.name == "ramps":
            return RampController(self.shift, part, self.data, self.sensors, self.start, self.tuning)
        since = 0.0 if part == 1 else self.shift.release.seconds
        last = np.zeros(3) if self._planned is None else self._planned.last
        self._planned = PartController(
            self.shift, part, self.data, self._mpc(part), since, self._force(), self._forces(part), self.sensors,
            self._observer, self._modes(part), last, self._without_rule(part),
        )  # fmt: skip
        return self._planned

    def lockup(self) -> Lockup:
        """What follows part 2."""
        if self._planned is None:
            return Lockup(self.shift, self.data, self.sensors)
        return Lockup(self.shift, self.data, self.sensors, self._observer, self._planned.last)

    def met(self, _k: int, x: Vector) -> bool:
        """Whether the speeds of engine and new gear have met as far as is known, or are close and stay so."""
        relative, doubt = self._relative(x)
        passes = self._before is not None and abs(relative - self._before) > _PASSES
        self._before = relative
        self._close = self._close + 1 if abs(relative) < CLOSE else 0
        return (abs(relative) < HANDED_OVER + doubt and not passes) or self._close > CLOSE_SAMPLES

    def _relative(self, x: Vector) -> tuple[float, float]:
        """Relative speed, estimated where measurements are noisy, and the standard deviation of a measured one."""
        gear, seen = self.shift.gears[1], self.sensors.read(x)
        engine, secondary = (self.sensors.noise.get(name, 0.0) for name in ("we", "ws"))
        doubt = float(np.hypot(engine, secondary / self.data.gears[gear]))
        if self._observer is not None and doubt > 0.0:
            seen[4:6] = self._observer.shafts
        return self.data.relative_speed(gear, seen[4], seen[5]), doubt

    def _mpc(self, part: int) -> Any:
        if self.name == "linear":
            return linear_controller(self.shift, part, self.data)
        return shift_controller(self.shift, part, self.data, self.node_limit)

    def _without_rule(self, part: int) -> Callable[[], Any] | None:
        if self.name == "linear" or part == 1:
            return None
        return lambda: shift_controller(self.shift, part, self.data, self.node_limit, NO_RULE)

    def _modes(self, part: int) -> FixedModes | None:
        if self.name != "linear" or part == 1:
            return None
        own = self.shift.engage.brake_force
        return FixedModes(0.99 * self.shift.force if own is None else own)

    def _first_grip(self) -> float:
        """A clutch that just sticks tells its friction by its force, before anything slips."""
        if not self.just_sticks:
            return 1.0
        return self._carried() / max(self.data.mu * float(self.start[_CLUTCH]), 1.0)

    def _carried(self) -> float:
        return self.data.stuck_clutch(self.shift.gears[0], self.start)

    def _force(self) -> float:
        """Effective clutch force at the begin [N]."""
        share = 1.0 if self._observer is None else self._first_grip()
        return share * float(self.start[_CLUTCH])

    def _forces(self, part: int) -> Vector | None:
        """Effective clutch force of part 1 where engine and brake cannot carry the torque at once [N]."""
        if part == 2 or self.shift.guard is None:
            return None
        grip = 1.0 if self._observer is None else min(self._first_grip(), 1.0)
        data, start = replace(self.data, mu=grip * self.data.mu), self.start.copy()
        start[_CLUTCH] = max(self._carried() / data.mu, 0.0)
        for share in _GUARDED:
            guard = replace(self.shift.guard, slip=share * self.shift.guard.slip)
            try:
                plan = least_deviation(replace(self.shift, guard=guard), data, start, guard.open_by)
            except ArgumentError:  # the start leaves no such plan
                continue
            return np.asarray(plan.x[:, _CLUTCH] / self.data.mu, dtype=float)
        return None  # the clutch force follows zero, as in the other shifts
