"""One sampled step of a dry clutch between an engine and a vehicle, for many states at once.

``J1 w1' = T1 - Tc``, ``J2 w2' = Tc - b w2``; the clutch transmits any torque up to its capacity while it sticks, and
the capacity against the slip while it slips. The states are the two speeds, the inputs the capacity and, where asked
for, the engine torque. Numbers are those of section 9.1 of J.R.P. Kusters, "Modelling and coordinated control of
advanced automotive transmissions", TU/e, DCT 2005-58, as far as given there, else those of its clutch models.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["DryClutch"]

Matrix = NDArray[np.float64]
Scheme = Literal["exact", "implicit"]

NO_SLIP = 1e-9  # rad/s; below this the speeds are equal
_HALVINGS = 50


@dataclass(frozen=True, slots=True)
class DryClutch:
    """A step of the clutch as a function of rows.

    Attributes
    ----------
    engine_inertia, vehicle_inertia : float
        J1, J2 [kg m^2].
    drag : float
        b [Nm s/rad].
    engine_torque : float
        T1 [Nm], where it is no input.
    sample_time : float
        [s]
    scheme : {"exact", "implicit"}
        "exact" solves the equations over the step, with lock-up and break-away inside it. "implicit" is one implicit
        Euler step with the friction impulse cut to its limits.
    """

    engine_inertia: float = 0.2
    vehicle_inertia: float = 0.8
    drag: float = 0.67
    engine_torque: float = 100.0
    sample_time: float = 0.05
    scheme: Scheme = "exact"

    def __call__(self, x: Matrix, u: Matrix) -> Matrix:
        """Speeds after a step; ``u`` has the columns capacity and, optionally, engine torque."""
        T1 = u[:, 1] if u.shape[1] > 1 else np.full(len(u), self.engine_torque)
        capacity = np.maximum(u[:, 0], 0.0)
        return self._implicit(x, capacity, T1) if self.scheme == "implicit" else self._exact(x, capacity, T1)

    def slip_acceleration(self, x: Matrix, u: Matrix) -> Matrix:
        """Rate of the relative speed while the engine is the faster side [rad/s^2]."""
        T1 = u[:, 1] if u.shape[1] > 1 else self.engine_torque
        return np.asarray(
            (T1 - u[:, 0]) / self.engine_inertia - (u[:, 0] - self.drag * x[:, 1]) / self.vehicle_inertia
        )  # fmt: skip

    def stick_torque(self, speed: Matrix, T1: Matrix) -> Matrix:
        """Torque that the clutch has to transmit to keep the speeds equal [Nm]."""
        J1, J2 = self.engine_inertia, self.vehicle_inertia
        return np.asarray((T1 * J2 + self.drag * speed * J1) / (J1 + J2))

    def _implicit(self, x: Matrix, capacity: Matrix, T1: Matrix) -> Matrix:
        dt, J1 = self.sample_time, self.engine_inertia
        J2 = self.vehicle_inertia + dt * self.drag
        w1, w2 = x[:, 0] + dt * T1 / J1, x[:, 1] * self.vehicle_inertia / J2
        impulse = np.clip((w1 - w2) / (1.0 / J1 + 1.0 / J2), -capacity * dt, capacity * dt)
        return np.stack([w1 - impulse / J1, w2 + impulse / J2], axis=1)

    def _exact(self, x: Matrix, capacity: Matrix, T1: Matrix) -> Matrix:
        """Slip until lock-up, stick until break-away, slip for the rest of the step."""
        whole = np.full(len(x), self.sample_time)
        slip = x[:, 0] - x[:, 1]
        sign = np.where(slip < -NO_SLIP, -1.0, 1.0)
        slipping = np.abs(slip) > NO_SLIP
        until = np.where(slipping, self._lock_time(x, sign * capacity, T1, sign), 0.0)
        after = np.where(slipping[:, None], self._slipped(x, sign * capacity, T1, until), x)
        rest = whole - until
        met = rest > 0
        speed = after[:, 1]
        held = np.where(met, self._hold_time(speed, capacity, T1, rest), 0.0)
        together = self._stuck(speed, T1, held)
        joined = np.where(met[:, None], np.stack([together, together], axis=1), after)
        return self._slipped(joined, capacity, T1, np.where(met, rest - held, 0.0))

    def _slipped(self, x: Matrix, torque: Matrix, T1: Matrix, t: Matrix) -> Matrix:
        decay = np.exp(-self.drag / self.vehicle_inertia * t)
        w1 = x[:, 0] + (T1 - torque) / self.engine_inertia * t
        return np.stack([w1, x[:, 1] * decay + torque / self.drag * (1.0 - decay)], axis=1)

    def _stuck(self, speed: Matrix, T1: Matrix, t: Matrix) -> Matrix:
        decay = np.exp(-self.drag / (self.engine_inertia + self.vehicle_inertia) * t)
        return np.asarray(speed * decay + T1 / self.drag * (1.0 - decay))

    def _lock_time(self, x: Matrix, torque: Matrix, T1: Matrix, sign: Matrix) -> Matrix:
        """First time at which the speeds meet, or the whole step.

        The rate of the slip is monotone in time, so that there is one crossing before the slip's turning point or none.
        """
        bound = np.minimum(self._turning_time(x, torque, T1), self.sample_time)
        low, high = np.zeros(len(x)), bound.copy()
        meets = self._slip(x, torque, T1, bound) * sign <= 0
        i = np.flatnonzero(meets)
        for _ in range(_HALVINGS if len(i) else 0):
            middle = 0.5 * (low[i] + high[i])
            open_still = self._slip(x[i], torque[i], T1[i], middle) * sign[i] > 0
            low[i], high[i] = np.where(open_still, middle, low[i]), np.where(open_still, high[i], middle)
        return np.where(meets, high, self.sample_time)

    def _slip(self, x: Matrix, torque: Matrix, T1: Matrix, t: Matrix) -> Matrix:
        after = self._slipped(x, torque, T1, t)
        return np.asarray(after[:, 0] - after[:, 1])

    def _turning_time(self, x: Matrix, torque: Matrix, T1: Matrix) -> Matrix:
        """Time at which the slip turns, infinite where it does not."""
        rate, engine = self.drag / self.vehicle_inertia, (T1 - torque) / self.engine_inertia
        vehicle = (torque - self.drag * x[:, 1]) / self.vehicle_inertia
        turns = (engine != 0) & (vehicle / np.where(engine != 0, engine, 1.0) > 1.0)
        ratio = np.where(turns, vehicle / np.where(turns, engine, 1.0), 1.0)
        return np.where(turns, np.log(ratio) / rate, np.inf)

    def _hold_time(self, speed: Matrix, capacity: Matrix, T1: Matrix, rest: Matrix) -> Matrix:
        """How long the clutch sticks: until the torque it has to transmit outgrows its capacity."""
        J1, J2, b = self.engine_inertia, self.vehicle_inertia, self.drag
        final, limit = T1 / b, (capacity * (J1 + J2) - T1 * J2) / (b * J1)
        at_once = speed > limit
        later = (final > limit) & (speed < limit)
        ratio = np.where(later, (final - speed) / np.where(later, final - limit, 1.0), 1.0)
        return np.where(at_once, 0.0, np.where(later, np.minimum(np.log(ratio) * (J1 + J2) / b, rest), rest))
