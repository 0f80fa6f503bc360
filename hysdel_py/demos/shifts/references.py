"""Reference trajectories of a shift: the torque that the driver gets, and the speeds that lead there.

The document made its references with a block diagram that its text does not hold. These are ours:

* the drive-shaft torque goes from its first to its last value on a polynomial of degree five with resting ends, over
  the seconds that the shift names;
* the flywheel speed of part 1 stays where a clutch with a little positive slip holds it until the clutch has had time
  to open, and then goes to its target on the same polynomial. The model of part 1 knows slipping friction only: were
  the engine allowed to fall behind its shaft while the clutch still carries torque, the clutch of the plant would
  stick and then pull the other way, and the torque at the wheels would lack what the model counts on;
* the relative speed of part 2 has the reference zero until it is small, and then a parabola from where it is, so that
  the clutch locks with a small relative acceleration;
* brake force has the reference zero, and clutch force too where engine and brake can carry the torque alone. Where they
  cannot at once, in the shift from first gear, it is the clutch force of :mod:`hysdel_py.demos.shifts.release_program`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.demos.shifts.cases import HORIZON, Shift
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.errors import ArgumentError

__all__ = ["ahead", "guard_limit", "landing", "smooth", "torque_reference", "wheel_reference"]

Vector = NDArray[np.float64]

SAMPLE_TIME = 0.01
_RELEASE_RATE = 495.0  # N/s
_WHEEL_SECONDS = 0.25  # from the opened clutch to the target
_BEHIND = 60.0
"""By how much the flywheel still lacks its target at the gear change [rad/s]."""
LANDING_SPEED = 40.0
"""Relative speed below which it has this reference; above the reference is zero [rad/s]."""
LANDING_MARGIN = (0.05, 0.1)
"""By how much a plan may be below [rad/s]: a number, and a share of the relative speed."""
LANDING_SLOPE = 8.0
"""What is left of it at lock-up [rad/s^2]."""


def smooth(first: float, last: float, share: ArrayLike) -> Vector:
    """From one value to another on a polynomial of degree five whose ends rest; held outside of shares 0 to 1."""
    s = np.clip(np.asarray(share, dtype=float), 0.0, 1.0)
    value: Vector = first + (last - first) * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    return value


def torque_reference(torques: tuple[float, float], t: ArrayLike, seconds: float) -> Vector:
    """Drive-shaft torque at times since the begin of the shift [Nm]."""
    return smooth(*torques, np.asarray(t, dtype=float) / seconds)


def wheel_reference(
    shift: Shift, data: Transmission, secondary: float, force: float, t: ArrayLike, *, nearest: float = 0.0
) -> Vector:
    """Flywheel speed of part 1 at times since its begin [rad/s].

    Parameters
    ----------
    secondary : float
        Speed of the secondary shaft now [rad/s]; it hardly changes during a shift.
    force : float
        Clutch force at the begin [N], which settles when the clutch is open.
    nearest : float
        Flywheel speed up to which the brake can be released before the flywheel reverses [rad/s].
    """
    held = data.flywheel_speed(secondary / data.gears[shift.gears[0]] + shift.held_slip, secondary)
    target = min(shift.wheel_target, nearest + _BEHIND)
    return smooth(held, target, (np.asarray(t, dtype=float) - force / _RELEASE_RATE) / _WHEEL_SECONDS)


def ahead(k: int) -> Vector:
    """Times that a plan made at step k looks at [s]."""
    return np.asarray(SAMPLE_TIME * (k + np.arange(HORIZON + 1)), dtype=float)


def landing(relative: float, fading: float) -> Vector:
    """How the relative speed dies away over a plan that begins at a relative speed [rad/s].

    Its slope fades evenly, as the rates of engine and clutch allow, to that at lock-up:
    ``s(t) = s0 - v t + j t^2/2`` with ``v^2 = a^2 + 2 j s0``, which meets zero with the slope -a.
    """
    size = abs(relative)
    slope = np.sqrt(LANDING_SLOPE**2 + 2.0 * fading * size)
    t = np.minimum(SAMPLE_TIME * np.arange(HORIZON + 1), (slope - LANDING_SLOPE) / fading)
    value: Vector = np.maximum(size - slope * t + fading / 2.0 * t * t, 0.0) * np.sign(relative)
    return value


def guard_limit(shift: Shift, data: Transmission, secondary: float, t: ArrayLike) -> Vector:
    """Greatest flywheel speed of part 1 that leaves the clutch the slip of the guard [rad/s]."""
    if shift.guard is None:
        raise ArgumentError(f"shift {shift.name} has no guard")
    times, guard = np.asarray(t, dtype=float), shift.guard
    slip = smooth(0.0, guard.slip, times / guard.build)
    held = data.z * (secondary / data.r_gn - secondary / data.gears[shift.gears[0]] - slip)
    limit: Vector = np.where(times < guard.open_by - guard.lead, held, float(shift.release.wf[1] or 0.0))
    return limit
