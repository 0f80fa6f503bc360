"""The transmission with dry friction as a set-valued law: clutch and brake slip and stick.

The shafts are put together from components of a :class:`Drivetrain` and simulated by time-stepping, in steps far finer
than the sample time of a controller. The models of the controllers know slipping friction only, the brake with the sign
that it has on a flywheel turning backwards; here the brake opposes the flywheel whichever way it turns, holds it when
it stops, and the clutch holds the shafts together when they meet.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.demos.shifts.transmission import STATES, Transmission
from hysdel_py.drivetrain.components import (
    Brake,
    Clutch,
    Gear,
    Inertia,
    Load,
    PlanetaryGear,
    SpringDamper,
    TorqueSource,
)
from hysdel_py.drivetrain.drivetrain import Drivetrain
from hysdel_py.drivetrain.schemes.options import Moreau
from hysdel_py.drivetrain.signals import PiecewiseLinear
from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory
    from hysdel_py.systems.signals import Variable

__all__ = ["FINE", "Deviation", "ShiftPlant", "drivetrain"]

Vector = NDArray[np.float64]

SAMPLE_TIME = 0.01
STEPS_PER_SAMPLE = 20
FINE = (*STATES, "Tc", "Tb", "wf", "slip")
"""Columns of the fine record: the states, torques of clutch and brake, flywheel speed, slip of the clutch."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """How a plant differs from the model of its controller.

    Attributes
    ----------
    friction, inertia, load, mass : float
        Factors of both friction coefficients; of the inertias of engine and flywheel; of the load of the vehicle per
        speed; of the inertia of the vehicle.
    delay : float
        Seconds until an input takes effect, within a sample.
    """

    friction: float = 1.0
    inertia: float = 1.0
    load: float = 1.0
    mass: float = 1.0
    delay: float = 0.0

    def __post_init__(self) -> None:
        for name in ("friction", "inertia", "load", "mass"):
            if not getattr(self, name) > 0:
                raise ArgumentError(f"{name} is {getattr(self, name)!r}: a factor above zero was expected")
        if not 0.0 <= self.delay < SAMPLE_TIME:
            raise ArgumentError(f"delay is {self.delay!r}: seconds from 0 to less than {SAMPLE_TIME} were expected")

    def of(self, data: Transmission) -> Transmission:
        """The parameters of the plant."""
        return replace(
            data, mu=self.friction * data.mu, J_e=self.inertia * data.J_e, J_f=self.inertia * data.J_f,
            b_v=self.load * data.b_v, J_v=self.mass * data.J_v,
        )  # fmt: skip


def drivetrain(
    data: Transmission, gear: int, *, torque: ArrayLike, brake: ArrayLike, clutch: ArrayLike, span: float
) -> Drivetrain:
    """The transmission in one gear, with inputs that go evenly from a first to a last value over a time span.

    Parameters
    ----------
    torque, brake, clutch : pairs of float
        First and last engine torque [Nm], force of the brake [N], force of the clutch [N].
    span : float
        [s]
    """
    signals = [PiecewiseLinear((0.0, span), pair) for pair in (torque, brake, clutch)]
    return Drivetrain(
        Inertia("engine", data.J_e),
        Inertia("flywheel", data.J_f),
        Inertia("primary", data.J_p),
        Inertia("secondary", data.J_s),
        Inertia("wheels", data.J_v),
        PlanetaryGear("planetary", "flywheel", "carrier", "engine", data.z),
        Gear("branch", "carrier", "secondary", data.z / ((data.z + 1) * data.r_gn)),
        Gear("gearbox", "primary", "secondary", 1 / data.gears[gear]),
        Gear("final_drive", "driveshaft", "secondary", data.r_d),
        SpringDamper("twist", "driveshaft", "wheels", data.k, data.d),
        Clutch("clutch", "engine", "primary", signals[2], data.mu),
        Brake("brake", "flywheel", signals[1], data.mu),
        TorqueSource("engine_torque", "engine", signals[0]),
        Load("road", "wheels", damping=data.b_v),
    )


class ShiftPlant:
    """The transmission in one gear, seen at the sample times of a controller.

    `x` and `u` name the variables, those of the models `bist_part1` and `bist_part2`: the inputs are rates of engine
    torque and of both forces, held over a sample. Torque and forces do not leave their ranges, as actuators do not.

    Parameters
    ----------
    model : Model
        Names and ranges of the variables, numbers of the transmission.
    data : Transmission
        Numbers of the controller.
    gear : int
    deviation : Deviation, optional
        Where the plant differs from them.
    sample_time : float
        [s]

    Attributes
    ----------
    fine : list of arrays of shape (STEPS_PER_SAMPLE, len(FINE))
        What happened within each sample.
    last : array of shape (3,)
        The input of the sample before, which a delayed actuator still follows.
    """

    def __init__(
        self,
        model: Any,
        data: Transmission,
        gear: int,
        deviation: Deviation | None = None,
        *,
        sample_time: float = SAMPLE_TIME,
    ) -> None:
        self.sample_time = sample_time
        self.x, self.u = model.dha.x, model.dha.u
        self.gear = gear
        deviation = deviation or Deviation()
        self.data, self.delay = deviation.of(data), deviation.delay
        self.last: Vector = np.zeros(3)
        self._low, self._high = (np.array([end(v) for v in self.x[:3]]) for end in (_low, _high))
        still = (0.0, 0.0)
        self._equations = drivetrain(
            self.data, gear, torque=still, brake=still, clutch=still, span=sample_time
        ).equations
        self.fine: list[Vector] = []

    def step(self, x: Vector, u: Vector) -> Vector:
        """One sample."""
        knots, inputs = self._ramps(x[:3], np.asarray(u, dtype=float))
        run = self._moving(knots, inputs).simulate(
            self._start(x), self.sample_time, Moreau(dt=self.sample_time / STEPS_PER_SAMPLE)
        )
        t = np.linspace(0.0, self.sample_time, STEPS_PER_SAMPLE + 1)
        record = _columns(run, np.column_stack([np.interp(t, knots, column) for column in inputs.T]))
        self.fine.append(record[1:])
        after: Vector = record[-1, : len(STATES)].copy()
        return after

    def _ramps(self, first: Vector, u: Vector) -> tuple[tuple[float, ...], Vector]:
        """Torque and forces at the ends of a sample, and where a delayed input begins."""
        middle = np.clip(first + self.delay * self.last, self._low, self._high)
        last = np.clip(middle + (self.sample_time - self.delay) * u, self._low, self._high)
        self.last = u
        if self.delay == 0.0:
            return (0.0, self.sample_time), np.array([first, last])
        return (0.0, self.delay, self.sample_time), np.array([first, middle, last])

    def _moving(self, knots: tuple[float, ...], inputs: Vector) -> Drivetrain:
        """The drivetrain with inputs that go straight from one knot to the next."""
        columns = dict(zip(("engine_torque", "brake", "clutch"), inputs.T, strict=True))
        names = self._equations.signal_names
        signals = tuple(
            PiecewiseLinear(knots, tuple(columns[name])) if name in columns else signal
            for name, signal in zip(names, self._equations.signals, strict=True)
        )
        return Drivetrain.from_equations(replace(self._equations, signals=signals))

    def _start(self, x: Vector) -> dict[str, float]:
        _, _, _, dphi, engine, secondary, wheels = (float(value) for value in x)
        speeds = {
            "engine": engine, "secondary": secondary, "wheels": wheels,
            "flywheel": self.data.flywheel_speed(engine, secondary),
            "primary": secondary / self.data.gears[self.gear],
        }  # fmt: skip
        names = self._equations.names.coordinates
        return {name: speeds[name] for name in names} | {"twist": dphi}


def _low(variable: Variable) -> float:
    return variable.low


def _high(variable: Variable) -> float:
    return variable.high


def _columns(run: DrivetrainTrajectory, inputs: Vector) -> Vector:
    """The columns of FINE from a run."""
    named = [run[name] for name in ("twist", "engine", "secondary", "wheels")]
    names = run.names.contacts
    torques = [run.torques[:, names.index(name)] for name in ("clutch", "brake")]
    slip = run.slips[:, names.index("clutch")]
    return np.column_stack([inputs, *named, *torques, run["flywheel"], slip])
