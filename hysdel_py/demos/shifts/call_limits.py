"""Limits of one plan that a shift itself asks for: a clutch that opens in time with slip, a soft lock-up, the rates."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.limits import Limits
from hysdel_py.demos.shifts import references
from hysdel_py.demos.shifts.cases import Shift
from hysdel_py.demos.shifts.transmission import Transmission

__all__ = ["FASTEST", "effective_rates", "of_guard", "of_landing"]

Vector = NDArray[np.float64]

FASTEST: Mapping[str, tuple[float, float]] = {
    "Te_rate": (-396.0, 495.0), "Fnb_rate": (-495.0, 792.0), "Fnc_rate": (-495.0, 792.0)
}  # fmt: skip
"""Rates that plans may use [Nm/s, N/s]: 0.99 of those of the actuators."""
_LEAST = 0.01
_REACHED = 490.0 / 495.0  # of the fastest release, which a plan can follow for sure


def of_guard(shift: Shift, data: Transmission, x: Vector, t: Vector, *, strongest: Vector, grip: float) -> Limits:
    """Clutch force and flywheel speed of part 1 for a shift with a guard, nothing for one without.

    Parameters
    ----------
    shift : Shift
    data : Transmission
    x : array of shape (7,)
        State from which the plan begins, with effective forces.
    t : array of shape (N + 1,)
        Times of the plan since the begin of the shift [s].
    strongest : array of shape (N + 1,)
        Greatest effective clutch force [N].
    grip : float
        Effective force per force, one at most.
    """
    if shift.guard is None:
        return Limits()
    rate = -grip * FASTEST["Fnc_rate"][0]
    fall = rate * np.clip(shift.guard.open_by - t, 0.0, None)
    within_reach = x[2] - _REACHED * rate * references.SAMPLE_TIME * np.arange(len(t))
    most = np.clip(np.maximum(fall, within_reach), _LEAST, strongest)
    most[0] = strongest[0]
    wheel = (shift.release.wf[0], references.guard_limit(shift, data, x[5], t))
    return Limits(y={"wf": wheel}, x={"Fnc": (_LEAST, most)})


def of_landing(shift: Shift, data: Transmission, x: Vector) -> Limits:
    """The relative speed falls no faster than lock-up allows."""
    relative = data.relative_speed(shift.gears[1], x[4], x[5])
    low = shift.engage.rel[0]
    if low is None or relative <= 0.0:
        return Limits()
    always, share = references.LANDING_MARGIN
    least = np.maximum(references.landing(relative, shift.fading) - always - share * relative, low)
    return Limits(y={"rel": (least, None)})


def effective_rates(grip: Vector) -> dict[str, tuple[float, float]]:
    """Limits of the rates of effective forces that the actuators can follow, within those of the model.

    Parameters
    ----------
    grip : array of shape (2,)
        Effective force per force, of clutch and brake.
    """
    shares = {"Fnb_rate": min(float(grip[1]), 1.0), "Fnc_rate": min(float(grip[0]), 1.0)}
    return {name: (share * FASTEST[name][0], share * FASTEST[name][1]) for name, share in shares.items()}
