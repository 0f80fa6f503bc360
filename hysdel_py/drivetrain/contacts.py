"""Clutches, brakes and freewheels: components with dry friction."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from hysdel_py.drivetrain.checks import check_number, set_signal
from hysdel_py.drivetrain.laws import Coulomb, FrictionLaw, as_law
from hysdel_py.drivetrain.signals import Signal, SignalLike
from hysdel_py.errors import ArgumentError

__all__ = ["GROUND", "Brake", "Clutch", "Contact", "OneWayClutch"]

GROUND = "ground"
"""Name of the housing, which does not turn."""


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
        check_number(self, "capacity", 0.0, open_end=True)


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
    set_signal(component, "force")
    check_number(component, "radius", 0.0, open_end=True)
    check_number(component, "surfaces", 1)
    if component.surfaces != int(component.surfaces):
        kind = type(component).__name__
        raise ArgumentError(f"{kind} {component.name}: surfaces is {component.surfaces!r}, a whole number was expected")
    law = as_law(component.friction, f"friction of {type(component).__name__} {component.name}")
    object.__setattr__(component, "friction", law)
