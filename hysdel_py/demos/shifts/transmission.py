"""Numbers of the brake-impulse shift transmission, its stationary states, and the torque that its engine can give.

Numbers are those of appendix K of J.R.P. Kusters, "Modelling and coordinated control of advanced automotive
transmissions", TU/e, DCT 2005-58. The shipped models ``bist_part1`` and ``bist_part2`` hold the same ones.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["LEAST_SPEED", "MOST_SPEED", "STATES", "Transmission", "engine_limit"]

LEAST_SPEED, MOST_SPEED = 84.0, 700.0
"""Range of the engine speed [rad/s]."""
LAST_KNOT = 628.0
"""Engine speed at which the printed torque curve ends [rad/s]."""
STATES = ("Te", "Fnb", "Fnc", "dphi", "we", "ws", "wv")
"""States of the models and of the plant: engine torque, forces of brake and clutch, twist, three speeds."""


def engine_limit(speed: float, *, beyond: str = "line") -> float:
    """Greatest torque of the engine at a speed [Nm].

    The curve of the document has three pieces, from 84 to 628 rad/s.

    Parameters
    ----------
    speed : float
        [rad/s]
    beyond : str
        What holds above 628 rad/s: ``"line"`` continues the last piece, ``"range"`` is the model of the document, in
        which the range of the torque, up to 145 Nm, is all that is left.

    Raises
    ------
    ArgumentError
        Another word for `beyond`.
    """
    if beyond not in ("line", "range"):
        raise ArgumentError(f'beyond is {beyond!r}: "line" or "range" was expected')
    if speed <= 105.0:
        return 105.0 - (105.0 - speed) * 45.0 / 21.0
    if speed <= 419.0:
        return 145.0 - (419.0 - speed) * 40.0 / 314.0
    if speed <= LAST_KNOT or beyond == "line":
        return 127.0 + (LAST_KNOT - speed) * 18.0 / 209.0
    return 145.0


@dataclass(frozen=True, slots=True)
class Transmission:
    """Parameters; ratios are output speed over input speed.

    Attributes
    ----------
    gears : mapping of int to float
        Ratio of each gear, secondary over primary shaft.
    r_d, r_gn : float
        Ratio of the final drive; ratio of the planetary branch.
    z : float
        Ring over sun of the planetary set.
    J_e, J_f, J_p, J_s, J_v : float
        Inertias of engine, flywheel, primary and secondary shaft, and of the vehicle at the wheels [kg m^2].
    k, d : float
        Stiffness [Nm/rad] and damping [Nm s/rad] of the drive shaft.
    b_v : float
        Load per speed of the wheels [Nm s/rad].
    mu : float
        Friction torque per normal force of clutch and brake [Nm/N].
    """

    gears: Mapping[int, float] = field(default_factory=lambda: {1: 1 / 3.308, 2: 1 / 1.913, 3: 1 / 1.220})
    r_d: float = 1 / 3.737
    r_gn: float = 0.7
    z: float = 2.1155
    J_e: float = 0.154
    J_f: float = 0.08
    J_p: float = 0.0057
    J_s: float = 0.0028
    J_v: float = 110.0
    k: float = 6000.0
    d: float = 6.0
    b_v: float = 10.0
    mu: float = 1.0

    def overall(self, gear: int) -> float:
        """Speed of the wheels over speed of the engine.

        Raises
        ------
        ArgumentError
            There is no such gear.
        """
        if gear not in self.gears:
            raise ArgumentError(f"gear is {gear!r}: one of {', '.join(map(str, self.gears))} was expected")
        return self.gears[gear] * self.r_d

    def engine_speed(self, gear: int, wheels: float) -> float:
        """Engine speed with the clutch stuck [rad/s]."""
        return wheels / self.overall(gear)

    def flywheel_speed(self, engine: float, secondary: float) -> float:
        """Speed of the flywheel on the sun, from those of engine (ring) and secondary shaft (carrier) [rad/s]."""
        return self.z * (secondary / self.r_gn - engine)

    def relative_speed(self, gear: int, engine: float, secondary: float) -> float:
        """Slip over the clutch with a gear in place [rad/s]."""
        return engine - secondary / self.gears[gear]

    def stationary(self, gear: int, torque: float, wheels: float, grip: float = 1.0) -> dict[str, float]:
        """State in which no shaft accelerates except the vehicle, the clutch just sticks, and the brake is off.

        Parameters
        ----------
        gear : int
        torque : float
            Of the drive shaft [Nm].
        wheels : float
            Speed of the wheels [rad/s].
        grip : float
            Friction of the clutch as a share of `mu`; with less of it, more force is needed.
        """
        engine = torque * self.overall(gear)
        return {
            "Te": engine, "Fnb": 0.0, "Fnc": engine / (self.mu * grip), "dphi": torque / self.k,
            "we": self.engine_speed(gear, wheels), "ws": wheels / self.r_d, "wv": wheels,
        }  # fmt: skip

    def inertia(self, gear: int) -> NDArray[np.float64]:
        """Inertias of engine and secondary shaft with a gear in place and the clutch open, coupled by the flywheel."""
        a, flywheel = self.z / self.r_gn, self.J_f
        coupled = -a * self.z * flywheel
        shafts = self.J_s + self.J_p / self.gears[gear] ** 2 + a * a * flywheel
        return np.array([[self.J_e + self.z**2 * flywheel, coupled], [coupled, shafts]])

    def rolling(self, gear: int, torque: float, wheels: float) -> dict[str, float]:
        """State in which all shafts gain speed as the vehicle does, with a clutch that just sticks and the brake off.

        Parameters
        ----------
        gear : int
        torque : float
            Of the drive shaft [Nm].
        wheels : float
            Speed of the wheels [rad/s].
        """
        secondary = (torque - self.b_v * wheels) / self.J_v / self.r_d
        needed = self.inertia(gear) @ [secondary / self.gears[gear], secondary] + [0.0, self.r_d * torque]
        clutch = self.gears[gear] * needed[1]
        twist = torque / self.k
        return self.stationary(gear, torque, wheels) | {
            "Te": float(needed[0] + clutch), "Fnc": float(clutch) / self.mu, "dphi": twist
        }  # fmt: skip

    def stuck_clutch(self, gear: int, x: NDArray[np.float64]) -> float:
        """Torque that the clutch carries in a state in which it sticks, with the brake off [Nm]."""
        engine, _, _, twist, _, secondary, wheels = x
        ratio = self.gears[gear]
        both = self.inertia(gear) @ [1.0 / ratio, 1.0]
        torque = self.k * twist + self.d * (self.r_d * secondary - wheels)
        gain = (engine / ratio - self.r_d * torque) / (both[0] / ratio + both[1])
        return float(engine - both[0] * gain)
