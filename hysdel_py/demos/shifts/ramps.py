"""A shift by ramps, as it is done without a predictive controller.

Clutch and brake follow ramps, the engine or the brake what a static balance of the torques asks for beside them, and a
PI controller of the torque at the wheels, with damping of the drive shaft, trims it:

* part 1: the clutch opens evenly while the engine holds a little positive slip, and then goes to a torque that stays;
  the brake carries what engine and clutch do not, with the trim on the brake;
* part 2: the brake goes off evenly while the clutch takes over up to a force that slows the engine down; the engine
  torque balances both, with the trim on the engine. Near the speed of the new gear the clutch force comes down with the
  relative speed to what sticking needs, so that the clutch is met softly.

Durations and gains are tuned on the nominal 2-3 upshift; ``benchmarks/shifts.py --tune-ramps`` prints how.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.cases import Shift
from hysdel_py.demos.shifts.references import SAMPLE_TIME, torque_reference
from hysdel_py.demos.shifts.sensors import Sensors
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit

__all__ = ["RampController", "RampTuning"]

Vector = NDArray[np.float64]

_SLOWEST, _FASTEST = np.array([-396.0, -495.0, -495.0]), np.array([495.0, 792.0, 792.0])
_TE, _BRAKE, _CLUTCH = 0, 1, 2
_SLIP_SECONDS = 0.05


@dataclass(frozen=True, slots=True)
class RampTuning:
    """What a calibrating engineer turns at.

    Attributes
    ----------
    open_seconds, release_seconds, close_seconds : float
        Until the clutch is open in part 1; until the brake is off and until the clutch carries in part 2.
    clutch_share : float
        Clutch force in part 2 as a multiple of what sticking needs.
    per_speed : float
        Clutch force above that of sticking per relative speed, near lock-up [N s/rad].
    slip, per_slip : float
        Slip of the opening clutch [rad/s], and engine torque per slip that is missing [Nm s/rad].
    low_share : float
        Engine torque with the clutch open in part 1, as a share of that before the shift.
    proportional, integral : float
        Of the torque controller, in units of the torque that is missing, and per second.
    damping : float
        Torque at the wheels against the rate of the twist [Nm s/rad].
    """

    open_seconds: float = 0.27
    release_seconds: float = 0.27
    close_seconds: float = 0.33
    clutch_share: float = 2.0
    per_speed: float = 2.5
    slip: float = 3.6
    per_slip: float = 7.0
    low_share: float = 1.0
    proportional: float = 0.1
    integral: float = 1.8
    damping: float = 45.0


@dataclass(eq=False)
class RampController:
    """Ramps of one part.

    Parameters
    ----------
    shift : Shift
    part : int
        1 or 2.
    data : Transmission
    sensors : Sensors
    start : array of shape (7,)
        State at the begin of the shift.
    tuning : RampTuning, optional
    """

    shift: Shift
    part: int
    data: Transmission
    sensors: Sensors
    start: Vector
    tuning: RampTuning = field(default_factory=RampTuning)
    _sum: float = 0.0
    _brake: float | None = None

    def solve(self, x: Vector, k: int) -> Vector:
        """Rates for the sample k of the part."""
        seen = self.sensors.read(x)
        if self._brake is None:
            self._brake = float(seen[_BRAKE])
        goal = self._release(seen, k) if self.part == 1 else self._engage(seen, k)
        rates: Vector = np.clip((goal - seen[:3]) / SAMPLE_TIME, _SLOWEST, _FASTEST)
        return rates

    def _release(self, x: Vector, k: int) -> Vector:
        left = max(0.0, 1.0 - (k + 1) * SAMPLE_TIME / self.tuning.open_seconds)
        clutch, engine = left * self.start[_CLUTCH], self._opening_engine(x, k, left)
        wanted = self._wanted(k)
        _, brake = self._balance(wanted + self._trim(x, wanted), x, engine=engine, clutch=self.data.mu * clutch)
        return np.array([engine, max(brake, 0.0) / self.data.mu, clutch])

    def _opening_engine(self, x: Vector, k: int, left: float) -> float:
        """Engine torque of part 1: it holds the slip while the clutch opens."""
        slip = self.data.relative_speed(self.shift.gears[0], x[4], x[5])
        goal = self.tuning.slip * min(1.0, (k + 1) * SAMPLE_TIME / _SLIP_SECONDS)
        held = self.start[_TE] + self.tuning.per_slip * (goal - slip)
        return float(np.clip(held if left else self.tuning.low_share * self.start[_TE], 0.01, engine_limit(x[4])))

    def _engage(self, x: Vector, k: int) -> Vector:
        t, wanted = (k + 1) * SAMPLE_TIME, self._wanted(k)
        stuck = self.data.rolling(self.shift.gears[1], wanted, x[6])["Fnc"]
        relative = self.data.relative_speed(self.shift.gears[1], x[4], x[5])
        most = min(self.tuning.clutch_share * stuck, 0.99 * self.shift.engage.clutch_force)
        clutch = min(1.0, t / self.tuning.close_seconds) * min(most, stuck + 1.0 + self.tuning.per_speed * relative)
        assert self._brake is not None
        brake = max(0.0, 1.0 - t / self.tuning.release_seconds) * self._brake
        engine = self._engine(x, wanted + self._trim(x, wanted), self.data.mu * brake, self.data.mu * clutch)
        return np.array([np.clip(engine, 0.01, engine_limit(x[4])), brake, clutch])

    def _wanted(self, k: int) -> float:
        since = 0.0 if self.part == 1 else self.shift.release.seconds
        return float(torque_reference(self.shift.torques, since + k * SAMPLE_TIME, self.shift.fall))

    def _trim(self, x: Vector, wanted: float) -> float:
        """What the PI controller adds to the torque [Nm]."""
        twisting = self.data.r_d * x[5] - x[6]
        missing = wanted - self.data.k * x[3] - self.data.d * twisting
        self._sum += self.tuning.integral * SAMPLE_TIME * missing
        return float(self.tuning.proportional * missing + self._sum - self.tuning.damping * twisting)

    def _gain(self, x: Vector, torque: float) -> float:
        """Acceleration of the secondary shaft when it follows the vehicle [rad/s^2]."""
        return float((torque - self.data.b_v * x[6]) / self.data.J_v / self.data.r_d)

    def _engine(self, x: Vector, torque: float, brake: float, clutch: float) -> float:
        """Engine torque that balances torques of drive shaft, brake and clutch."""
        M, a, ratio = self._of_gear()
        sense = -np.sign(self.data.flywheel_speed(x[4], x[5]))
        gain = self._gain(x, torque)
        slows = (clutch / ratio + a * sense * brake - self.data.r_d * torque - M[1, 1] * gain) / M[1, 0]
        return float(M[0, 0] * slows + M[0, 1] * gain + clutch + self.data.z * sense * brake)

    def _balance(self, torque: float, x: Vector, *, engine: float, clutch: float) -> Vector:
        """Acceleration of the engine and torque of the brake with the engine torque given."""
        M, a, ratio = self._of_gear()
        gain = self._gain(x, torque)
        unknown = np.array([[M[0, 0], self.data.z], [M[1, 0], -a]])
        known = np.array([engine - clutch - M[0, 1] * gain, clutch / ratio - self.data.r_d * torque - M[1, 1] * gain])
        return np.linalg.solve(unknown, known)

    def _of_gear(self) -> tuple[NDArray[np.float64], float, float]:
        gear = self.shift.gears[self.part - 1]
        return self.data.inertia(gear), self.data.z / self.data.r_gn, self.data.gears[gear]
