"""What the wheels can get: the greatest drive-shaft torque in each gear, and with the clutch open during a shift."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.demos.shifts.transmission import LEAST_SPEED, MOST_SPEED, Transmission, engine_limit

__all__ = ["bridged", "sustained", "traction", "traction_map"]

Vector = NDArray[np.float64]


def traction(data: Transmission, gear: int, wheels: float, *, beyond: str = "line") -> float:
    """Engine torque at its limit times the ratio [Nm]; zero where the engine speed is outside its range.

    Parameters
    ----------
    wheels : float
        Speed of the wheels [rad/s].
    beyond : str
        See :func:`engine_limit`.
    """
    engine = data.engine_speed(gear, wheels)
    if not LEAST_SPEED <= engine <= MOST_SPEED:
        return 0.0
    return engine_limit(engine, beyond=beyond) / data.overall(gear)


def traction_map(data: Transmission, wheels: ArrayLike, *, beyond: str = "line") -> dict[int, Vector]:
    """The traction of every gear over the speed of the wheels."""
    speeds = np.asarray(wheels, dtype=float)
    return {gear: np.array([traction(data, gear, v, beyond=beyond) for v in speeds]) for gear in data.gears}


def sustained(data: Transmission, gear: int, wheels: float) -> float:
    """The same for a vehicle that gains speed: engine, shafts and flywheel take their share of the torque [Nm].

    With the clutch stuck and the brake off, ``r_d T = Te/r - J dws`` with all inertias J at the secondary shaft, and
    the vehicle gains ``J_v dwv = T - b_v wv``.
    """
    engine = data.engine_speed(gear, wheels)
    if not LEAST_SPEED <= engine <= MOST_SPEED:
        return 0.0
    ratio = data.gears[gear]
    flywheel = data.z * (1 / data.r_gn - 1 / ratio)
    inertia = (data.J_e + data.J_p) / ratio**2 + data.J_s + data.J_f * flywheel**2
    share = inertia / (data.J_v * data.r_d)
    return (engine_limit(engine) / ratio + share * data.b_v * wheels) / (data.r_d + share)


def bridged(data: Transmission, engine: float, brake: float) -> float:
    """Drive-shaft torque with the clutch open that leaves the secondary shaft at rest [Nm], from (10.14).

    Parameters
    ----------
    engine, brake : float
        Torques [Nm].
    """
    own = data.r_gn * data.J_f * engine + data.r_gn / data.z * data.J_e * brake
    return own / (data.r_d * data.r_gn**2 * (data.J_f + data.J_e / data.z**2))
