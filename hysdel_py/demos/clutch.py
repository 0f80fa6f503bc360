"""Engagement of a dry clutch, from an open clutch to one that stays locked.

The controller plans with the shipped model ``clutch.hys``. The plant is the same model ten times finer in time and with
a stick window fifty times narrower, so that the controller has to live with a plant that is not its model. When the
relative speed has entered the stick window of the controller, a simple law takes over: it keeps the engine torque,
holds the clutch a little tighter than sticking needs until the speeds have met, and then closes it at its fastest rate.

Weights, horizon, rate limits and numbers are those of section 10.4 of J.R.P. Kusters, "Modelling and coordinated
control of advanced automotive transmissions", TU/e, DCT 2005-58; the start is ours, since the document gives none. Its
limits are hard. On a plant that differs from the model even as little as this one, the loop then runs out of feasible
inputs: the plan rides on the engine-speed limit, the plant ends a hair below it, and the torque that would bring it
back is limited in its rate. So the engine-speed limit is softened here, with a small margin; ``hard=True`` shows the
other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import Move
from hysdel_py.model import Model, load
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["LEAST_ENGINE_SPEED", "NODE_LIMIT", "START", "ClutchDemo", "ClutchPlant", "clutch_controller", "engage"]

Vector = NDArray[np.float64]

START: Mapping[str, float] = {"we": 100.0, "gamma": 70.0, "Te": 20.0, "Fn": 0.0, "lc": 0.0}
"""Engine running at 100 rad/s, vehicle side at 30 rad/s, clutch open."""
LEAST_ENGINE_SPEED = 80.0
"""Limit of the document [rad/s]; below it the engine would stall."""
REFERENCE: Mapping[str, float] = {"y1": 100.0, "y2": 0.0, "y3": 0.0}
STEPS = 100
"""One second of control."""
NODE_LIMIT = 60
"""Nodes of the branch and bound per move; near lock-up the last percent of proof would take thousands."""

_MODEL_FLOOR = 60.0  # the model must reach below a limit that may be violated a little
_MARGIN = 0.3  # rad/s between the limit in the plan and the limit of the engine
_SUBSTEPS = 10
_PLANT_WINDOW = 0.02  # rad/s, stick window of the plant
_EXCESS_TORQUE = 3.0  # Nm above the stick torque with which the lock-up law lets the speeds meet


class ClutchPlant:
    """The clutch in fine steps, seen at the sample times of a controller.

    `x`, `u`, `y`, `d`, `z` name the variables; :meth:`step` takes the increments of one sample and spreads them evenly.
    """

    def __init__(self, model: Model) -> None:
        self.sample_time = model.sample_time
        self._lockahead = 10.0 * model.parameters["reltol"]
        self._fine = load(
            "clutch", ts=self.sample_time / _SUBSTEPS, reltol=_PLANT_WINDOW, we_min=model.parameters["we_min"]
        ).dha
        self.x, self.u, self.y = self._fine.x, model.dha.u, self._fine.y
        self.d, self.z = self._fine.d, self._fine.z
        self.fine_steps: list[Vector] = []

    def step(self, x: Vector, u: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """One sample; the last state is the change of relative speed over the sample, as the controller knows it."""
        first = None
        state = np.array(x, dtype=float)
        for _ in range(_SUBSTEPS):
            after, *rest = self._fine.step(state, np.asarray(u) / _SUBSTEPS, check=False)
            first = first or rest
            self.fine_steps.append(after)
            state = after
        assert first is not None
        near = _PLANT_WINDOW < x[1] <= self._lockahead
        state = np.append(state[:4], state[1] - x[1] if near else 0.0)
        y, d, z = first
        return state, y, d, z


def clutch_controller(
    model: Model, horizon: int = 10, backend: str = "auto", node_limit: int = NODE_LIMIT, *, hard: bool = False
) -> HybridMpc:
    """The predictive controller of the document, its engine-speed limit softened unless `hard`."""
    return HybridMpc(
        model,
        horizon,
        Cost(y={"y1": 1.0, "y2": 4.0, "y3": 4.0}),
        Limits(
            y={"y1": (LEAST_ENGINE_SPEED + _MARGIN, None), "y2": (0.0, None), "y3": (-11.0, 11.0)},
            soft=() if hard else ("y1",),
            rho=1e5,
        ),
        references=("y1", "y2", "y3"),
        backend=backend,
        node_limit=node_limit,
    )


class _EngageThenHold:
    """The predictive controller until the clutch sticks, the lock-up law from then on."""

    def __init__(self, model: Model, mpc: Any) -> None:
        self._mpc = mpc
        self._p = model.parameters
        self._fastest = model.dha.u[1].high
        self._force_limit = model.dha.x[3].high
        self.hand_over: int | None = None
        self._asked = 0

    def solve(self, x: Vector, ref: Any) -> Move | Vector:
        if self.hand_over is None and x[1] <= self._p["reltol"]:
            self.hand_over = self._asked
        self._asked += 1
        if self.hand_over is None:
            move: Move = self._mpc.solve(x, ref)
            return move
        return self._lock(x)

    def _lock(self, x: Vector) -> Vector:
        """Keep the engine torque; close gently while the clutch still slips, fully once it sticks."""
        p, (we, gamma, Te, Fn, _) = self._p, x
        stick_torque = (Te * p["Jv"] + p["b"] * (we - gamma) * p["Je"]) / (p["Je"] + p["Jv"])
        slipping = gamma > 2 * _PLANT_WINDOW
        wanted = (stick_torque + _EXCESS_TORQUE) / p["mu"] if slipping else self._force_limit
        return np.array([0.0, np.clip(min(wanted, self._force_limit) - Fn, -self._fastest, self._fastest)])


@dataclass(frozen=True, eq=False)
class ClutchDemo:
    """Result of :func:`engage`.

    Attributes
    ----------
    trajectory : Trajectory
        At the sample times of the controller.
    lockup_time : float or None
        Seconds until the clutch of the plant sticks; None if it never does.
    lockup_acceleration : float or None
        Relative acceleration in the last moment before [rad/s^2].
    least_engine_speed : float
        Over all fine steps of the plant [rad/s].
    slip_after_lockup : float or None
        Largest relative speed after lock-up [rad/s].
    hand_over : int or None
        Step from which the lock-up law acts.
    horizon : int
    """

    trajectory: Trajectory
    lockup_time: float | None
    lockup_acceleration: float | None
    least_engine_speed: float
    slip_after_lockup: float | None
    hand_over: int | None
    horizon: int

    @property
    def engaged(self) -> bool:
        """Whether the clutch locked within the run and stayed locked."""
        return (
            self.lockup_time is not None
            and self.slip_after_lockup is not None
            and self.slip_after_lockup <= 10 * _PLANT_WINDOW
            and self.trajectory.steps == STEPS
        )

    @property
    def messages(self) -> tuple[str, ...]:
        """Only what stopped the run; moves that ended at the node limit are counted in the figures."""
        return tuple(m for m in self.trajectory.messages if "stopped" in m)

    @property
    def _controlled(self) -> dict[str, Vector]:
        """Records of the controller for the steps before the lock-up law."""
        end = self.trajectory.steps if self.hand_over is None else self.hand_over
        return {name: values[:end] for name, values in self.trajectory.info.items()}

    def figures(self) -> dict[str, Any]:
        """The figures as plain data; times in seconds, speeds in rad/s."""
        info = self._controlled
        seconds = info["seconds"] if len(info["seconds"]) else np.array([np.nan])
        return {
            "engaged": self.engaged,
            "horizon": self.horizon,
            "lockup_time": self.lockup_time,
            "least_engine_speed": self.least_engine_speed,
            "lockup_acceleration": self.lockup_acceleration,
            "slip_after_lockup": self.slip_after_lockup,
            "steps": self.trajectory.steps,
            "mpc_steps": len(info["seconds"]),
            "proven_optimal": int(np.sum(info["status"] == 0)),
            "solve_mean": float(np.mean(seconds)),
            "solve_p95": float(np.percentile(seconds, 95)),
            "solve_worst": float(np.max(seconds)),
            "nodes_mean": float(np.sum(info["nodes"])) / max(1, len(info["nodes"])),
            "qps_mean": float(np.sum(info["qps"])) / max(1, len(info["qps"])),
        }

    def table(self) -> list[tuple[str, str]]:
        """The figures as lines of text and value."""
        f = self.figures()

        def shown(key: str, unit: str) -> str:
            return "never" if f[key] is None else f"{f[key]:.3f} {unit}"

        return [
            ("clutch locked after", shown("lockup_time", "s")),
            ("smallest engine speed", f"{f['least_engine_speed']:.2f} rad/s (limit {LEAST_ENGINE_SPEED:g})"),
            ("relative acceleration at lock-up", shown("lockup_acceleration", "rad/s^2")),
            ("largest slip after lock-up", shown("slip_after_lockup", "rad/s")),
            ("moves by the predictive controller", f"{f['mpc_steps']}, of which {f['proven_optimal']} proven optimal"),
            (
                "solve time: mean, 95th percentile, worst",
                f"{1e3 * f['solve_mean']:.1f}, {1e3 * f['solve_p95']:.1f}, {1e3 * f['solve_worst']:.1f} ms",
            ),
            ("nodes and quadratic programs per move", f"{f['nodes_mean']:.1f}, {f['qps_mean']:.1f}"),
        ]

    def plot(self) -> Figure:
        """Speeds, torques, cost of lock-up and modes over time."""
        from hysdel_py.plotting.clutch import plot_engagement

        return plot_engagement(self.trajectory, LEAST_ENGINE_SPEED, REFERENCE["y1"], self.lockup_time)


def engage(
    horizon: int = 10,
    backend: str = "auto",
    start: Mapping[str, float] = START,
    *,
    node_limit: int = NODE_LIMIT,
    hard: bool = False,
    wrap: Callable[[HybridMpc], Any] | None = None,
    progress: Callable[[int, int], Any] | None = None,
) -> ClutchDemo:
    """Engage the clutch in one second of closed loop.

    Parameters
    ----------
    horizon : int
        Steps of 0.01 s that are planned.
    backend : str
        Solver of the quadratic programs.
    start : mapping
        First state by name.
    node_limit : int
        Nodes of the branch and bound per move.
    hard : bool
        Keep the engine-speed limit hard.
    wrap : callable, optional
        Given the predictive controller, returns what stands in for it, for example to record its moves.
    progress : callable, optional
        Called with the step and the number of steps.
    """
    model = load("clutch", we_min=_MODEL_FLOOR)
    plant = ClutchPlant(model)
    mpc = clutch_controller(model, horizon, backend, node_limit, hard=hard)
    controller = _EngageThenHold(model, mpc if wrap is None else wrap(mpc))
    trajectory = closed_loop(plant, controller, start, STEPS, dict(REFERENCE), progress=progress)
    return _judged(trajectory, plant, controller.hand_over, horizon)


def _judged(trajectory: Trajectory, plant: ClutchPlant, hand_over: int | None, horizon: int) -> ClutchDemo:
    fine = np.vstack([trajectory.x[:1], *plant.fine_steps])
    gamma = fine[:, 1]
    step = plant.sample_time / _SUBSTEPS
    stuck = np.flatnonzero(gamma <= _PLANT_WINDOW)
    first = int(stuck[0]) if stuck.size else None
    return ClutchDemo(
        trajectory,
        None if first is None else round(first * step, 9),
        None if not first else float(gamma[first] - gamma[first - 1]) / step,
        float(fine[:, 0].min()),
        None if first is None else float(np.abs(gamma[first:]).max()),
        hand_over,
        horizon,
    )
