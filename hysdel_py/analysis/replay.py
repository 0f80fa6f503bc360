"""Whether a point of the rows of a search is a run of the model that does what was asked: the simulator decides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.confirmation import moved_inside
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.monitor import Watch
from hysdel_py.analysis.runs import Runs
from hysdel_py.analysis.settings import SearchTolerances
from hysdel_py.errors import SimulationError
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.signals import Variable, range_violations
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Replay", "Wish", "replayed"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Wish:
    """A condition that has to hold, or not to hold."""

    watch: Watch
    holds: bool


@dataclass(frozen=True, eq=False, slots=True)
class Replay:
    """The run of a point, or why it is none.

    `borderline` says that it is one only up to the tolerance of the solver.
    """

    run: Trajectory | None
    message: str = ""
    borderline: bool = False


def replayed(
    dha: Dha,
    runs: Runs,
    problem: Milp,
    wishes: Sequence[Wish],
    w: Vector,
    *,
    course: tuple[int, float],
    tolerances: SearchTolerances,
) -> Replay:
    """Simulate the inputs of a point.

    Parameters
    ----------
    dha : Dha
    runs, problem, wishes : Runs, Milp, sequence of Wish
        What the point is one of.
    w : array of shape (n,)
    course : tuple of int and float
        Number of steps, sample time.
    tolerances : SearchTolerances
    """
    inside, message = moved_inside(problem, w, tolerances), ""
    for tolerance in (0.0, tolerances.rows):
        for point in (inside, w):
            run, message = _simulated(dha, runs, point, course, max(tolerance, dha.tolerances.range))
            if run is not None:
                broken = [wish for wish in wishes if not _granted(wish, run, point, tolerance)]
                if not broken:
                    return Replay(run, borderline=tolerance > 0)
                message = f"the run misses at step {broken[0].watch.time} what the rows promise"
    return Replay(None, f"the solver has a point that the simulator does not confirm: {message}")


def _simulated(
    dha: Dha, runs: Runs, w: Vector, course: tuple[int, float], tolerance: float
) -> tuple[Trajectory | None, str]:
    steps, ts = course
    loosened = replace(dha, tolerances=replace(dha.tolerances, range=tolerance, row=tolerance))
    start = np.array([_value(runs, w, runs.states[0][v.name], v) for v in dha.x])
    inputs = np.array([[_value(runs, w, places[v.name], v) for v in dha.u] for places in runs.inputs[:steps]])
    try:
        run = loosened.simulate(start, inputs.reshape(steps, len(dha.u)) if dha.u else steps, ts=ts)
    except SimulationError as error:
        return None, error.problems[0]
    outside = range_violations(run.x[-1], dha.x, f"step {steps}: state", tolerance)
    return (None, outside[0]) if outside else (run, "")


def _value(runs: Runs, w: Vector, place: int, variable: Variable) -> float:
    if variable.is_bool:
        return float(round(w[place]))
    return float(np.clip(w[place], runs.problem.low[place], runs.problem.high[place]))


def _granted(wish: Wish, run: Trajectory, w: Vector, tolerance: float) -> bool:
    """Whether a run has what was wished; with a tolerance, up to that at each threshold of the condition."""
    monitor, time = wish.watch.monitor, wish.watch.time
    values = monitor.values(lambda vector, name: float(run[f"{vector}.{name}"][time]))
    if not tolerance:
        return monitor.holds(lambda vector, name: float(run[f"{vector}.{name}"][time])) == wish.holds
    same = (
        round(w[wish.watch.places[name]]) == round(values[name])
        for name, signal in monitor.signals.items()
        if signal.variable.is_bool
    )
    return all(same) and all(
        _on_side(event.form.value(values), w[wish.watch.places[event.name]] > 0.5, tolerance)
        for event in monitor.events
    )


def _on_side(value: float, below: bool, tolerance: float) -> bool:
    return value <= tolerance if below else value >= -tolerance
