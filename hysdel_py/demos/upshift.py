"""The controllable phase of a 1-2 upshift by analytical dynamic programming, section 9.2 of the document.

J.R.P. Kusters, "Modelling and coordinated control of advanced automotive transmissions", TU/e, DCT 2005-58, figure 9.2:
the one-way clutch of first gear has let go, the wet clutch carries the whole torque, and at the end its two sides turn
equally fast. The document gives the structure and the cost but no numbers. Here ratios, final drive, vehicle and
driveshaft are those of its transmission in section 10.5, seen at the gearbox output; the gearbox inertia and the lag of
the clutch are ours.

::

    Je we' = Te - Tc                              engine
    Jo wo' = i2 Tc - k twist - d (wo - wv)        output side of the clutch, in second gear
    twist' = wo - wv                              driveshaft
    Jv wv' = k twist + d (wo - wv) - b wv - TL    vehicle
    lag Tc' = uc - Tc                             clutch actuator

The inputs are the engine torque Te and the wanted clutch torque uc; the relative speed ``we - i2 wo`` is zero at the
end. The process cost is the squared change of the vehicle's acceleration from step to step, and deviations of the
inputs from their values at the start.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.dynamic_programming.analytical import AnalyticalDp

__all__ = ["Upshift"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Upshift:
    """Parameters of the shift, at the gearbox output; torques in Nm, speeds in rad/s, inertias in kg m^2.

    Attributes
    ----------
    engine_inertia, gearbox_inertia, vehicle_inertia : float
    stiffness, damping : float
        Of the driveshaft [Nm/rad, Nm s/rad].
    drag, load : float
        Torque against the vehicle: a part that grows with speed [Nm s/rad] and a constant one [Nm].
    lag : float
        Time constant of the clutch actuator [s].
    first, second : float
        Ratios engine to gearbox output.
    engine_torque : float
        At the start.
    output_speed : float
        At the start.
    duration, stages : float, int
        Length of the phase [s] and number of steps.
    jerk, effort : float
        Weights of the change of acceleration and of the inputs.
    """

    engine_inertia: float = 0.154
    gearbox_inertia: float = 0.05
    vehicle_inertia: float = 110.0 / 3.737**2
    stiffness: float = 6000.0 / 3.737**2
    damping: float = 6.0 / 3.737**2
    drag: float = 10.0 / 3.737**2
    load: float = 20.0
    lag: float = 0.02
    first: float = 3.308
    second: float = 1.913
    engine_torque: float = 100.0
    output_speed: float = 40.0 * 3.737
    duration: float = 0.5
    stages: int = 50
    jerk: float = 1000.0
    effort: float = 1e-5

    @property
    def start(self) -> Matrix:
        """State when the one-way clutch lets go: the driveshaft still carries the torque of first gear."""
        torque = self.first * self.engine_torque
        speed = self.output_speed
        return np.array([self.first * speed, speed, torque / self.stiffness, speed, torque / self.second])

    @property
    def first_inputs(self) -> Matrix:
        """Engine torque and clutch torque at the start, from which deviations are weighed."""
        return np.array([self.engine_torque, self.start[4]])

    @property
    def relative_speed(self) -> Matrix:
        """Row that gives the relative speed of the clutch from the state."""
        return np.array([1.0, -self.second, 0.0, 0.0, 0.0])

    @property
    def acceleration(self) -> tuple[Matrix, float]:
        """Row and number that give the acceleration of the vehicle [rad/s^2]."""
        k, d, b, J = self.stiffness, self.damping, self.drag, self.vehicle_inertia
        return np.array([0.0, d, k, -d - b, 0.0]) / J, -self.load / J

    def program(self) -> AnalyticalDp:
        """The shift as a linear system with quadratic cost and a terminal equality."""
        A, B, drift = self._dynamics()
        sampled = AnalyticalDp.from_continuous(
            A, B, self.duration / self.stages, drift, stages=1, Q=np.zeros((5, 5)), R=np.eye(2)
        )
        A, B, drift = np.asarray(sampled.A), np.asarray(sampled.B), np.asarray(sampled.d)
        row, _ = self.acceleration
        of_state, of_input, offset = row @ (A - np.eye(5)), row @ B, float(row @ drift)
        R = self.effort * np.eye(2)
        return AnalyticalDp(
            A, B, self.stages, d=drift,
            Q=self.jerk * np.outer(of_state, of_state), S=self.jerk * np.outer(of_state, of_input),
            R=self.jerk * np.outer(of_input, of_input) + R,
            q=self.jerk * offset * of_state, r=self.jerk * offset * of_input - R @ self.first_inputs,
            C=self.relative_speed[None], c=np.zeros(1),
            names={"x": ("we", "wo", "twist", "wv", "Tc"), "u": ("Te", "uc")},
        )  # fmt: skip

    def _dynamics(self) -> tuple[Matrix, Matrix, Matrix]:
        Je, Jo, Jv, k, d = (
            self.engine_inertia, self.gearbox_inertia, self.vehicle_inertia, self.stiffness, self.damping,
        )  # fmt: skip
        A = np.array(
            [
                [0.0, 0.0, 0.0, 0.0, -1.0 / Je],
                [0.0, -d / Jo, -k / Jo, d / Jo, self.second / Jo],
                [0.0, 1.0, 0.0, -1.0, 0.0],
                [0.0, d / Jv, k / Jv, -(d + self.drag) / Jv, 0.0],
                [0.0, 0.0, 0.0, 0.0, -1.0 / self.lag],
            ]
        )
        B = np.zeros((5, 2))
        B[0, 0], B[4, 1] = 1.0 / Je, 1.0 / self.lag
        return A, B, np.array([0.0, 0.0, 0.0, -self.load / Jv, 0.0])
