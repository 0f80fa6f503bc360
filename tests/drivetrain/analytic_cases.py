"""Drivetrains whose motion is known in closed form: the answers that every scheme has to reproduce.

V1 to V16 are numbered as in docs/drivetrain.md, which gives the formulas.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan, cos, exp, pi, radians, sin

import numpy as np
from scipy.optimize import brentq

import hysdel_py as hys
from hysdel_py.drivetrain.signals import Function


@dataclass(frozen=True)
class Case:
    line: hys.Drivetrain
    start: dict[str, float]
    until: float
    ends: dict[str, float]
    """Signals at the end."""
    events: tuple[float, ...] = ()
    """Times at which modes change."""
    heat: float | None = None
    linear: bool = True
    scale: float = 1.0
    """Size of the speeds, to which the tolerances refer."""
    tags: set[str] = field(default_factory=set)


def pair(*more, force, torque=0.0, load=0.0, friction=1.0):
    return hys.Drivetrain(
        hys.Inertia("engine", 0.2),
        hys.Inertia("vehicle", 0.8),
        hys.Clutch("clutch", "engine", "vehicle", force, friction),
        hys.TorqueSource("T1", "engine", torque),
        hys.TorqueSource("T2", "vehicle", -load),
        *more,
    )


def lock_up():
    ends = {"engine": 40.0, "vehicle": 40.0}
    return Case(pair(force=50), {"engine": 120, "vehicle": 20}, 0.5, ends, (0.32,), 800.0, scale=120)


def lock_up_under_load():
    t = 100 / (50 * (5 + 1.25) - 30 * 5 - 20 * 1.25)
    ends = {"engine": 50.0, "vehicle": 50.0, "clutch.torque": 28.0}
    line = pair(force=50, torque=30, load=20)
    return Case(line, {"engine": 120, "vehicle": 20}, 1.0, ends, (t,), 0.5 * 50 * 100 * t, scale=120)


def break_away():
    line = pair(force=[(0, 100), (2, 0)], torque=30, load=20)
    return Case(line, {"engine": 40, "vehicle": 40}, 1.9, {"clutch.slip": 156.25 * 0.46**2}, (1.44,), scale=40)


def viscous_load():
    line = pair(hys.Load("road", "vehicle", damping=0.67), force=120, torque=100)
    b, J = 0.67, 0.8
    lock = brentq(lambda t: 120 - 100 * t - 120 / b * (1 - exp(-b * t / J)), 0.4, 0.7, xtol=1e-14)
    final = 100 / b
    ends = {"vehicle": final + (120 - 100 * lock - final) * exp(-b * (1.0 - lock) / 1.0)}
    return Case(line, {"engine": 120, "vehicle": 0}, 1.0, ends, (lock,), scale=120)


def brick_on_incline():
    line = hys.Drivetrain(hys.VehicleLoad("brick", mass=1, radius=1, rolling=0.3, slope=radians(10)))
    return Case(
        line, {"brick": -2}, 2.0, {"brick": 0.0}, (2 / (9.81 * (0.3 * cos(radians(10)) - sin(radians(10)))),), scale=2
    )


def three_inertias():
    line = hys.Drivetrain(
        *(hys.Inertia(name, 1) for name in "abc"), hys.Clutch("ab", "a", "b", 6), hys.Clutch("bc", "b", "c", 2)
    )
    ends = dict.fromkeys("abc", 10 / 3)
    return Case(line, {"a": 10, "b": 0, "c": 0}, 2.0, ends, (1.0, 5 / 3), 100 / 3, scale=10)


def simultaneous():
    line = hys.Drivetrain(
        hys.Inertia("a", 1), hys.Inertia("b", 2), hys.Inertia("c", 1), hys.Clutch("ab", "a", "b", 1),
        hys.Clutch("bc", "b", "c", 1),
    )  # fmt: skip
    return Case(line, {"a": 1, "b": 0, "c": -1}, 1.5, dict.fromkeys("abc", 0.0), (1.0, 1.0), 1.0)


def brake():
    torque = [(0, 6), (3, 6), (5, 22)]
    line = hys.Drivetrain(
        hys.Inertia("drum", 0.5), hys.Brake("brake", "drum", 10), hys.TorqueSource("T", "drum", torque)
    )
    return Case(line, {"drum": 20}, 4.0, {"drum": 2.0}, (2.5, 3.5), scale=20)


def decaying_oscillation():
    line = hys.Drivetrain(
        hys.Inertia("m", 1), hys.SpringDamper("x", "m", hys.GROUND, 100), hys.Brake("friction", "m", 1)
    )
    return Case(line, {"m": 0, "x": 0.095}, 2.0, {"m": 0.0, "x": 0.005}, tags={"spring"})


def belt():
    """Stick-slip: starts where the mass begins to stick on the belt."""
    slip = 2 * (pi - atan(2.5))
    line = hys.Drivetrain(
        hys.Inertia("m", 1), hys.SpringDamper("x", "m", hys.GROUND, 1), hys.SpeedSource("belt", 0.2),
        hys.Clutch("friction", "belt", "m", 1, hys.Coulomb(1, 0.5)),
    )  # fmt: skip
    events = (5.0, 5 + slip, 10 + slip, 10 + 2 * slip)
    return Case(line, {"m": 0.2, "x": 0.0}, 2 * (5 + slip) + 1, {"m": 0.2, "x": 0.2}, events, tags={"static"})


def coupled_clutches():
    """CoupledClutches of the Modelica Standard Library; SystemModeler 5.0 gives 3.2450799 and 2.4638424."""
    smooth = Function(
        lambda t: 20 * max(0.0, sin(0.4 * pi * t + 1.57)), knots=np.array([(1.5 * pi - 1.57 - 0.5 * pi) / (0.4 * pi)])
    )
    friction = hys.Coulomb(0.5 * 1.1, 0.5)
    line = hys.Drivetrain(
        *(hys.Inertia(f"J{i}", 1) for i in (1, 2, 3, 4)),
        hys.TorqueSource("torque", "J1", lambda t: 10 * sin(2 * pi * 5 * t)),
        hys.Clutch("c1", "J1", "J2", smooth, friction),
        hys.Clutch("c2", "J2", "J3", [(0, 0), (0.4, 0), (0.4, 20)], friction),
        hys.Clutch("c3", "J3", "J4", [(0, 0), (0.9, 0), (0.9, 20)], friction),
    )
    ends = {"J1": 3.2450885, "J2": 2.4638438, "J3": 2.4638438, "J4": 2.4638438}
    events = (0.709793197, 0.791263092, 0.831167241, 0.906599720, 1.000333289, 1.144006756)
    start = {"J1": 10, "J2": 0, "J3": 0, "J4": 0}
    return Case(line, start, 1.5, ends, events, linear=False, scale=10, tags={"static"})


CASES = {
    "V1 lock-up": lock_up,
    "V2 lock-up under load": lock_up_under_load,
    "V3 break-away": break_away,
    "V4 viscous load": viscous_load,
    "V5 incline": brick_on_incline,
    "V6 stick-slip": belt,
    "V7 decay": decaying_oscillation,
    "V8 three inertias": three_inertias,
    "V9 simultaneous": simultaneous,
    "V10 brake": brake,
    "V16 CoupledClutches": coupled_clutches,
}
