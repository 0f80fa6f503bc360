"""Pictures of gear shifts and drives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.plotting.style import COLOURS, LIMIT, MUTED, finish, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hysdel_py.demos.shifts.drive import DriveRun
    from hysdel_py.demos.shifts.shift import ShiftRun

__all__ = ["plot_drive", "plot_shift"]


def plot_shift(run: ShiftRun) -> Figure:
    """Draw inputs, speeds, flywheel speed, torque at the wheels and solve times of a shift."""
    figure, axes = new_figure(5, [1.2, 1.1, 0.9, 1.1, 0.7])
    _draw_inputs(axes[0], run)
    _draw_speeds(axes[1], run)
    _draw_flywheel(axes[2], run)
    _draw_torque(axes[3], run)
    _draw_solve_times(axes[4], run)
    change = run.shift.release.seconds
    for panel in axes:
        _mark(panel, change)
        if run.judgement.shift_time is not None:
            _mark(panel, run.judgement.shift_time)
    axes[0].annotate("gear change", (change, 1.0), xycoords=("data", "axes fraction"), xytext=(3, 3),
                     textcoords="offset points", fontsize="small", color=MUTED)  # fmt: skip
    if run.judgement.shift_time is not None:
        axes[0].annotate("locked", (run.judgement.shift_time, 1.0), xycoords=("data", "axes fraction"),
                         xytext=(3, 3), textcoords="offset points", fontsize="small", color=MUTED)  # fmt: skip
    axes[-1].set_xlabel("time [s]")
    return figure


def plot_drive(run: DriveRun) -> Figure:
    """Draw pedal and gear, speeds, and the torque at the wheels of a drive."""
    figure, axes = new_figure(4, [0.8, 0.6, 1.2, 1.2])
    axes[0].plot(run.t, run.pedal, color=COLOURS[0], label="pedal")
    finish(axes[0], "pedal [-]", legend=False)
    axes[1].step(run.t, run.gear, color=COLOURS[1], where="post")
    axes[1].set_yticks(sorted(run.data.gears))
    finish(axes[1], "gear", legend=False)
    axes[2].plot(run.t, run.fine[:, 4], color=COLOURS[0], label="engine")
    axes[2].plot(run.t, run.fine[:, 9], color=COLOURS[2], linewidth=0.9, label="flywheel")
    axes[2].plot(run.t, run.fine[:, 6], color=COLOURS[1], label="wheels")
    finish(axes[2], "speed [rad/s]")
    axes[3].plot(run.t, run.wanted, color=MUTED, linestyle="-.", linewidth=0.9, label="wanted")
    axes[3].plot(run.t, run.torque, color=COLOURS[3], label="drive shaft")
    finish(axes[3], "torque [Nm]")
    for begin, _ in run.shifts:
        for panel in axes:
            _mark(panel, begin)
    axes[-1].set_xlabel("time [s]")
    return figure


def _mark(axes: Axes, t: float) -> None:
    axes.axvline(t, color=MUTED, linewidth=0.8, linestyle=":")


def _draw_inputs(axes: Axes, run: ShiftRun) -> None:
    names = (("engine torque [Nm]", 0), ("brake force [N]", 1), ("clutch force [N]", 2))
    for colour, (label, column) in zip(COLOURS, names, strict=False):
        axes.plot(run.t, run.fine[:, column], color=colour, label=label)
    finish(axes, "torque [Nm], force [N]")


def _draw_speeds(axes: Axes, run: ShiftRun) -> None:
    axes.plot(run.t, run.fine[:, 4], color=COLOURS[0], label="engine")
    axes.plot(run.t, run.fine[:, 4] - run.fine[:, 10], color=COLOURS[2], linestyle="--", label="primary shaft")
    finish(axes, "speed [rad/s]")


def _draw_flywheel(axes: Axes, run: ShiftRun) -> None:
    axes.plot(run.t, run.fine[:, 9], color=COLOURS[2], label="flywheel")
    axes.axhline(0.0, color=LIMIT, linewidth=0.8, linestyle="--", label="reversal")
    finish(axes, "speed [rad/s]")


def _draw_torque(axes: Axes, run: ShiftRun) -> None:
    axes.plot(run.t, run.torque, color=COLOURS[3], label="drive shaft")
    axes.plot(run.t, run.reference, color=MUTED, linestyle="-.", linewidth=0.9, label="reference")
    spread = max(float(np.ptp(run.torque)), 0.1 * float(np.abs(run.reference).max()))
    axes.set_ylim(float(run.torque.min()) - 0.1 * spread, float(run.torque.max()) + 0.1 * spread)
    finish(axes, "torque [Nm]")


def _draw_solve_times(axes: Axes, run: ShiftRun) -> None:
    begin = 0.0
    for part in run.parts[:2]:
        t = begin + part.t[:-1]
        axes.step(t, 1e3 * part.info["seconds"], where="post", color=COLOURS[6], linewidth=1.0)
        begin += float(part.t[-1])
    axes.set_yscale("log")
    axes.yaxis.set_minor_formatter("")
    finish(axes, "solve time [ms]", legend=False)
