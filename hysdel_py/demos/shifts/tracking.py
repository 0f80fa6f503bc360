"""The engine with a closed clutch: the torque at the wheels that is wanted, and an end to swings of the drive shaft.

Engine, gearbox and flywheel on one side and the vehicle on the other swing against each other over the drive shaft,
whose own damping is weak: 1 to 2 % of the critical one. A step of the torque, or the step of the acceleration at
lock-up, would be seen for seconds. The engine torque opposes the rate of the twist, which is known from both speeds;
how strongly follows from the damping ratio that is wanted.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.transmission import Transmission, engine_limit
from hysdel_py.errors import ArgumentError

__all__ = ["DAMPING", "ClosedClutch"]

Vector = NDArray[np.float64]

DAMPING = 0.4
"""Damping ratio of the drive shaft that the engine provides."""
_SLOWEST, _FASTEST = -396.0, 495.0  # Nm/s, what the controllers of a shift allow the engine
_LEAST = 0.01


@dataclass(frozen=True, slots=True)
class ClosedClutch:
    """Law for the engine torque in a gear.

    Attributes
    ----------
    data : Transmission
    gear : int
    sample_time : float
        [s]
    damping : float
        Ratio to the critical damping of the drive shaft; 0 steers without looking.
    margin : float
        By how much the torque stays below the engine curve [Nm].

    Raises
    ------
    ArgumentError
        A damping below zero.
    """

    data: Transmission
    gear: int
    sample_time: float
    damping: float = DAMPING
    margin: float = 0.0

    def __post_init__(self) -> None:
        if not self.damping >= 0.0:
            raise ArgumentError(f"damping is {self.damping!r}: a number from 0 up was expected")

    @property
    def inertia(self) -> float:
        """Engine, shafts and flywheel, seen at the wheels [kg m^2]."""
        ratio = self.data.gears[self.gear]
        of_engine, of_shafts = self.data.inertia(self.gear) @ [1.0 / ratio, 1.0]
        return float(of_engine / ratio + of_shafts) / self.data.r_d**2

    @property
    def frequency(self) -> float:
        """Of the swings [rad/s]."""
        return sqrt(self.data.k * (1.0 / self.inertia + 1.0 / self.data.J_v))

    def rate(self, x: Vector, wanted: float) -> float:
        """Rate of the engine torque for the next sample [Nm/s].

        Parameters
        ----------
        x : array of shape (7,)
            State.
        wanted : float
            Torque of the drive shaft [Nm].
        """
        goal = self.data.rolling(self.gear, wanted, x[6])["Te"] + self._against_brake(x) - self._against_swings(x)
        goal = float(np.clip(goal, _LEAST, max(engine_limit(x[4]) - self.margin, _LEAST)))
        return float(np.clip((goal - x[0]) / self.sample_time, _SLOWEST, _FASTEST))

    def _against_brake(self, x: Vector) -> float:
        """Engine torque that makes up for what a brake on the flywheel takes from the closed gears."""
        ratio, torque = self.data.gears[self.gear], self.data.mu * x[1]
        return float(torque * abs(self.data.z * (ratio / self.data.r_gn - 1.0)))

    def _against_swings(self, x: Vector) -> float:
        """Engine torque that the rate of the twist asks for, beside the damping of the shaft itself."""
        asked = 2.0 * self.damping * self.frequency * self.inertia - self.data.d
        return float(max(asked, 0.0) * self.data.overall(self.gear) * (self.data.r_d * x[5] - x[6]))
