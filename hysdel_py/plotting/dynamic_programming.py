"""Picture of an engagement by dynamic programming: the run, and the table that gives it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.plotting.style import COLOURS, LIMIT, MUTED, finish, new_figure
from hysdel_py.plotting.trajectory import draw_held
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hysdel_py.control.dynamic_programming.plan import DpPlan
    from hysdel_py.control.dynamic_programming.table import FeedbackTable

__all__ = ["plot_dp_engagement"]


def plot_dp_engagement(table: FeedbackTable, backward: DpPlan, forward: DpPlan, floor: float) -> Figure:
    """Draw speeds and inputs of both plans over time, and the least cost to go over the speeds.

    Parameters
    ----------
    floor : float
        Least engine speed [rad/s].
    """
    figure, axes = new_figure(3, [1.4, 1.0, 1.6], share_time=False)
    for plan, style in ((backward, "-"), (forward, ":")):
        if plan.trajectory is not None:
            _draw_speeds(axes[0], plan.trajectory, style)
            _draw_inputs(axes[1], plan.trajectory, style)
    axes[0].axhline(floor, color=LIMIT, linewidth=1.0, linestyle="--", label="least engine speed")
    finish(axes[0], "speed [rad/s]")
    finish(axes[1], "torque [Nm]")
    axes[1].set_xlabel("time [s]")
    _draw_table(axes[2], table, backward)
    return figure


def _draw_speeds(axes: Axes, trajectory: Trajectory, style: str) -> None:
    named = style == "-"
    for name, colour, label in (("we", COLOURS[0], "engine"), ("wv", COLOURS[2], "vehicle side")):
        axes.plot(trajectory.t, trajectory[name], style, color=colour, label=label if named else None)


def _draw_inputs(axes: Axes, trajectory: Trajectory, style: str) -> None:
    for variable, colour in zip(trajectory.variables["u"], (COLOURS[1], COLOURS[3]), strict=False):
        label = f"{variable.label}, {'table' if style == '-' else 'forward search'}"
        draw_held(axes, trajectory.t, trajectory[variable.name], color=colour, linestyle=style, label=label)


def _draw_table(axes: Axes, table: FeedbackTable, plan: DpPlan) -> None:
    """Least cost to go at the first stage, with the path of the plan."""
    mesh = table.schedule[0].mesh
    least = table.values[0].min(axis=1).reshape(tuple(mesh.counts))
    shown = np.ma.masked_invalid(np.where(np.isfinite(least), least, np.nan))
    engine, vehicle = mesh.axes
    image = axes.pcolormesh(vehicle.values, engine.values, shown / 1e3, shading="nearest", cmap="viridis")
    axes.figure.colorbar(image, ax=axes, label="cost to go / 1000, first stage")
    if plan.trajectory is not None:
        axes.plot(plan.trajectory["wv"], plan.trajectory["we"], color="white", marker=".", linewidth=1.0)
    axes.plot([engine.low, engine.high], [engine.low, engine.high], color=MUTED, linestyle="-.", linewidth=0.8)
    axes.set_xlabel(f"{vehicle.name} [{vehicle.unit}]")
    axes.set_ylabel(f"{engine.name} [{engine.unit}]")
