"""Components of drivetrains: frozen descriptions with names, connected by the names of their shafts.

An inertia declares a shaft of its own name; a gear also declares the shafts that it connects. `GROUND` is the housing.
Speeds are in rad/s, torques in Nm, inertias in kg m^2. The torque of a coupling (spring, clutch) is positive where it
drives the second shaft and brakes the first; its slip is the speed of the first less that of the second.
"""

from __future__ import annotations

from dataclasses import dataclass

from hysdel_py.drivetrain.checks import check_number, is_number
from hysdel_py.drivetrain.contacts import GROUND, Brake, Clutch, Contact, OneWayClutch
from hysdel_py.drivetrain.loads import EngineMap, Load, SpeedSource, TorqueSource, VehicleLoad
from hysdel_py.errors import ArgumentError

__all__ = [
    "GROUND", "Brake", "Clutch", "Component", "Contact", "EngineMap", "Gear", "Inertia", "Load", "OneWayClutch",
    "PlanetaryGear", "SpeedSource", "SpringDamper", "TorqueSource", "VehicleLoad",
]  # fmt: skip


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
        check_number(self, "inertia", 0.0, open_end=True)


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
        check_number(self, "stiffness", 0.0)
        check_number(self, "damping", 0.0)


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
        if not (is_number(self.ratio) and self.ratio != 0):
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
        check_number(self, "ratio", 0.0, open_end=True)


Component = (
    Inertia | SpringDamper | Gear | PlanetaryGear | Clutch | Brake | OneWayClutch | TorqueSource | SpeedSource | Load
    | EngineMap | VehicleLoad
)  # fmt: skip
