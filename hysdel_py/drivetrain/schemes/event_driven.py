"""Event-driven integration with dense output, by variable steps or by fixed ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.decomposition import ContactSolver
from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant, Record
from hysdel_py.drivetrain.kernels.contact_rules import HELD
from hysdel_py.drivetrain.kernels.fixed_step import stage
from hysdel_py.drivetrain.kernels.time_stepping import STICK
from hysdel_py.drivetrain.recording import trajectory_of
from hysdel_py.drivetrain.schemes.event_loop import Log, Piece, run_events
from hysdel_py.drivetrain.schemes.fixed_step import METHODS
from hysdel_py.drivetrain.schemes.grid import sample_times
from hysdel_py.drivetrain.schemes.option_checks import INTEGRATORS
from hysdel_py.drivetrain.schemes.options import EventDriven, Exact, describe
from hysdel_py.drivetrain.schemes.segments import Segment
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory

__all__ = ["integrate", "trajectory_of_log"]

Matrix = NDArray[np.float64]
Modes = NDArray[np.int64]

_LOOKS = 4
"""Places inside a step of variable size at which indicators are looked at."""

_WORK_TOLERANCE = 1e6
"""Works do not take part in the error control."""


def integrate(
    equations: Equations, u: Matrix, e: Matrix, until: float, scheme: EventDriven, sample: float | None
) -> DrivetrainTrajectory:
    """Run the scheme from speeds u and twists e; see :meth:`Drivetrain.simulate`."""
    plant = equations.plant
    flow = _OdeFlow(plant, scheme)
    solver = ContactSolver(scheme.decomposition, scheme.solver)
    log = run_events(equations, plant, flow, solver, u, e, until, sample_times(until, sample))
    return trajectory_of_log(equations, plant, log, scheme, solver, {"evaluations": flow.evaluations})


def trajectory_of_log(
    equations: Equations,
    plant: Plant,
    log: Log,
    scheme: EventDriven | Exact,
    solver: ContactSolver,
    info: dict[str, Any],
) -> DrivetrainTrajectory:
    """The trajectory of an event-driven run."""
    n, m = len(plant.M), len(plant.k)
    states = np.array(log.states)
    torques, lower, upper = (np.array([c[i] for c in log.contacts]).reshape(len(states), -1) for i in range(3))
    modes = np.array([c[3] for c in log.contacts], dtype=np.int64).reshape(len(states), -1)
    record = Record(
        states[:, :n], states[:, n : n + m], torques, lower, upper, modes, states[:, n + m :],
        np.zeros(0, dtype=np.int64),
    )  # fmt: skip
    t = np.array(log.times)
    about = {"scheme": describe(scheme), "steps": log.steps, "solves": solver.solves, "failures": solver.failures}
    messages = (log.message,) if log.message else ()
    step = np.full(len(t), 1e-3)  # residuals are those of the torques over a millisecond
    return trajectory_of(
        equations, t, record, events=tuple(log.events), messages=messages, info=about | info, step=step
    )  # fmt: skip


@dataclass(slots=True)
class _OdeFlow:
    """Integration of the ordinary differential equation of one mode."""

    plant: Plant
    scheme: EventDriven
    evaluations: int = 0

    def pieces(self, segment: Segment, modes: Modes, t: float, z: Matrix) -> Iterator[Piece]:
        """Steps from t to the end of the segment, with dense output."""

        def rates(at: float, state: Matrix) -> Matrix:
            self.evaluations += 1
            return self._evaluate(segment, modes, at, state)[0]

        if self.scheme.integrator in INTEGRATORS:
            yield from _fixed_pieces(rates, self.scheme, t, segment.end, z)
            return
        n, m = len(self.plant.M), len(self.plant.k)
        atol = np.concatenate([np.full(n + m, self.scheme.atol), np.full(3, _WORK_TOLERANCE)])
        solver = _solver_class(self.scheme.integrator)(
            rates, t, z, segment.end, max_step=self.scheme.max_step, rtol=self.scheme.rtol, atol=atol
        )
        while solver.status == "running":
            problem = solver.step()
            if solver.status == "failed":
                raise ArithmeticError(problem)
            yield Piece(solver.t_old, solver.t, solver.dense_output(), _LOOKS)

    def torques(self, segment: Segment, modes: Modes, t: float, z: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """Torques lambda and their limits: static ones for contacts that stick."""
        _, torque, slide, stick = self._evaluate(segment, modes, t, z)
        sticks = modes == STICK
        return torque, np.where(sticks, stick[0], slide[0]), np.where(sticks, stick[1], slide[1])

    def _evaluate(
        self, segment: Segment, modes: Modes, t: float, z: Matrix
    ) -> tuple[Matrix, Matrix, tuple[Matrix, Matrix], tuple[Matrix, Matrix]]:
        n, m, count = len(self.plant.M), len(self.plant.k), len(modes)
        inputs = Inputs(*(array[None, None, :] for array in segment.at(t)))
        slide, stick = (np.zeros(count), np.zeros(count)), (np.zeros(count), np.zeros(count))
        torque, rate = np.zeros(count), np.zeros(n + m + 3)
        u, e = np.ascontiguousarray(z[:n]), np.ascontiguousarray(z[n : n + m])
        stage(self.plant, inputs, 0, 0, u, e, HELD, (0.0, 0.0, 0.0), modes, slide, stick, torque, rate)
        return rate, torque, slide, stick


def _solver_class(name: str) -> Any:
    from scipy.integrate import DOP853, RK45, Radau

    return {"dop853": DOP853, "rk45": RK45, "radau": Radau}[name]


def _fixed_pieces(
    rates: Callable[[float, Matrix], Matrix], scheme: EventDriven, start: float, end: float, z: Matrix
) -> Iterator[Piece]:
    """Runge-Kutta steps of equal size with cubic interpolation between them."""
    a, b, _, _ = METHODS[scheme.integrator]
    nodes = [sum(row) for row in a]
    edges = np.linspace(start, end, max(1, ceil((end - start) / scheme.dt - 1e-9)) + 1).tolist()
    slope = rates(start, z)
    for t, stop in pairwise(edges):
        dt = stop - t
        stages = [slope]
        for row, node in zip(a[1:], nodes[1:], strict=True):
            increment = sum(weight * stage for weight, stage in zip(row, stages, strict=False))
            stages.append(rates(t + node * dt, z + dt * increment))
        after = z + dt * sum(weight * stage for weight, stage in zip(b, stages, strict=True))
        slope_after = rates(stop, after)
        yield Piece(t, stop, _hermite(t, stop, z, after, slope, slope_after), 1)
        z, slope = after, slope_after


def _hermite(
    start: float, end: float, a: Matrix, b: Matrix, slope_a: Matrix, slope_b: Matrix
) -> Callable[[float], Matrix]:
    """Cubic interpolation by the values and slopes at both ends."""
    width = end - start

    def state(t: float) -> Matrix:
        if t >= end:
            return b
        s = (t - start) / width
        value: Matrix = (1 + 2 * s) * (1 - s) ** 2 * a + s**2 * (3 - 2 * s) * b
        return value + width * (s * (1 - s) ** 2 * slope_a - s**2 * (1 - s) * slope_b)

    return state
