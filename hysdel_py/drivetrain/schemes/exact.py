"""The exact solution of linear drivetrains with piecewise linear inputs: matrix exponentials between located events.

In one mode the state ``Z = (u, e, 1, s)`` with the time s since the kink follows ``Z' = A Z``, and the torques are
linear in it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from hysdel_py.drivetrain.decomposition import ContactSolver, independent_contacts
from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Plant
from hysdel_py.drivetrain.kernels.time_stepping import NEGATIVE, POSITIVE, STICK
from hysdel_py.drivetrain.schemes.event_driven import trajectory_of_log
from hysdel_py.drivetrain.schemes.event_loop import Piece, run_events
from hysdel_py.drivetrain.schemes.grid import sample_times
from hysdel_py.drivetrain.schemes.options import Exact
from hysdel_py.drivetrain.schemes.segments import Segment
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory
from hysdel_py.errors import ArgumentError

__all__ = ["integrate"]

Matrix = NDArray[np.float64]
Modes = NDArray[np.int64]

_SIMPSON = (1 / 6, 4 / 6, 1 / 6)


def integrate(
    equations: Equations, u: Matrix, e: Matrix, until: float, scheme: Exact, sample: float | None
) -> DrivetrainTrajectory:
    """Run the scheme from speeds u and twists e; see :meth:`Drivetrain.simulate`.

    Raises
    ------
    ArgumentError
        The equations are not linear, or an input is a function of time.
    """
    equations.piecewise_linear()
    if not equations.linear:
        raise ArgumentError(
            "Exact needs linear equations: drag, engine maps and Stribeck friction are not. Take hys.EventDriven()"
        )
    plant, solver = equations.plant, ContactSolver("boxed", "active-set")
    flow = _ExactFlow(plant, equations, scheme.look)
    log = run_events(equations, plant, flow, solver, u, e, until, sample_times(until, sample))
    return trajectory_of_log(equations, plant, log, scheme, solver, {})


@dataclass(frozen=True, eq=False, slots=True)
class _Linear:
    """One mode in one segment: ``Z' = A Z``; torques and their limits per Z."""

    A: Matrix
    torque: Matrix
    lower: Matrix
    upper: Matrix


@dataclass(slots=True)
class _ExactFlow:
    """Matrix exponentials in one mode."""

    plant: Plant
    equations: Equations
    look: float
    problem: str = ""
    _known: dict[tuple[int, bytes], _Linear] = field(default_factory=dict)

    def pieces(self, segment: Segment, modes: Modes, t: float, z: Matrix) -> Iterator[Piece]:
        """Pieces of one look from t to the end of the segment."""
        linear = self._linear(segment, modes)
        edges = np.linspace(t, segment.end, max(1, ceil((segment.end - t) / self.look)) + 1)
        half = expm(0.5 * (edges[1] - edges[0]) * linear.A)
        for start, end in pairwise(edges.tolist()):
            after = self._after(segment, linear, start, end - start, z, half)
            yield Piece(start, end, self._between(segment, linear, start, end, z, after), 1)
            z = after

    def _after(self, segment: Segment, linear: _Linear, start: float, dt: float, z: Matrix, half: Matrix) -> Matrix:
        """State after dt, given the exponential of half of it; works by Simpson's rule."""
        Z = self._extended(segment, start, z)
        middle = half @ Z
        end = half @ middle
        powers = [
            self._powers(segment, linear, start + share * dt, X) for share, X in ((0.0, Z), (0.5, middle), (1.0, end))
        ]
        works = z[-3:] + dt * sum(weight * power for weight, power in zip(_SIMPSON, powers, strict=True))
        return np.concatenate([end[:-2], works])

    def _between(
        self, segment: Segment, linear: _Linear, start: float, end: float, z: Matrix, after: Matrix
    ) -> Callable[[float], Matrix]:
        """State at any time of a piece."""

        def state(t: float) -> Matrix:
            if t >= end:
                return after
            return self._after(segment, linear, start, t - start, z, expm(0.5 * (t - start) * linear.A))

        return state

    def torques(self, segment: Segment, modes: Modes, t: float, z: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """Torques lambda and their limits."""
        linear, Z = self._linear(segment, modes), self._extended(segment, t, z)
        return linear.torque @ Z, linear.lower @ Z, linear.upper @ Z

    def _extended(self, segment: Segment, t: float, z: Matrix) -> Matrix:
        return np.concatenate([z[:-3], [1.0, t - segment.start]])

    def _powers(self, segment: Segment, linear: _Linear, t: float, Z: Matrix) -> Matrix:
        """Power of sources, losses and friction."""
        n, inputs = len(self.plant.M), segment.at(t)
        u, e, torque = Z[:n], Z[n:-2], linear.torque @ Z
        source = inputs.force @ u - torque @ inputs.slip + (self.plant.k * e) @ inputs.twist
        return np.array([source, -u @ self.plant.D @ u, torque @ (u @ self.plant.W + inputs.slip)])

    def _linear(self, segment: Segment, modes: Modes) -> _Linear:
        key = (id(segment), modes.tobytes())
        if key not in self._known:
            self._known[key] = _linear_mode(self.plant, segment, modes)
        return self._known[key]


def _linear_mode(plant: Plant, segment: Segment, modes: Modes) -> _Linear:
    """Matrices of one mode."""
    n, m, count = len(plant.M), len(plant.k), len(modes)
    size = n + m + 2
    h = np.zeros((n, size))
    h[:, :n] = -plant.D
    h[:, n : n + m] = -plant.B * plant.k
    h[:, -2], h[:, -1] = segment.base.force, segment.rate.force
    pressure = np.zeros((count, size))
    pressure[:, -2], pressure[:, -1] = segment.base.pressure, segment.rate.pressure
    pressure[segment.open] = 0.0
    sticks = modes == STICK
    friction = np.where(sticks, plant.laws[:, 0], plant.laws[:, 1])
    lower, upper = ((plant.side[:, i] * friction)[:, None] * pressure for i in (0, 1))
    torque = np.where((modes == POSITIVE)[:, None], lower, np.where((modes == NEGATIVE)[:, None], upper, 0.0))
    index = independent_contacts(plant.G, np.flatnonzero(sticks))  # others carry nothing, as in the choice of modes
    if len(index):
        free = plant.W[:, index].T @ plant.Minv @ (h + plant.W @ torque)
        free[:, -2] += segment.base.slip_rate[index]
        torque[index] = -np.linalg.solve(plant.G[np.ix_(index, index)], free)
    A = np.zeros((size, size))
    A[:n] = plant.Minv @ (h + plant.W @ torque)
    A[n : n + m, :n] = plant.B.T
    A[n : n + m, -2], A[n : n + m, -1] = segment.base.twist, segment.rate.twist
    A[-1, -2] = 1.0
    return _Linear(A, torque, lower, upper)
