"""A planned run: what dynamic programming promises and what the plant makes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.dynamic_programming.evaluation import Functions
from hysdel_py.systems.signals import Variable, as_vector
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["DpPlan", "DpStatus", "checked_vector", "replayed"]

Matrix = NDArray[np.float64]


class DpStatus(Enum):
    """What came of a search."""

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    """On these grids no inputs lead into the end set within the constraints."""
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, eq=False, slots=True)
class DpPlan:
    """A run of least cost on the grids.

    Attributes
    ----------
    status : DpStatus
    message : str
        The outcome in words, with what can be done about it.
    trajectory : Trajectory or None
        The plant under the planned inputs; ``info`` has the cost of each step.
    planned : float
        Cost that the table or the search promised, infinite without a plan.
    cost : float
        Cost of the trajectory, with the end cost, infinite where it breaks a constraint.
    """

    status: DpStatus
    message: str
    trajectory: Trajectory | None = None
    planned: float = np.inf
    cost: float = np.inf

    @property
    def ok(self) -> bool:
        """Whether there is a plan."""
        return self.trajectory is not None


def replayed(
    functions: Functions,
    x0: Matrix,
    inputs: Matrix,
    last_input: Matrix | None,
    variables: Mapping[str, Any],
    sample_time: float,
    planned: float,
) -> DpPlan:
    """Apply planned inputs to the plant and count what they cost."""
    x, costs, before = [x0], [], last_input
    for k, u in enumerate(inputs):
        after, cost = functions.step(k, x[-1][None], u[None])
        change = functions.changes(None if before is None else before[None], u[None])
        costs.append(float(cost[0] + change[0, 0]))
        x.append(after[0])
        before = u
    total = float(sum(costs) + functions.end(x[-1][None])[0])
    trajectory = _trajectory(np.array(x), inputs, np.array(costs, dtype=np.float64), variables, sample_time)
    return DpPlan(DpStatus.SOLVED, _words(planned, total), trajectory, planned, total)


def _words(planned: float, cost: float) -> str:
    text = f"solved: planned cost {planned:.6g}, cost of the plant under these inputs {cost:.6g}"
    return text if np.isfinite(cost) else f"{text}: it breaks a constraint that the grid kept; take finer axes"


def _trajectory(x: Matrix, u: Matrix, costs: Matrix, variables: Mapping[str, Any], sample_time: float) -> Trajectory:
    nothing = np.zeros((len(u), 0))
    return Trajectory(
        np.arange(len(x), dtype=np.float64) * sample_time, x, u, nothing, nothing, nothing,
        variables={**variables, "y": (), "d": (), "z": ()}, info={"cost": costs},
    )  # fmt: skip


def checked_vector(
    value: ArrayLike | Mapping[str, float] | None, variables: Sequence[Variable], what: str
) -> Matrix | None:
    """A state or input by position or by name, or None.

    Raises
    ------
    ArgumentError
        See :func:`~hysdel_py.systems.signals.as_vector`.
    """
    return None if value is None else as_vector(value, variables, what)
