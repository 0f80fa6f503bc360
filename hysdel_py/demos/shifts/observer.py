"""What moves, what clutch and brake grip, and what the model lacks, from noisy measurements while a shift runs.

The models know one coefficient of friction and one set of inertias and loads; a plant has others. The accelerations of
the shafts tell what is missing. A Kalman filter follows

* twist and the speeds of engine, secondary shaft and wheels,
* two factors, of the friction of clutch and brake,
* what is left: torques on engine and secondary shaft, and an acceleration of the wheels.

With the measured engine torque and forces its equations are linear, with coefficients that change from sample to
sample. It ends with a prediction over the delay of the actuators.

The controllers plan with effective forces, factor times force. What is left moves neither force nor engine torque,
whose limits are those of the actuators. It enters by the twist: a torque on the secondary shaft does what the drive
shaft would do with another torque, so that twist and reference, both shifted by :attr:`ShiftObserver.torque_beside`,
make the model right about the torque at the wheels, without an offset.

Engine torque and forces themselves are where the rates have led them, moved towards the measurement by a fixed share:
the actuators are integrators, so that most of the noise of a measured torque is none of its motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.response import slipping
from hysdel_py.demos.shifts.transmission import Transmission

__all__ = ["ShiftObserver"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_RANGE = (0.6, 1.6)
_NOISE = np.array([1e-4, 0.2, 0.2, 0.02])
"""Standard deviations of measured twist [rad] and of the speeds of engine, secondary shaft and wheels [rad/s]."""
_DRIFT = np.array([1e-5, 0.02, 0.02, 0.002, 0.001, 0.001, 0.4, 0.4, 0.03])
"""By how much the equations of these may be off in a sample, and how far factors [-], torques [Nm] and the acceleration
of the wheels [rad/s^2] may go. Torques pass straight on to the inputs, with their
noise."""
_FIRST_DOUBT = 0.15
_SETTLED_DOUBT = 0.03
_FIRST_BESIDE = np.array([3.0, 3.0, 2.0])  # Nm, Nm, rad/s^2
_SETTLED = np.array([0.02, 0.005])
"""How well slip and rate of the twist are known to be zero when a shift begins at rest [rad/s]."""
_STICKING = 0.3  # by which share of its force the torque of a clutch that may stick is unknown
_FACTORS = slice(4, 6)
_TORQUES = slice(6, 8)
_BESIDE = slice(6, 9)
_WHEELS = 8
_LEARNT = slice(4, 8)  # not while the clutch may stick; the wheels do not feel that
_TRUST = 0.2  # share of a measured torque or force in its estimate; noise is left with a third of its deviation
_SLIPS = 1.0  # rad/s, from which the sign of a slip is certain
_TERMS = 5  # of the exponential series: the fastest swing turns by 0.4 rad in a sample
_TWIST = 3
_MOVING = slice(_TWIST, 7)
_BRAKE, _CLUTCH = 1, 2


@dataclass(eq=False)
class ShiftObserver:
    """An estimate of the state of a shift, sample by sample.

    Parameters
    ----------
    data : Transmission
        Numbers of the model.
    gear : int
        In place; :meth:`change_gear` goes on in another one.
    sample_time : float
        [s]
    first : float
        Factor to begin with, of both frictions.
    delay : float
        Seconds until an input takes effect.
    settled : bool
        Whether the first measurement is one of a torque at rest and a clutch that just sticks: slip and rate of the
        twist are zero then, and `first` is the factor of the clutch but for a few hundredths.

    Attributes
    ----------
    factors : array of shape (2,)
        Of the friction of clutch and brake.
    beside : array of shape (3,)
        Torques on engine and secondary shaft [Nm] and acceleration of the wheels [rad/s^2] that the model lacks.
    """

    data: Transmission
    gear: int
    sample_time: float
    first: float = 1.0
    delay: float = 0.0
    settled: bool = False
    factors: Vector = field(init=False)
    beside: Vector = field(init=False)

    def __post_init__(self) -> None:
        self.factors = np.clip(np.full(2, self.first), *_RANGE)
        self.beside = np.zeros(3)
        clutch = _SETTLED_DOUBT if self.settled else _FIRST_DOUBT
        self._doubt = np.diag(np.concatenate([_NOISE, [clutch, _FIRST_DOUBT], _FIRST_BESIDE]) ** 2)
        self._moving = np.zeros(4)
        self._before: Vector | None = None
        self._inputs: Vector | None = None
        self._last = np.zeros(3)
        self.change_gear(self.gear)

    def change_gear(self, gear: int) -> None:
        """Go on in another gear; speeds, friction and what the model lacks stay."""
        self.gear, self._A = gear, slipping(self.data, gear)[0]
        self._per_torque = np.linalg.inv(self.data.inertia(gear))

    @property
    def shafts(self) -> Vector:
        """Speeds of engine and secondary shaft at the last measurement [rad/s]."""
        return self._moving[1:3].copy()

    @property
    def torque_beside(self) -> float:
        """Torque of the drive shaft that would do to the twist what the model lacks [Nm]."""
        *torques, wheels = self.beside
        twisting = self._per_torque[1] @ torques - wheels / self.data.r_d
        return float(twisting / self._per_torque[1, 1] / self.data.r_d)

    def update(self, x: Vector, last: Vector) -> Vector:
        """Take a measured state and the input before it; return the state with effective forces when inputs act.

        Parameters
        ----------
        x : array of shape (7,)
        last : array of shape (3,)
            Rates that were asked for in the sample before.
        """
        x = np.concatenate([self._led(x[:_TWIST], last), x[_TWIST:]])
        sticks = self._sticks(x)
        if self._before is None:
            self._begin(x[_MOVING])
        else:
            self._predict((self._before + x) / 2, self._drift(x[_CLUTCH] if sticks else 0.0))
            self._correct(x[_MOVING], learns=not sticks)
        self._before = x
        return self._ahead(x, last, sticks=sticks)

    def _led(self, measured: Vector, last: Vector) -> Vector:
        """Engine torque and forces now."""
        led = measured
        if self._inputs is not None:
            led = self._inputs + self.delay * self._last + (self.sample_time - self.delay) * last
        self._inputs = np.maximum(led + _TRUST * (measured - led), 0.0)
        self._last = np.array(last, dtype=float)
        return self._inputs

    def _begin(self, measured: Vector) -> None:
        """What moves is as measured; where nothing slips or swings, that is known better."""
        self._moving = measured.copy()
        if not self.settled:
            return
        data, doubt = self.data, np.diag(_NOISE**2)
        rests = np.array([[0.0, 1.0, -1.0 / data.gears[self.gear], 0.0], [0.0, 0.0, data.r_d, -1.0]])
        gain = doubt @ rests.T @ np.linalg.inv(rests @ doubt @ rests.T + np.diag(_SETTLED**2))
        self._moving -= gain @ rests @ measured
        self._doubt[:4, :4] = doubt - gain @ rests @ doubt

    def _predict(self, mean: Vector, drift: Vector) -> None:
        step = _exponential(self._generator(mean) * self.sample_time)
        self._moving = (step @ self._all())[:4]
        self._doubt = step[:-1, :-1] @ self._doubt @ step[:-1, :-1].T + drift

    def _drift(self, sticking: float) -> Matrix:
        """What a sample adds to the doubt; a force that may stick adds along what the clutch does to both shafts."""
        along = np.zeros(len(_DRIFT))
        along[1:3] = self._per_torque @ [-1.0, 1.0 / self.data.gears[self.gear]]
        along *= self.sample_time * _STICKING * self.data.mu * sticking
        return np.diag(_DRIFT**2) + np.outer(along, along)

    def _all(self) -> Vector:
        return np.concatenate([self._moving, self.factors, self.beside, [1.0]])

    def _correct(self, measured: Vector, *, learns: bool) -> None:
        gain = self._doubt[:, :4] @ np.linalg.inv(self._doubt[:4, :4] + np.diag(_NOISE**2))
        if not learns:
            gain[_LEARNT] = 0.0
            self._doubt[:4, _LEARNT], self._doubt[_LEARNT, :4] = 0.0, 0.0
        surprise = measured - self._moving
        self._moving = self._moving + gain[:4] @ surprise
        self.factors = np.clip(self.factors + gain[_FACTORS] @ surprise, *_RANGE)
        self.beside = self.beside + gain[_BESIDE] @ surprise
        self._doubt = self._doubt - gain @ self._doubt[:4]
        self._doubt = (self._doubt + self._doubt.T) / 2

    def _generator(self, inputs: Vector) -> Matrix:
        """Of all that is followed and the number one, for an engine torque and forces that stay."""
        _, engine, secondary, _ = self._moving
        clutch = -1.0 if self.data.relative_speed(self.gear, engine, secondary) < -_SLIPS else 1.0
        brake = -np.sign(self.data.flywheel_speed(engine, secondary))
        rows, found = self._A[_MOVING], np.zeros((10, 10))
        found[:4, :4] = rows[:, _MOVING]
        found[:4, 4] = rows[:, _CLUTCH] * clutch * self.data.mu * max(inputs[_CLUTCH], 0.0)
        found[:4, 5] = rows[:, _BRAKE] * brake * self.data.mu * max(inputs[_BRAKE], 0.0)
        found[1:3, _TORQUES], found[3, _WHEELS] = self._per_torque, 1.0
        found[:4, -1] = rows[:, 0] * inputs[0]
        return found

    def _ahead(self, x: Vector, last: Vector, *, sticks: bool) -> Vector:
        """The state when the next input begins to act, with effective forces; what sticks stays."""
        inputs, moving = np.array(x[:3], dtype=float), self._moving
        if self.delay and not sticks:
            step = _exponential(self._generator(inputs + self.delay / 2 * last) * self.delay)
            moving = (step @ self._all())[:4]
        if self.delay:
            inputs = np.maximum(inputs + self.delay * last, 0.0)
        inputs = inputs * [1.0, self.factors[1], self.factors[0]]
        return np.concatenate([inputs, moving - [self.torque_beside / self.data.k, 0.0, 0.0, 0.0]])

    def _sticks(self, x: Vector) -> bool:
        """Whether a clutch that carries torque may have stuck or turned round, by what is estimated or measured."""
        speeds = [self._moving, x[_MOVING], (x if self._before is None else self._before)[_MOVING]]
        slips = [abs(self.data.relative_speed(self.gear, moving[1], moving[2])) for moving in speeds]
        return bool(x[_CLUTCH] > 1.0 and min(slips) < _SLIPS)


def _exponential(matrix: Matrix) -> Matrix:
    """Of a small matrix, by its series."""
    found = term = np.eye(len(matrix))
    for k in range(1, _TERMS + 1):
        term = term @ matrix / k
        found = found + term
    return found
