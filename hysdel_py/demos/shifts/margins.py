"""Limits of one plan that leave room for a plant that is not the model.

* The brake closes with the flywheel: its force may be no more than what can be released, at the fastest rate, before
  the flywheel gets to the brake rule. That takes up to 0.25 s, more than twice the horizon, so that no plan sees it;
  when it does, the force cannot go to zero in time and the rule leaves no plan. While the torque T at the wheels is
  kept, the secondary shaft hardly gains speed, and the balance of its torques gives that of the flywheel:
  ``J_f dwf = Tb + r_gn/z (Tc/r - r_d T)``, with Tc of the clutch in the gear r. So it gains speed at ``a + c F`` under
  a brake force F; releasing F at a rate r takes it ``(a F + c F^2/2)/r`` nearer to its reversal, and that distance,
  solved for F, is the limit. Part 1 has the same distance to keep: it leads the flywheel no nearer.
* Engine torque stays below its curve, and brake and flywheel further apart, by what noise leaves in their estimates.
* Effective forces end where the actuators do: a contact with less friction than in the model reaches less.

No limit ends below what the actuators can reach: none of them takes the last plan away.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.move import Move
from hysdel_py.demos.shifts.cases import HORIZON, Part, Shift
from hysdel_py.demos.shifts.references import SAMPLE_TIME
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit

__all__ = ["Margins", "releasable"]

Vector = NDArray[np.float64]
Ends = tuple[float, Vector]

_NOISES = 3.0  # standard deviations of the flywheel speed
_FALL = {"Te": 390.0, "Fnb": 490.0}  # Nm/s and N/s, a little less than the actuators can
_RISE = 792.0  # N/s, of the clutch
_LIGHTER = 1.1  # a flywheel lighter than in the model gains so many times as much
_SHARE = 0.99  # of the ranges, that limits of plans leave
_MOST_TORQUE = _SHARE * 145.0
_LEAST = 0.01
_STEPS = np.arange(HORIZON + 1)


@dataclass(eq=False)
class Margins:
    """Limits of engine torque and forces over the next plan.

    Parameters
    ----------
    shift : Shift
    part : int
        1 or 2.
    data : Transmission
    rule : float
        Flywheel speed up to which a plan may use the brake [rad/s].
    noise : mapping of state to float
        Standard deviations of the measurement.
    """

    shift: Shift
    part: int
    data: Transmission
    rule: float
    noise: Mapping[str, float]
    _plan: Mapping[str, Vector] = field(init=False, default_factory=dict)

    def remember(self, move: Move) -> None:
        """Keep the speeds of a plan; the next limits are made where it led, one sample later."""
        found = move.predicted
        self._plan = {} if found is None else {name: np.asarray(found[name], dtype=float) for name in ("we", "wf")}

    def limits(self, seen: Vector, grip: Vector) -> dict[str, Ends]:
        """Limits of this call.

        Parameters
        ----------
        seen : array of shape (7,)
            The state from which the plan begins, with effective forces.
        grip : array of shape (2,)
            Friction of clutch and brake as shares of that of the model.
        """
        clutch, brake = np.minimum(grip, 1.0)
        found = {"Fnb": (0.0, self._brake(seen, brake)), "Fnc": (_LEAST, self._clutch(clutch))}
        return found | ({"Te": (_LEAST, self._torque(seen))} if self.noise.get("Te") else {})

    def released(self, seen: Vector, grip: Vector) -> Ends:
        """The limit of a brake that has to go off as fast as it can."""
        return 0.0, np.maximum(self._reach("Fnb", seen[1], min(grip[1], 1.0)), 0.0)

    def nearest(self, seen: Vector, grip: float) -> float:
        """Flywheel speed from which the brake force of now can still be released in time [rad/s]."""
        coasting, braked = self._accelerations(seen, grip)
        rate, force = min(grip, 1.0) * _FALL["Fnb"], float(seen[1])
        return self.rule - self._flywheel_margin() - (coasting * force + braked / 2.0 * force**2) / rate

    def _accelerations(self, seen: Vector, grip: float) -> tuple[float, float]:
        """Of the flywheel with the torque kept: without brake [rad/s^2], and what the brake adds [rad/s^2 per N]."""
        data, ratio = self.data, self.data.gears[self.shift.gears[1]]
        clutch = data.mu * self._clutch_meanwhile(seen, min(grip, 1.0))
        carrier = data.r_gn / data.z * (clutch / ratio - data.r_d * data.k * seen[3])
        return _LIGHTER * float(carrier) / data.J_f, _LIGHTER * data.mu / data.J_f

    def _clutch_meanwhile(self, seen: Vector, grip: float) -> float:
        """Mean clutch force while the brake force of now is released, if the clutch takes over at its fastest [N]."""
        most, rate = grip * _SHARE * self.shift.engage.clutch_force, grip * _RISE
        lacks = max(most - (seen[2] if self.part == 2 else 0.0), 0.0)
        rises, releases = lacks / rate, max(float(seen[1]), 1.0) / (grip * _FALL["Fnb"])
        if rises < releases:
            return float(most - lacks * rises / 2.0 / releases)
        return float(most - lacks + rate * releases / 2.0)

    @property
    def _own(self) -> Part:
        return self.shift.release if self.part == 1 else self.shift.engage

    def _brake(self, seen: Vector, grip: float) -> Vector:
        own = self._own.brake_force
        most = np.full(HORIZON + 1, grip * (_SHARE * self.shift.force if own is None else own))
        if self.part == 1:
            return most
        wheel = self._ahead("wf", self.data.flywheel_speed(seen[4], seen[5]))
        room = np.maximum(self.rule - self._flywheel_margin() - wheel, 0.0)
        closing = releasable(room, grip * _FALL["Fnb"], *self._accelerations(seen, grip))
        return np.asarray(np.minimum(most, np.maximum(closing, self._reach("Fnb", seen[1], grip))), dtype=float)

    def _clutch(self, grip: float) -> Vector:
        return np.full(HORIZON + 1, grip * _SHARE * self._own.clutch_force)

    def _torque(self, seen: Vector) -> Vector:
        """The curve, less one standard deviation of a measured torque: three of an estimated one."""
        curve = np.array([engine_limit(speed) for speed in self._ahead("we", seen[4])]) - self.noise["Te"]
        return np.clip(np.maximum(curve, self._reach("Te", seen[0], 1.0)), _LEAST, _MOST_TORQUE)

    def _flywheel_margin(self) -> float:
        engine, secondary = self.noise.get("we", 0.0), self.noise.get("ws", 0.0)
        return _NOISES * self.data.z * float(np.hypot(engine, secondary / self.data.r_gn))

    def _ahead(self, name: str, now: float) -> Vector:
        """A speed over the next plan: as in the last one, from where it is now."""
        if name not in self._plan:
            return np.full(HORIZON + 1, now)
        before = self._plan[name][1:]
        led = np.append(before, np.repeat(before[-1], HORIZON + 1 - len(before)))
        return np.asarray(now + led - led[0], dtype=float)

    def _reach(self, name: str, now: float, share: float) -> Vector:
        return np.asarray(now - share * SAMPLE_TIME * _FALL[name] * _STEPS, dtype=float)


def releasable(room: Vector, rate: float, coasting: float, braked: float) -> Vector:
    """Brake force that can be released while the flywheel gains so much speed.

    Parameters
    ----------
    room : array
        [rad/s]
    rate : float
        Of the release [N/s].
    coasting, braked : float
        Acceleration of the flywheel without brake [rad/s^2], and what the brake adds [rad/s^2 per N].
    """
    force: Vector = (np.sqrt(coasting**2 + 2.0 * braked * rate * room) - coasting) / braked
    return force
