"""Reference trajectories of a shift: the torque that the driver gets, and the speeds that lead there.

The document made its references with a block diagram that its text does not hold. These are ours:

* the drive-shaft torque goes from its first to its last value on a polynomial of degree five with resting ends, over
  the seconds that the shift names;
* the flywheel speed of part 1 stays where a clutch with a little positive slip holds it until the clutch has had time
  to open, and then goes to its target on the same polynomial. The model of part 1 knows slipping friction only: were
  the engine allowed to fall behind its shaft while the clutch still carries torque, the clutch of the plant would
  stick and then pull the other way, and the torque at the wheels would lack what the model counts on;
* the relative speed of part 2 has the reference zero until it is small, and then dies away exponentially from where it
  is, so that the clutch locks with a small relative acceleration;
* brake force has the reference zero, and clutch force too where engine and brake can carry the torque alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.demos.shifts.cases import HORIZON, Shift
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit
from hysdel_py.errors import ArgumentError

__all__ = ["ahead", "clutch_reference", "guard_limit", "landing", "smooth", "torque_reference", "wheel_reference"]

Vector = NDArray[np.float64]

SAMPLE_TIME = 0.01
_RELEASE_RATE = 495.0  # N/s
_WHEEL_SECONDS = 0.25  # from the opened clutch to the target
_LANDING_SPEED = 25.0  # rad/s, relative speed from which it dies away
_LANDING_SECONDS = 0.1  # its time constant


def smooth(first: float, last: float, share: ArrayLike) -> Vector:
    """From one value to another on a polynomial of degree five whose ends rest; held outside of shares 0 to 1."""
    s = np.clip(np.asarray(share, dtype=float), 0.0, 1.0)
    value: Vector = first + (last - first) * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    return value


def torque_reference(torques: tuple[float, float], t: ArrayLike, seconds: float) -> Vector:
    """Drive-shaft torque at times since the begin of the shift [Nm]."""
    return smooth(*torques, np.asarray(t, dtype=float) / seconds)


def wheel_reference(shift: Shift, data: Transmission, secondary: float, force: float, t: ArrayLike) -> Vector:
    """Flywheel speed of part 1 at times since its begin [rad/s].

    Parameters
    ----------
    secondary : float
        Speed of the secondary shaft now [rad/s]; it hardly changes during a shift.
    force : float
        Clutch force at the begin [N], which settles when the clutch is open.
    """
    held = data.flywheel_speed(secondary / data.gears[shift.gears[0]] + shift.held_slip, secondary)
    return smooth(held, shift.wheel_target, (np.asarray(t, dtype=float) - force / _RELEASE_RATE) / _WHEEL_SECONDS)


def ahead(k: int) -> Vector:
    """Times that a plan made at step k looks at [s]."""
    return np.asarray(SAMPLE_TIME * (k + np.arange(HORIZON + 1)), dtype=float)


def landing(relative: float) -> Vector:
    """Reference of the relative speed over a plan that begins at a relative speed [rad/s]."""
    if abs(relative) > _LANDING_SPEED:
        return np.zeros(HORIZON + 1)
    value: Vector = relative * np.exp(-SAMPLE_TIME * np.arange(HORIZON + 1) / _LANDING_SECONDS)
    return value


def clutch_reference(shift: Shift, data: Transmission, first: float, t: ArrayLike) -> Vector:
    """Clutch force of part 1 at times since its begin [N].

    What the torque at the wheels asks for beyond what engine and brake can give while the engine keeps its speed: with
    the engine at its limit, (10.13) and (10.14) at rest leave one clutch and one brake torque. It falls at the fastest
    rate at most, and to zero once the torque at the wheels has arrived.
    """
    times = np.asarray(t, dtype=float)
    engine = 0.99 * engine_limit(data.engine_speed(shift.gears[0], shift.speed))
    wanted = torque_reference(shift.torques, times, shift.fall)
    carried = [_balance(data, shift.gears[0], engine, torque, shift.speed) for torque in wanted]
    force = np.clip(np.array(carried) / data.mu, 0.0, first)
    open_from: Vector = np.where(times >= shift.fall, 0.0, force)
    return open_from


def _balance(data: Transmission, gear: int, engine: float, torque: float, wheels: float) -> float:
    """Clutch torque with which engine and shafts gain speed as the vehicle does; the brake takes up the rest."""
    a = data.z / data.r_gn  # flywheel speed per speed of the secondary shaft
    ratio = data.gears[gear]
    shaft_gain = (torque - data.b_v * wheels) / data.J_v / data.r_d
    engine_gain = shaft_gain / ratio
    inertia = np.array([[data.J_e + data.z**2 * data.J_f, -a * data.z * data.J_f],
                        [-a * data.z * data.J_f, data.J_s + data.J_p / ratio**2 + a * a * data.J_f]])  # fmt: skip
    needed = inertia @ [engine_gain, shaft_gain] - [engine, -data.r_d * torque]
    forces = np.array([[-1.0, -data.z], [1.0 / ratio, a]])  # of clutch and brake, on engine and secondary shaft
    return float(np.linalg.solve(forces, needed)[0])


def guard_limit(shift: Shift, data: Transmission, secondary: float, t: ArrayLike) -> Vector:
    """Greatest flywheel speed of part 1 that leaves the clutch the slip of the guard [rad/s]."""
    if shift.guard is None:
        raise ArgumentError(f"shift {shift.name} has no guard")
    times, guard = np.asarray(t, dtype=float), shift.guard
    slip = smooth(0.0, guard.slip, times / guard.build)
    held = data.z * (secondary / data.r_gn - secondary / data.gears[shift.gears[0]] - slip)
    limit: Vector = np.where(times < guard.open_by - guard.lead, held, float(shift.release.wf[1] or 0.0))
    return limit
