"""Friction laws: how large the torque of a sliding contact is, and how much a sticking one can hold.

A law knows nothing of the scheme. For a normal force F_N and a mean radius r it gives the set of torques

    T in mu_d(|gamma|) r F_N Sign(gamma)   while the contact slides, gamma != 0
    |T| <= mu_s r F_N                      while it sticks, gamma = 0

with the relative speed gamma. Where mu_d(0+) = mu_s this is one maximal monotone relation if mu_d does not fall.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp
from typing import Any

from hysdel_py.drivetrain.checks import is_number
from hysdel_py.errors import ArgumentError

__all__ = ["Coulomb", "FrictionLaw", "Stribeck", "as_law"]


@dataclass(frozen=True, slots=True)
class Coulomb:
    """Dry friction that does not depend on the sliding speed.

    Parameters
    ----------
    static : float
        Friction coefficient of the sticking contact, zero or more.
    dynamic : float, optional
        That of the sliding contact, at most the static one and equal to it by default.

    Raises
    ------
    ArgumentError
        A coefficient is negative or not finite, or the dynamic one exceeds the static one.
    """

    static: float = 1.0
    dynamic: float | None = None

    def __post_init__(self) -> None:
        _check_coefficients(self.static, self.static if self.dynamic is None else self.dynamic)

    @property
    def parameters(self) -> tuple[float, float, float, float]:
        """Static and dynamic coefficient, decay speed (zero: at once) and exponent."""
        return (float(self.static), float(self.static if self.dynamic is None else self.dynamic), 0.0, 1.0)

    def sliding(self, speed: float) -> float:
        """Friction coefficient at a sliding speed."""
        return self.parameters[1] if speed else self.parameters[0]


@dataclass(frozen=True, slots=True)
class Stribeck:
    """Dry friction that falls from the static to the dynamic coefficient as the contact speeds up.

    ``mu(v) = dynamic + (static - dynamic) exp(-(|v|/speed)^exponent)``

    Parameters
    ----------
    static, dynamic : float
        Friction coefficients, ``static >= dynamic >= 0``.
    speed : float
        Speed [rad/s] over which friction falls, above zero.
    exponent : float
        1 or 2 as a rule.

    Raises
    ------
    ArgumentError
        A parameter is outside its range or not finite.
    """

    static: float
    dynamic: float
    speed: float
    exponent: float = 1.0

    def __post_init__(self) -> None:
        _check_coefficients(self.static, self.dynamic)
        for name, value in (("speed", self.speed), ("exponent", self.exponent)):
            if not (is_number(value) and value > 0):
                raise ArgumentError(f"{name} of a Stribeck law is {value!r}: a finite number above zero was expected")

    @property
    def parameters(self) -> tuple[float, float, float, float]:
        """Static and dynamic coefficient, decay speed and exponent."""
        return (float(self.static), float(self.dynamic), float(self.speed), float(self.exponent))

    def sliding(self, speed: float) -> float:
        """Friction coefficient at a sliding speed."""
        return self.dynamic + (self.static - self.dynamic) * exp(-((abs(speed) / self.speed) ** self.exponent))


FrictionLaw = Coulomb | Stribeck


def _check_coefficients(static: Any, dynamic: Any) -> None:
    for name, value in (("static", static), ("dynamic", dynamic)):
        if not (is_number(value) and value >= 0):
            raise ArgumentError(f"{name} friction coefficient is {value!r}: zero or more was expected")
    if dynamic > static:
        raise ArgumentError(f"dynamic friction coefficient {dynamic:g} exceeds the static one {static:g}")


def as_law(given: FrictionLaw | float, what: str) -> FrictionLaw:
    """A law from a law or from one coefficient.

    Raises
    ------
    ArgumentError
        It is neither; `what` is the word for messages.
    """
    if isinstance(given, Coulomb | Stribeck):
        return given
    if not is_number(given):
        raise ArgumentError(f"{what}: {given!r} is no friction law: a coefficient, Coulomb or Stribeck was expected")
    return Coulomb(float(given))
