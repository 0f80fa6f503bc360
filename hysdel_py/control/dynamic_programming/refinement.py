"""Several passes: a coarse grid first, then finer ones in a band around the plan of the pass before."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.dynamic_programming.grids import Axis, Mesh, input_points
from hysdel_py.control.dynamic_programming.plan import DpPlan, checked_vector
from hysdel_py.control.dynamic_programming.schedule import Stage, remembered
from hysdel_py.control.dynamic_programming.table import FeedbackTable
from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from hysdel_py.control.dynamic_programming.problem import DynamicProgram

__all__ = ["Refined", "refined"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Refined:
    """Answer of several passes.

    Attributes
    ----------
    plan : DpPlan
        The cheapest plan of all passes, by the cost of the plant.
    plans : tuple of DpPlan
        The plan of each pass.
    table : FeedbackTable
        Of the last pass; it knows the band only.
    """

    plan: DpPlan
    plans: tuple[DpPlan, ...]
    table: FeedbackTable


def refined(
    problem: DynamicProgram,
    x0: ArrayLike,
    passes: int,
    *,
    last_input: ArrayLike | None,
    band: int,
    factor: int,
    executor: Executor | None,
    progress: Callable[[int, int], Any] | None,
) -> Refined:
    """See :meth:`DynamicProgram.refine`. Stops after a pass without a plan."""
    for name, value, least in (("passes", passes, 1), ("band", band, 1), ("factor", factor, 2)):
        if isinstance(value, bool) or value != int(value) or value < least:
            raise ArgumentError(f"{name} is {value}: a whole number of at least {least} was expected")
    before = checked_vector(last_input, problem.u, "last input")
    table = problem.backward(executor=executor, progress=progress)
    plans = [table.plan(x0, before)]
    axes = tuple(problem.states), tuple(problem.inputs)
    for _ in range(passes - 1):
        plan = plans[-1]
        if plan.trajectory is None:
            break
        schedule, axes = _narrowed(problem, plan, axes, before, (band, factor))
        table = problem.backward_on(schedule, executor=executor, progress=progress)
        plans.append(table.plan(x0, before))
    return Refined(min(plans, key=lambda plan: plan.cost), tuple(plans), table)


def _narrowed(
    problem: DynamicProgram,
    plan: DpPlan,
    axes: tuple[tuple[Axis, ...], tuple[Axis, ...]],
    before: Matrix | None,
    shape: tuple[int, int],
) -> tuple[tuple[Stage, ...], tuple[tuple[Axis, ...], tuple[Axis, ...]]]:
    """Grids around a plan, and the axes whose steps they have."""
    band, factor = shape
    assert plan.trajectory is not None
    states = tuple(_finer(axis, factor) for axis in axes[0])
    inputs = tuple(_finer(axis, factor) for axis in axes[1])
    points = [input_points(_around(inputs, u, band * factor)) for u in plan.trajectory.u]
    points.append(points[-1])
    applied = [points[0] if before is None else before[None], *points]
    functions = problem.functions
    stages = tuple(
        Stage(Mesh(_around(states, x, band * factor)), points[k], remembered(functions, applied[k], points[k]))
        for k, x in enumerate(plan.trajectory.x)
    )
    return stages, (states, inputs)


def _finer(axis: Axis, factor: int) -> Axis:
    return Axis(axis.name, axis.low, axis.high, factor * (axis.count - 1) + 1, axis.unit)


def _around(axes: tuple[Axis, ...], centre: Matrix, half: int) -> tuple[Axis, ...]:
    """The part of each axis within `half` steps of the centre, its values kept."""
    parts = []
    for axis, value in zip(axes, centre, strict=True):
        middle = round((value - axis.low) / axis.step)
        low, high = max(0, middle - half), min(axis.count - 1, middle + half)
        ends = axis.low + low * axis.step, axis.low + high * axis.step
        parts.append(Axis(axis.name, *ends, high - low + 1, axis.unit))
    return tuple(parts)
