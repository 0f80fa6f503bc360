"""Picture of a clutch engagement."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.plotting.style import COLOURS, LIMIT, MUTED, finish, new_figure
from hysdel_py.plotting.trajectory import draw_held, draw_modes
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_engagement"]


def plot_engagement(trajectory: Trajectory, floor: float, reference: float, lockup_time: float | None) -> Figure:
    """Draw speeds, torques, solve times and modes of an engagement.

    Parameters
    ----------
    floor : float
        Least engine speed [rad/s].
    reference : float
        Reference of the engine speed [rad/s].
    lockup_time : float or None
        Time of lock-up [s], marked in every panel.
    """
    shown = [("d", v) for v in trajectory.variables["d"] if not v.generated]
    figure, axes = new_figure(4, [1.5, 1.2, 0.8, 0.8])
    _draw_speeds(axes[0], trajectory, floor, reference)
    _draw_torques(axes[1], trajectory)
    _draw_solve_times(axes[2], trajectory)
    draw_modes(axes[3], trajectory, shown)
    if lockup_time is not None:
        for panel in axes:
            panel.axvline(lockup_time, color=MUTED, linewidth=0.8, linestyle=":")
        axes[0].annotate(
            f"locked, {lockup_time:.2f} s", (lockup_time, 1.0), xycoords=("data", "axes fraction"), fontsize="small",
            xytext=(-3, -10), textcoords="offset points", ha="right", color=MUTED,
        )  # fmt: skip
    axes[-1].set_xlabel("time [s]")
    return figure


def _draw_speeds(axes: Axes, trajectory: Trajectory, floor: float, reference: float) -> None:
    t, engine, slip = trajectory.t, trajectory["we"], trajectory["gamma"]
    axes.plot(t, engine, color=COLOURS[0], label="engine")
    axes.plot(t, engine - slip, color=COLOURS[2], label="vehicle side")
    axes.plot(t, slip, color=COLOURS[1], label="relative speed")
    axes.axhline(floor, color=LIMIT, linewidth=1.0, linestyle="--", label="least engine speed")
    axes.axhline(reference, color=MUTED, linewidth=0.8, linestyle="-.", label="engine reference")
    finish(axes, "speed [rad/s]")


def _draw_torques(axes: Axes, trajectory: Trajectory) -> None:
    axes.plot(trajectory.t, trajectory["Te"], color=COLOURS[0], label="engine torque")
    axes.plot(trajectory.t, trajectory["Fn"], color=COLOURS[3], label="normal force")
    axes.plot(trajectory.t[:-1], trajectory["Tcl"], color=COLOURS[1], linestyle="--", label="clutch torque")
    finish(axes, "torque [Nm], force [N]")


def _draw_solve_times(axes: Axes, trajectory: Trajectory) -> None:
    """Only those of the predictive controller: other laws leave no status."""
    planned = np.isfinite(trajectory.info["status"])
    milliseconds = np.where(planned, 1e3 * trajectory.info["seconds"], np.nan)
    draw_held(axes, trajectory.t, milliseconds, color=COLOURS[6], linewidth=1.0)
    axes.set_yscale("log")
    if planned.any():
        shown = np.log10(milliseconds[planned].clip(min=1e-3))
        axes.set_ylim(10 ** np.floor(shown.min()), 10 ** np.ceil(shown.max()))  # whole decades: their labels have room
    axes.yaxis.set_minor_formatter("")
    finish(axes, "solve time [ms]", legend=False)
