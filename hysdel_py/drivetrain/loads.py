"""Sources and loads: given torques and speeds, engine maps, vehicles."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.drivetrain.checks import check_number, is_number, set_signal
from hysdel_py.drivetrain.contacts import GROUND, Contact
from hysdel_py.drivetrain.laws import Coulomb
from hysdel_py.drivetrain.signals import SignalLike, as_signal
from hysdel_py.errors import ArgumentError

__all__ = ["EngineMap", "Load", "SpeedSource", "TorqueSource", "VehicleLoad"]

_GRAVITY = 9.81


@dataclass(frozen=True, eq=False, slots=True)
class TorqueSource:
    """A given torque on a shaft; a load is a negative one."""

    name: str
    shaft: str
    torque: SignalLike

    def __post_init__(self) -> None:
        set_signal(self, "torque")


@dataclass(frozen=True, eq=False, slots=True)
class SpeedSource:
    """A shaft of its own name whose speed is given, as a constant or a piecewise linear signal without jumps."""

    name: str
    speed: SignalLike

    def __post_init__(self) -> None:
        set_signal(self, "speed")
        times = getattr(self.speed, "times", None)
        if times is None or len(np.unique(times)) < len(times):
            raise ArgumentError(
                f"SpeedSource {self.name}: a constant or piecewise linear speed without jumps is needed"
            )


@dataclass(frozen=True, slots=True)
class Load:
    """A torque against the motion: ``damping * speed + quadratic * speed * |speed|``."""

    name: str
    shaft: str
    damping: float = 0.0
    quadratic: float = 0.0

    def __post_init__(self) -> None:
        check_number(self, "damping", 0.0)
        check_number(self, "quadratic", 0.0)


@dataclass(frozen=True, eq=False, slots=True)
class EngineMap:
    """Torque of an engine by speed and throttle, bilinear between the points and held constant outside.

    Parameters
    ----------
    name, shaft : str
    speeds : array of shape (n,)
        [rad/s], strictly ascending, two or more.
    throttles : array of shape (k,)
        Strictly ascending, two or more.
    torques : array of shape (k, n)
        [Nm], one row for each throttle.
    throttle : number, pairs (time, value), signal or function of time
    """

    name: str
    shaft: str
    speeds: ArrayLike
    throttles: ArrayLike
    torques: ArrayLike
    throttle: SignalLike

    def __post_init__(self) -> None:
        set_signal(self, "throttle")
        for name in ("speeds", "throttles", "torques"):
            object.__setattr__(self, name, self._array(name))
        grid = (np.size(self.throttles), np.size(self.speeds))
        if np.shape(self.torques) != grid:
            raise ArgumentError(f"EngineMap {self.name}: torques have shape {np.shape(self.torques)}, not {grid}")
        for name in ("speeds", "throttles"):
            axis = np.asarray(getattr(self, name))
            if axis.ndim != 1 or axis.size < 2 or np.any(np.diff(axis) <= 0):
                raise ArgumentError(f"EngineMap {self.name}: {name} have to ascend strictly, two or more")

    def _array(self, name: str) -> NDArray[np.float64]:
        try:
            array = np.array(getattr(self, name), dtype=float)
        except (TypeError, ValueError):
            array = np.full(1, np.nan)
        if not np.all(np.isfinite(array)):
            raise ArgumentError(f"EngineMap {self.name}: {name} have to be finite numbers")
        array.setflags(write=False)
        return array


@dataclass(frozen=True, slots=True)
class VehicleLoad:
    """A vehicle on its wheels, on a shaft of its own name: inertia, air drag, slope and rolling resistance.

    Rolling resistance is dry friction against the ground: it holds the vehicle on a slope that is gentle enough.

    Parameters
    ----------
    name : str
    mass : float
        [kg]
    radius : float
        Of the wheels [m].
    drag : float
        Half of density times drag coefficient times area [kg/m]: force per squared speed.
    rolling : float
        Coefficient of rolling resistance.
    slope : float
        Angle of the road [rad], between -pi/2 and pi/2, positive uphill.
    """

    name: str
    mass: float
    radius: float
    drag: float = 0.0
    rolling: float = 0.0
    slope: float = 0.0

    def __post_init__(self) -> None:
        for name in ("mass", "radius"):
            check_number(self, name, 0.0, open_end=True)
        for name in ("drag", "rolling"):
            check_number(self, name, 0.0)
        if not (is_number(self.slope) and abs(self.slope) < pi / 2):
            raise ArgumentError(f"VehicleLoad {self.name}: slope is {self.slope!r}, an angle below pi/2 was expected")

    @property
    def inertia(self) -> float:
        """Mass as seen by the wheels [kg m^2]."""
        return self.mass * self.radius**2

    @property
    def downhill_torque(self) -> float:
        """Torque of gravity on the wheels [Nm], against the motion uphill."""
        return self.mass * _GRAVITY * self.radius * float(np.sin(self.slope))

    @property
    def rolling_contact(self) -> Contact:
        """Rolling resistance as a brake."""
        pressure = as_signal(self.mass * _GRAVITY * float(np.cos(self.slope)) * self.radius, self.name)
        return Contact(f"{self.name}_rolling", self.name, GROUND, Coulomb(self.rolling), (-1.0, 1.0), pressure, 1.0)
