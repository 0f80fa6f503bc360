"""Engagement of a dry clutch by numerical dynamic programming, section 9.1 of the document.

J.R.P. Kusters, "Modelling and coordinated control of advanced automotive transmissions", TU/e, DCT 2005-58: weights,
span, sample time, limits of the engine speed and of the relative speed are its own. It gives neither the start, nor the
rate limit and the range of the clutch torque; here the engine starts at 120 rad/s with the vehicle at rest and the
clutch open, and the torque reaches 180 Nm at 800 Nm/s at most. Its cost needs two decisions: increments of the input
and the relative acceleration at lock-up count by their size, and the slip of a step is that at its end.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.dynamic_programming.forward import ForwardSearch
from hysdel_py.control.dynamic_programming.grids import Axis
from hysdel_py.control.dynamic_programming.plan import DpPlan
from hysdel_py.control.dynamic_programming.problem import DynamicProgram
from hysdel_py.control.dynamic_programming.settings import DpSettings
from hysdel_py.control.dynamic_programming.table import FeedbackTable
from hysdel_py.demos.dry_clutch import DryClutch, Scheme
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["OPEN_CLUTCH", "START", "DpDemo", "Engagement", "engage_by_dp", "engagement_problem", "judged_engagement"]

Matrix = NDArray[np.float64]
Progress = Callable[[int, int], Any]

START = (120.0, 0.0)
"""Speeds of engine and vehicle side [rad/s]."""
OPEN_CLUTCH = 0.0
"""Clutch torque before the first step [Nm]."""
STAGES = 20
LEAST_ENGINE_SPEED, LARGEST_ENGINE_SPEED, LARGEST_SLIP = 80.0, 150.0, 150.0

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Engagement:
    """Cost and constraints of an engagement, for many points at once.

    Attributes
    ----------
    clutch : DryClutch
    change, slip, speed, lock_up : float
        Weights kappa, nu, xi, theta of the size of the increment, the squared slip, the squared deviation of the engine
        speed from `speed_reference`, and the size of the relative acceleration at lock-up.
    band : float
        The clutch counts as stuck up to this slip [rad/s].
    largest_change : float
        Of the clutch torque in one step [Nm].
    """

    clutch: DryClutch = field(default_factory=DryClutch)
    change: float = 3.0
    slip: float = 5.0
    speed: float = 0.0
    lock_up: float = 0.1 * STAGES
    speed_reference: float = 100.0
    band: float = 1.0
    largest_change: float = 40.0

    def cost(self, x: Matrix, u: Matrix, x1: Matrix) -> Matrix:
        """Cost of a step without that of the increment."""
        slip = x1[:, 0] - x1[:, 1]
        ahead = self.slip * slip**2 + self.speed * (x1[:, 0] - self.speed_reference) ** 2
        return np.asarray(ahead + self.lock_up * self.locks(x, x1) * np.abs(self.clutch.slip_acceleration(x, u)))

    def locks(self, x: Matrix, x1: Matrix) -> NDArray[np.bool_]:
        """Whether the slip enters the band in a step."""
        return np.asarray((x[:, 0] - x[:, 1] > self.band) & (np.abs(x1[:, 0] - x1[:, 1]) <= self.band))

    def change_cost(self, before: Matrix, u: Matrix) -> Matrix:
        """Cost of the increment of the clutch torque, infinite beyond its rate."""
        size = np.abs(u[:, 0] - before[:, 0])
        return np.where(size <= self.largest_change + _ROUNDING, self.change * size, np.inf)

    def admissible(self, x: Matrix, u: Matrix, x1: Matrix) -> NDArray[np.bool_]:  # noqa: ARG002 - as called
        """Relative speed within its limits."""
        slip = x1[:, 0] - x1[:, 1]
        return np.asarray((slip >= -self.band) & (slip <= LARGEST_SLIP))

    def end_set(self, x: Matrix) -> NDArray[np.bool_]:
        """Stuck."""
        return np.asarray(np.abs(x[:, 0] - x[:, 1]) <= self.band)


def engagement_problem(
    grid: float = 1.0,
    torque_step: float = 10.0,
    *,
    engine_torques: int = 0,
    scheme: Scheme = "exact",
    settings: DpSettings | None = None,
) -> DynamicProgram:
    """The engagement as a dynamic program.

    Parameters
    ----------
    grid : float
        Distance of the nodes of both speeds [rad/s].
    torque_step : float
        Distance of the values of the clutch torque [Nm].
    engine_torques : int
        Number of values of the engine torque from 0 to 140 Nm as a second input; 0 keeps it at 100 Nm.
    scheme : {"exact", "implicit"}
        Step of the plant.
    """
    task = Engagement(DryClutch(scheme=scheme))
    inputs = [Axis.spaced("Tc", 0.0, 180.0, torque_step, "Nm")]
    if engine_torques:
        inputs.append(Axis("Te", 0.0, 140.0, engine_torques, "Nm"))
    states = (
        Axis.spaced("we", LEAST_ENGINE_SPEED, LARGEST_ENGINE_SPEED, grid, "rad/s"),
        Axis.spaced("wv", 0.0, LARGEST_ENGINE_SPEED, grid, "rad/s"),
    )
    return DynamicProgram(
        task.clutch, states, tuple(inputs), STAGES, task.cost, end_set=task.end_set, admissible=task.admissible,
        change_cost=task.change_cost, sample_time=task.clutch.sample_time, settings=settings or DpSettings(),
    )  # fmt: skip


def judged_engagement(x: Matrix, u: Matrix, first_torque: float = OPEN_CLUTCH) -> dict[str, float | None]:
    """Figures of a run of speeds x under inputs u: cost in its parts, margins, lock-up.

    Returns
    -------
    dict
        ``cost`` and its parts ``slip, increments, lock_up``; ``least_engine_speed`` and ``engine_speed_margin``
        [rad/s]; ``lock_time`` [s] and ``lock_acceleration`` [rad/s^2], None without lock-up; ``end_slip`` [rad/s].
    """
    task = Engagement()
    slip = x[1:, 0] - x[1:, 1]
    increments = np.abs(np.diff(np.concatenate([[first_torque], u[:, 0]])))
    locks = np.flatnonzero(task.locks(x[:-1], x[1:]))
    first = int(locks[0]) if len(locks) else None
    rates = np.abs(task.clutch.slip_acceleration(x[:-1], u))[locks]
    parts = {
        "slip": float(task.slip * (slip**2).sum()),
        "increments": float(task.change * increments.sum()),
        "lock_up": float(task.lock_up * rates.sum()),
    }
    return {
        "cost": sum(parts.values()),
        **parts,
        "least_engine_speed": float(x[:, 0].min()),
        "engine_speed_margin": float(min(x[:, 0].min() - LEAST_ENGINE_SPEED, LARGEST_ENGINE_SPEED - x[:, 0].max())),
        "lock_time": None if first is None else (first + 1) * task.clutch.sample_time,
        "lock_acceleration": None if first is None else float(rates[0]),
        "end_slip": float(abs(slip[-1])),
    }


@dataclass(frozen=True, eq=False)
class DpDemo:
    """Result of :func:`engage_by_dp`.

    Attributes
    ----------
    problem : DynamicProgram
    table : FeedbackTable
        Of the backward recursion.
    backward : DpPlan
        The run under the table from the start.
    forward : ForwardSearch
        The search from the start.
    backward_seconds, forward_seconds : float
    """

    problem: DynamicProgram
    table: FeedbackTable
    backward: DpPlan
    forward: ForwardSearch
    backward_seconds: float
    forward_seconds: float

    @property
    def engaged(self) -> bool:
        """Whether both found an engagement."""
        return self.backward.ok and self.forward.plan.ok

    @property
    def trajectory(self) -> Trajectory | None:
        """The run under the table."""
        return self.backward.trajectory

    def figures(self) -> dict[str, Any]:
        """The figures as plain data."""
        memory = self.problem.memory()
        figures: dict[str, Any] = {
            "engaged": self.engaged,
            "planned": self.backward.planned,
            "backward_seconds": self.backward_seconds,
            "table_bytes": memory["table"],
            "forward_cost": self.forward.plan.cost,
            "forward_seconds": self.forward_seconds,
            "forward_transitions": self.forward.transitions,
            "end_states": len(self.forward.end_costs),
        }
        if self.trajectory is not None:
            figures |= judged_engagement(self.trajectory.x, self.trajectory.u)
        return figures

    def rows(self) -> list[tuple[str, str]]:
        """The figures as lines of text and value."""
        f = self.figures()
        lines = [
            ("cost to go of the table at the start", f"{f['planned']:.1f}"),
            ("backward recursion", f"{f['backward_seconds']:.2f} s, table {f['table_bytes'] / 1e6:.0f} MB"),
            ("cost of the forward search", f"{f['forward_cost']:.1f}"),
            ("forward search", f"{f['forward_seconds']:.2f} s, {f['forward_transitions']} steps of the plant"),
        ]
        if self.trajectory is None:
            return [*lines, ("run under the table", self.backward.message)]
        locked = "never" if f["lock_time"] is None else f"{f['lock_time']:.2f} s"
        rate = "-" if f["lock_acceleration"] is None else f"{f['lock_acceleration']:.1f} rad/s^2"
        return [
            *lines,
            ("cost of the run under the table", f"{f['cost']:.1f}"),
            ("  of this slip, increments, lock-up", f"{f['slip']:.1f}, {f['increments']:.1f}, {f['lock_up']:.1f}"),
            ("clutch locked after", locked),
            ("relative acceleration at lock-up", rate),
            ("smallest engine speed", f"{f['least_engine_speed']:.3f} rad/s (limit {LEAST_ENGINE_SPEED:g})"),
        ]

    def plot(self) -> Figure:
        """Speeds, inputs, and the table at one stage."""
        from hysdel_py.plotting.dynamic_programming import plot_dp_engagement

        return plot_dp_engagement(self.table, self.backward, self.forward.plan, LEAST_ENGINE_SPEED)


def engage_by_dp(
    grid: float = 1.0,
    torque_step: float = 10.0,
    *,
    engine_torques: int = 0,
    scheme: Scheme = "exact",
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> DpDemo:
    """Engage the clutch backward and forward; parameters as for :func:`engagement_problem`.

    With two inputs the forward search keeps one path per pair of speeds, as the document does: paths told apart by
    their last torque would be twenty times as many.
    """
    problem = engagement_problem(grid, torque_step, engine_torques=engine_torques, scheme=scheme)
    before = [OPEN_CLUTCH, *([100.0] if engine_torques else [])]
    begin = perf_counter()
    table = problem.backward(executor=executor, progress=progress)
    backward_seconds = perf_counter() - begin
    plan = table.plan(START, before)
    begin = perf_counter()
    search = problem.forward(START, last_input=before, remember_input=not engine_torques, progress=progress)
    return DpDemo(problem, table, plan, search, backward_seconds, perf_counter() - begin)
