"""The transmission with a clutch that slips forwards and a flywheel that turns backwards: linear, sampled exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.references import SAMPLE_TIME
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.systems.lti import Lti

__all__ = ["Response", "slipping", "unit"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_WE, _WS, _WV = 4, 5, 6


def slipping(data: Transmission, gear: int) -> tuple[Matrix, Matrix, Vector]:
    """Matrices A and B of the transmission with forward slip and backward flywheel, and the row of the torque.

    The states are those of the models, with torques of brake and clutch in place of forces; inertias and torques are
    those of (10.4) to (10.7) before the elimination of the inner forces.
    """
    ratio, a = data.gears[gear], data.z / data.r_gn
    torque = np.array([0.0, 0.0, 0.0, data.k, 0.0, data.d * data.r_d, -data.d])
    moving = np.array([[1.0, -data.z, -1.0, 0.0, 0.0, 0.0, 0.0], [0.0, a, 1.0 / ratio, 0.0, 0.0, 0.0, 0.0]])
    moving[1] -= data.r_d * torque
    A = np.zeros((7, 7))
    A[3, [_WS, _WV]] = data.r_d, -1.0
    A[[_WE, _WS]] = np.linalg.solve(data.inertia(gear), moving)
    A[_WV] = torque / data.J_v
    A[_WV, _WV] -= data.b_v / data.J_v
    return A, np.vstack([np.eye(3), np.zeros((4, 3))]), torque


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """States at the samples: those without inputs, and what the rates add.

    Attributes
    ----------
    A : array of shape (7, 7)
        Of one sample.
    powers : array of shape (steps + 1, 7, 3)
        States so many samples after a unit rate.
    torque : array of shape (7,)
        Row of the torque of the drive shaft.
    """

    A: Matrix
    powers: Matrix
    torque: Vector

    @classmethod
    def of(cls, data: Transmission, gear: int, steps: int) -> Response:
        """The response in one gear over so many samples."""
        A, B, torque = slipping(data, gear)
        sampled = Lti.sampled(A, B, ts=SAMPLE_TIME)
        powers = np.zeros((steps + 1, 7, 3))
        powers[1] = sampled.B
        for k in range(2, steps + 1):
            powers[k] = np.asarray(sampled.A) @ powers[k - 1]
        return cls(np.asarray(sampled.A), powers, torque)

    def free(self, x0: Vector) -> Matrix:
        """States at the samples without inputs."""
        states = [x0]
        for _ in range(len(self.powers) - 1):
            states.append(self.A @ states[-1])
        return np.array(states)

    def rows(self, row: Vector) -> Matrix:
        """A row of the state at the samples after the first, over the rates."""
        steps = len(self.powers) - 1
        response = row @ self.powers  # (steps + 1, 3)
        found = np.zeros((steps, steps, 3))
        for k in range(steps):
            found[k, : k + 1] = response[k + 1 : 0 : -1]
        return found.reshape(steps, 3 * steps)

    def by(self, u: Vector) -> Matrix:
        """What the rates add to the states at the samples."""
        added = [np.zeros(len(self.powers)) for _ in range(7)]
        for i in range(7):
            added[i][1:] = self.rows(unit(i)) @ u
        return np.array(added).T


@cache
def unit(i: int) -> Vector:
    """The row of one state."""
    row = np.zeros(7)
    row[i] = 1.0
    row.setflags(write=False)
    return row
