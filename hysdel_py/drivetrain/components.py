"""Components of drivetrains: frozen descriptions with names, connected by the names of their shafts.

An inertia declares a shaft of its own name; a gear also declares the shafts that it connects. `GROUND` is the housing.
Speeds are in rad/s, torques in Nm, inertias in kg m^2. The torque of a coupling (spring, clutch) is positive where it
drives the second shaft and brakes the first; its slip is the speed of the first less that of the second.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite, pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.drivetrain.laws import Coulomb, FrictionLaw, as_law
from hysdel_py.drivetrain.signals import Signal, SignalLike, as_signal
from hysdel_py.errors import ArgumentError

__all__ = [
    "GROUND", "Brake", "Clutch", "Component", "Contact", "EngineMap", "Gear", "Inertia", "Load", "OneWayClutch",
    "PlanetaryGear", "SpeedSource", "SpringDamper", "TorqueSource", "VehicleLoad",
]  # fmt: skip

GROUND = "ground"
"""Name of the housing, which does not turn."""

_GRAVITY = 9.81


def _number(component: Any, name: str, low: float, *, open_end: bool = False) -> None:
    """Check a number of a component against its lower end, which may be excluded."""
    value = getattr(component, name)
    words = f"above {low:g}" if open_end else f"{low:g} or more"
    good = isinstance(value, int | float) and isfinite(value) and (value > low if open_end else value >= low)
    if not good:
        raise ArgumentError(f"{type(component).__name__} {component.name}: {name} is {value!r}, {words} was expected")


def _set_signal(component: Any, name: str) -> None:
    given = getattr(component, name)
    object.__setattr__(component, name, as_signal(given, f"{name} of {type(component).__name__} {component.name}"))


@dataclass(frozen=True, slots=True)
class Inertia:
    """A rigid rotor on a shaft of its own name.

    Parameters
    ----------
    name : str
    inertia : float
        Moment of inertia [kg m^2], above zero.
    """

    name: str
    inertia: float

    def __post_init__(self) -> None:
        _number(self, "inertia", 0.0, open_end=True)


@dataclass(frozen=True, slots=True)
class SpringDamper:
    """A flexible coupling of two shafts; its twist is a state of its own name.

    Parameters
    ----------
    name, first, second : str
        The twist grows with the speed of `first` less that of `second`; either may be ``GROUND``.
    stiffness : float
        [Nm/rad], zero or more; without stiffness there is no twist.
    damping : float
        [Nm s/rad], zero or more.
    """

    name: str
    first: str
    second: str
    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        _number(self, "stiffness", 0.0)
        _number(self, "damping", 0.0)


@dataclass(frozen=True, slots=True)
class Gear:
    """A pair of gears: ``speed of input = ratio * speed of output``.

    A negative ratio reverses the direction. The shafts need no inertia of their own as long as they move one.
    """

    name: str
    input: str
    output: str
    ratio: float

    def __post_init__(self) -> None:
        if not (isinstance(self.ratio, int | float) and isfinite(self.ratio) and self.ratio != 0):
            raise ArgumentError(f"Gear {self.name}: ratio is {self.ratio!r}, a finite number other than 0 was expected")


@dataclass(frozen=True, slots=True)
class PlanetaryGear:
    """An epicyclic gear: ``sun + ratio * ring = (1 + ratio) * carrier``.

    Parameters
    ----------
    name, sun, carrier, ring : str
    ratio : float
        Teeth of the ring over teeth of the sun, above zero.
    """

    name: str
    sun: str
    carrier: str
    ring: str
    ratio: float

    def __post_init__(self) -> None:
        _number(self, "ratio", 0.0, open_end=True)


@dataclass(frozen=True, eq=False, slots=True)
class Clutch:
    """A dry friction clutch with given normal force.

    Parameters
    ----------
    name, driving, driven : str
    force : number, pairs (time, value), signal or function of time
        Normal force F_N [N]; values below zero count as zero: the clutch is open.
    friction : float or FrictionLaw
    radius : float
        Mean radius of the friction surfaces [m].
    surfaces : int
        Number of friction surfaces; the capacity is ``friction * radius * surfaces * force``.
    """

    name: str
    driving: str
    driven: str
    force: SignalLike
    friction: float | FrictionLaw = field(default_factory=Coulomb)
    radius: float = 1.0
    surfaces: int = 1

    def __post_init__(self) -> None:
        _finish_contact(self)


@dataclass(frozen=True, eq=False, slots=True)
class Brake:
    """A dry friction brake that holds a shaft against the housing; parameters as of :class:`Clutch`."""

    name: str
    shaft: str
    force: SignalLike
    friction: float | FrictionLaw = field(default_factory=Coulomb)
    radius: float = 1.0
    surfaces: int = 1

    def __post_init__(self) -> None:
        _finish_contact(self)


@dataclass(frozen=True, slots=True)
class OneWayClutch:
    """A freewheel: it transmits torque to the driven shaft and lets that one run ahead.

    Parameters
    ----------
    name, driving, driven : str
    capacity : float
        Torque [Nm] at which it slips; a lock-up at unequal speeds is over when this torque has made them equal.
    """

    name: str
    driving: str
    driven: str
    capacity: float

    def __post_init__(self) -> None:
        _number(self, "capacity", 0.0, open_end=True)


@dataclass(frozen=True, eq=False, slots=True)
class TorqueSource:
    """A given torque on a shaft; a load is a negative one."""

    name: str
    shaft: str
    torque: SignalLike

    def __post_init__(self) -> None:
        _set_signal(self, "torque")


@dataclass(frozen=True, eq=False, slots=True)
class SpeedSource:
    """A shaft of its own name whose speed is given, as a constant or a piecewise linear signal without jumps."""

    name: str
    speed: SignalLike

    def __post_init__(self) -> None:
        _set_signal(self, "speed")
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
        _number(self, "damping", 0.0)
        _number(self, "quadratic", 0.0)


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
        _set_signal(self, "throttle")
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
            _number(self, name, 0.0, open_end=True)
        for name in ("drag", "rolling"):
            _number(self, name, 0.0)
        if not (isfinite(self.slope) and abs(self.slope) < pi / 2):
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


Component = (
    Inertia | SpringDamper | Gear | PlanetaryGear | Clutch | Brake | OneWayClutch | TorqueSource | SpeedSource | Load
    | EngineMap | VehicleLoad
)  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True)
class Contact:
    """What clutches, brakes and freewheels have in common: a torque between two limits, one where slip is positive.

    Attributes
    ----------
    name, driving, driven : str
    law : FrictionLaw
    side : (float, float)
        Lower and upper limit of the torque as a share of the capacity: (-1, 1), or (0, 1) for a freewheel.
    pressure : Signal
    arm : float
        The capacity is friction coefficient times `arm` times `pressure`.
    """

    name: str
    driving: str
    driven: str
    law: FrictionLaw
    side: tuple[float, float]
    pressure: Signal
    arm: float


def _finish_contact(component: Any) -> None:
    _set_signal(component, "force")
    _number(component, "radius", 0.0, open_end=True)
    _number(component, "surfaces", 1)
    law = as_law(component.friction, f"friction of {type(component).__name__} {component.name}")
    object.__setattr__(component, "friction", law)
