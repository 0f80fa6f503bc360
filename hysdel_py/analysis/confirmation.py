"""Whether a point of the mixed-integer rows is a run of the model: the simulator decides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.horizon import Demand, Horizon
from hysdel_py.analysis.milp import Milp, Status
from hysdel_py.analysis.settings import SearchTolerances
from hysdel_py.errors import SimulationError
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["confirmed", "moved_inside", "violated_demands"]

Vector = NDArray[np.float64]


def confirmed(
    dha: Dha, horizon: Horizon, demands: Sequence[Demand], w: Vector, tolerance: float
) -> tuple[Trajectory | None, str]:
    """The run with the inputs of a point, or why it is none.

    `tolerance` is by how much ranges, requirements and limits may be missed.
    """
    loosened = replace(dha, tolerances=replace(dha.tolerances, range=tolerance, row=tolerance))
    start = np.array([_value(w[horizon.states[0][v.name]], v.is_bool) for v in dha.x])
    inputs = np.array(
        [[_inside(w[places[v.name]], v.low, v.high, v.is_bool) for v in dha.u] for places in horizon.inputs]
    ).reshape(len(horizon.inputs), len(dha.u))
    try:
        run = loosened.simulate(start, inputs if dha.u else len(horizon.inputs))
    except SimulationError as error:
        return None, error.problems[0]
    broken = (*_last_state(run, tolerance), *violated_demands(run, demands, tolerance))
    return (None, broken[0]) if broken else (run, "")


def _value(value: float, is_bool: bool) -> float:
    return float(round(value)) if is_bool else float(value)


def _inside(value: float, low: float, high: float, is_bool: bool) -> float:
    return min(max(_value(value, is_bool), low), high)


def _last_state(run: Trajectory, tolerance: float) -> tuple[str, ...]:
    """The simulator does not look at the state that nobody steps from."""
    from hysdel_py.systems.signals import range_violations

    return range_violations(run.x[-1], run.variables["x"], f"step {run.steps}: state", tolerance)


def violated_demands(run: Trajectory, demands: Sequence[Demand], tolerance: float) -> tuple[str, ...]:
    """Limits that a run does not keep."""
    found = []
    for demand in demands:
        for k in demand.times:
            value = sum(c * run[f"{demand.vector}.{name}"][k] for name, c in demand.terms)
            if (
                not demand.low - _scaled(tolerance, demand.low)
                <= value
                <= demand.high + _scaled(tolerance, demand.high)
            ):
                found.append(f"step {k}: {demand.what} is not kept, the value is {value:.12g}")
    return tuple(found)


def _scaled(tolerance: float, end: float) -> float:
    return tolerance * max(1.0, abs(end)) if abs(end) < inf else tolerance


def moved_inside(problem: Milp, w: Vector, tolerances: SearchTolerances) -> Vector:
    """A point with the same Booleans, as far inside each inequality as a margin allows; w if there is none."""
    fixed = problem.copy()
    for variable, is_integer in enumerate(problem.integer):
        if is_integer:
            fixed.low[variable] = fixed.high[variable] = float(round(w[variable]))
    margins: dict[int, float] = {}
    for number, row in enumerate(problem.rows):
        if row.low < row.high:  # a margin of its own, since others may have to be zero
            margin = fixed.real(0.0, tolerances.margin)
            margins[margin] = -1.0
            fixed.rows[number] = replace(row, terms=(*row.terms, (margin, 1.0 if row.low == -inf else -1.0)))
    answer = fixed.search(margins, relaxed=True)
    return answer.w[: problem.n] if answer.status is Status.FOUND else w
