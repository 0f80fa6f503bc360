"""The end of a shift: the clutch of the new gear is closed for good, and the engine takes over."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.cases import Shift
from hysdel_py.demos.shifts.observer import ShiftObserver
from hysdel_py.demos.shifts.plant import SAMPLE_TIME
from hysdel_py.demos.shifts.sensors import Sensors
from hysdel_py.demos.shifts.tracking import ClosedClutch
from hysdel_py.demos.shifts.transmission import Transmission

__all__ = ["CLOSE", "CLOSE_SAMPLES", "HANDED_OVER", "LOCK_STEPS", "Lockup"]

Vector = NDArray[np.float64]

HANDED_OVER = 0.1
"""Relative speed from which on this law acts [rad/s]."""
CLOSE, CLOSE_SAMPLES = 1.0, 8
"""The same after so many samples below this relative speed [rad/s]: with a model that is off it may stay above zero."""
LOCK_STEPS = 30
_WAIT = 3  # samples in which engine and brake stay as they are, while the clutch meets its shaft
_GENTLE_STEPS = 5
_GENTLE, _FAST = 100.0, 792.0  # N/s
_ENGINE_AND_BRAKE = slice(0, 2)
_RELEASE = -495.0  # N/s, of a brake that is still on


class Lockup:
    """Law for the samples after part 2.

    The clutch closes a little faster than the controller of part 2 left it, until it must have stuck, and then fast.
    Engine and brake wait for that; then the brake is released, and the engine follows the torque with damping.

    Parameters
    ----------
    shift : Shift
    data : Transmission
    sensors : Sensors
        The engine torque stays below its curve by one standard deviation of its measurement.
    observer : ShiftObserver, optional
        What engine torque and brake force there are when the input acts.
    last : array of shape (3,), optional
        The input before the first one.
    """

    def __init__(
        self,
        shift: Shift,
        data: Transmission,
        sensors: Sensors,
        observer: ShiftObserver | None = None,
        last: Vector | None = None,
    ) -> None:
        margin = sensors.noise.get("Te", 0.0)
        self._engine = ClosedClutch(data, shift.gears[1], SAMPLE_TIME, margin=margin)
        self._wanted, self._sensors, self._k = shift.torques[1], sensors, 0
        self._observer, self._last = observer, np.zeros(3) if last is None else last

    def __call__(self, x: Vector, _ref: Any = None) -> Vector:
        """Rates for the next sample."""
        self._last = self._rates(self._seen(x), self._k)
        self._k += 1
        return self._last

    def _seen(self, x: Vector) -> Vector:
        seen = self._sensors.read(x)
        if self._observer is not None:
            seen[_ENGINE_AND_BRAKE] = self._observer.update(seen, self._last)[_ENGINE_AND_BRAKE]
        return seen

    def _rates(self, seen: Vector, k: int) -> Vector:
        close = _GENTLE if k < _GENTLE_STEPS else _FAST
        if k < _WAIT:
            return np.array([0.0, 0.0, close])
        return np.array([self._engine.rate(seen, self._wanted), _RELEASE, close])
