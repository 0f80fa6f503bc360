"""The Dual-clutch: two clutches with different gears between an engine and a vehicle, with two histories of inputs.

Equations and numbers: Kusters, section 1.4 and appendix B, with the signs of its friction torques corrected. The
histories are ours, since the document shows its own in a figure only: case ``a`` is hard on every method (both clutches
stick in turn, both slip at once, break-away, a clutch without force), case ``b`` is a gentle downshift.
"""

from __future__ import annotations

from hysdel_py.drivetrain.components import Clutch, Gear, Inertia, Load, SpringDamper, TorqueSource
from hysdel_py.drivetrain.drivetrain import Drivetrain
from hysdel_py.drivetrain.signals import SignalLike
from hysdel_py.errors import ArgumentError

__all__ = ["CASES", "SHAFTS", "START", "UNTIL", "dual_clutch"]

START = {"engine": 150.0, "F": 150.0, "vehicle": 18.0}
UNTIL = 10.0
SHAFTS = ("engine", "F", "C", "vehicle")
"""The speeds over which a mean error is taken."""

_INERTIAS = {"engine": 0.2, "F": 0.01, "C": 0.01, "vehicle": 110.0}
_RATIO_C, _RATIO_DRIVE = 0.6 / 0.4, 0.6 * 0.2
_STIFFNESS, _LOAD = 6000.0, 20.0

_Pairs = tuple[tuple[float, float], ...]

CASES: dict[str, tuple[_Pairs, _Pairs, _Pairs]] = {
    "a": (
        ((0, 100), (2, 100), (2.4, 0), (6.2, 0), (7, 100), (8.6, 100), (8.8, 20), (9, 20), (9.2, 100), (10, 100)),
        ((0, 0), (1.6, 0), (3.2, 100), (6, 100), (6.4, 0), (10, 0)),
        ((0, 45), (1.9, 45), (2.2, 80), (3, 80), (3.2, 40), (5.9, 40), (6.1, 20), (6.9, 20), (7.2, 45), (10, 45)),
    ),
    "b": (
        ((0, 120), (2, 120), (3, 0), (10, 0)),
        ((0, 0), (2, 0), (4, 150), (10, 150)),
        ((0, 45), (1.9, 45), (2.2, 70), (3.5, 70), (4, 35), (10, 35)),
    ),
}
"""Normal forces of both clutches [N] and engine torque [Nm]: pairs (time, value)."""


def dual_clutch(case: str = "a") -> Drivetrain:
    """The system with the inputs of a case, to be run from START to UNTIL.

    Raises
    ------
    ArgumentError
        There is no such case.
    """
    if case not in CASES:
        raise ArgumentError(f"case is {case!r}: one of {', '.join(CASES)} was expected")
    force_f, force_c, torque = CASES[case]
    return _with_inputs(force_f, force_c, torque)


def _with_inputs(force_f: SignalLike, force_c: SignalLike, torque: SignalLike) -> Drivetrain:
    return Drivetrain(
        *(Inertia(name, inertia) for name, inertia in _INERTIAS.items()),
        Gear("gear_c", "C", "F", _RATIO_C),
        Gear("final_drive", "driveshaft", "F", _RATIO_DRIVE),
        SpringDamper("twist", "driveshaft", "vehicle", _STIFFNESS),
        Clutch("clutch_F", "engine", "F", force_f),
        Clutch("clutch_C", "engine", "C", force_c),
        TorqueSource("engine_torque", "engine", torque),
        Load("road", "vehicle", damping=_LOAD),
    )
