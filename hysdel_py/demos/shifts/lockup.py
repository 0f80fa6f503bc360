"""The end of a shift: the clutch of the new gear is closed for good, and the engine takes over."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.cases import Shift
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
    """

    def __init__(self, shift: Shift, data: Transmission, sensors: Sensors) -> None:
        self._engine = ClosedClutch(data, shift.gears[1], SAMPLE_TIME)
        self._wanted, self._sensors, self._k = shift.torques[1], sensors, 0

    def __call__(self, x: Vector, _ref: Any = None) -> Vector:
        """Rates for the next sample."""
        seen, k = self._sensors.read(x), self._k
        self._k += 1
        close = _GENTLE if k < _GENTLE_STEPS else _FAST
        if k < _WAIT:
            return np.array([0.0, 0.0, close])
        return np.array([self._engine.rate(seen, self._wanted), _RELEASE, close])
