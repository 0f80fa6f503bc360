"""What clutch and brake really grip: an estimate of both friction coefficients while a shift runs.

The models know one coefficient of friction, and a plant has another. As long as a contact slips, the accelerations of
engine and secondary shaft tell its torque. A Kalman filter with the states engine speed, secondary speed and two
factors, one of the clutch and one of the brake, follows them: given the measured forces and torques its equations are
linear, with coefficients that change from sample to sample.

The controllers then plan with effective forces, factor times force, for which their model is right.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.transmission import Transmission

__all__ = ["FrictionEstimate"]

Vector = NDArray[np.float64]

_RANGE = (0.6, 1.6)
_SPEED_NOISE = 0.2  # rad/s, of a measured speed
_SPEED_DRIFT = 0.1  # rad/s per sample that the equations may be off
_FACTOR_DRIFT = 0.01  # per sample
_FIRST_DOUBT = 0.15
_SLIPS = 1.0  # rad/s, from which the sign of a slip is certain


@dataclass(eq=False)
class FrictionEstimate:
    """Factors of the friction of clutch and brake, sample by sample.

    Parameters
    ----------
    data : Transmission
        Numbers of the model.
    gear : int
        In place; :meth:`change_gear` goes on in another one.
    sample_time : float
        [s]
    first : float
        Factor to begin with, of both.
    """

    data: Transmission
    gear: int
    sample_time: float
    first: float = 1.0
    factors: Vector = field(init=False)

    def __post_init__(self) -> None:
        self.factors = np.clip(np.full(2, self.first), *_RANGE)
        self._doubt = np.diag([_SPEED_NOISE**2] * 2 + [_FIRST_DOUBT**2] * 2)
        self._speeds: Vector | None = None
        self._before: Vector | None = None

    def change_gear(self, gear: int) -> None:
        """Go on in another gear; what is known of the friction stays."""
        self.gear, self._before = gear, None

    def update(self, x: Vector) -> Vector:
        """Take a measured state and return the factors of clutch and brake."""
        if self._before is None or self._speeds is None:
            self._restart(x)
        else:
            self._predict(self._before, x)
            self._correct(x[4:6])
        self._before = np.array(x, dtype=float)
        return self.factors

    def _restart(self, x: Vector) -> None:
        self._speeds = np.array(x[4:6], dtype=float)
        self._doubt[:2], self._doubt[:, :2] = 0.0, 0.0
        self._doubt[:2, :2] = _SPEED_NOISE**2 * np.eye(2)

    def _predict(self, x: Vector, x1: Vector) -> None:
        """Speeds one sample on, by the mean of what is measured at its ends."""
        mean = (x + x1) / 2
        solved = np.linalg.inv(self.data.inertia(self.gear)) * self.sample_time
        torque = self.data.k * mean[3] + self.data.d * (self.data.r_d * mean[5] - mean[6])
        by_factor = self.data.mu * np.column_stack([self._clutch(x, x1) * mean[2], self._brake(x, x1) * mean[1]])
        known = np.array([mean[0], -self.data.r_d * torque])
        assert self._speeds is not None
        self._speeds = self._speeds + solved @ (known + by_factor @ self.factors)
        step = np.eye(4)
        step[:2, 2:] = solved @ by_factor
        drift = np.array([_SPEED_DRIFT, _SPEED_DRIFT, _FACTOR_DRIFT, _FACTOR_DRIFT]) ** 2
        self._doubt = step @ self._doubt @ step.T + np.diag(drift)
        if self._sticks(x, x1):
            self._restart(x1)

    def _correct(self, measured: Vector) -> None:
        assert self._speeds is not None
        gain = self._doubt[:, :2] @ np.linalg.inv(self._doubt[:2, :2] + _SPEED_NOISE**2 * np.eye(2))
        surprise = measured - self._speeds
        self._speeds = self._speeds + gain[:2] @ surprise
        self.factors = np.clip(self.factors + gain[2:] @ surprise, *_RANGE)
        self._doubt = self._doubt - gain @ self._doubt[:2]

    def _clutch(self, x: Vector, x1: Vector) -> Vector:
        """Torques on engine and secondary shaft per torque of the clutch."""
        sign = np.sign(self._slip(x) + self._slip(x1))
        return np.array([-1.0, 1.0 / self.data.gears[self.gear]]) * sign

    def _brake(self, x: Vector, x1: Vector) -> Vector:
        """Torques on engine and secondary shaft per torque of the brake, through the planetary set."""
        speed = self.data.flywheel_speed(*((x + x1)[4:6] / 2))
        return np.array([self.data.z, -self.data.z / self.data.r_gn]) * np.sign(speed)

    def _slip(self, x: Vector) -> float:
        return self.data.relative_speed(self.gear, x[4], x[5])

    def _sticks(self, x: Vector, x1: Vector) -> bool:
        """Whether the clutch, while it carries torque, may have stuck or turned round within the sample."""
        return x1[2] > 1.0 and min(abs(self._slip(x)), abs(self._slip(x1))) < _SLIPS
