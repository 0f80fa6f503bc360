"""Pictures of drivetrains: a run, and errors of methods over their times."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hysdel_py.drivetrain.comparison import Comparison, Row
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory
from hysdel_py.plotting.style import COLOURS, LINES, finish, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_drivetrain", "plot_work_precision"]

_MARKERS = "os^Dv"


def plot_drivetrain(run: DrivetrainTrajectory) -> Figure:
    """Draw speeds, slips, torques and modes of a run."""
    figure, axes = new_figure(4, [1.4, 1.0, 1.0, 0.5])
    names = run.names
    _draw_lines(axes[0], run, [(name, run[name]) for name in names.shafts], "speed [rad/s]")
    _draw_lines(axes[1], run, [(name, run[f"{name}.slip"]) for name in names.contacts], "slip [rad/s]")
    _draw_lines(axes[2], run, [(name, run[f"{name}.torque"]) for name in names.contacts], "torque [Nm]")
    _draw_modes(axes[3], run)
    axes[-1].set_xlabel("time [s]")
    return figure


def _style(i: int) -> dict[str, str]:
    return {"color": COLOURS[i % len(COLOURS)], "linestyle": LINES[i // len(COLOURS) % len(LINES)]}


def _draw_lines(axes: Axes, run: DrivetrainTrajectory, lines: list, label: str) -> None:  # type: ignore[type-arg]
    for i, (name, values) in enumerate(lines):
        axes.plot(run.t, values, label=name, linewidth=1.2, **_style(i))  # type: ignore[arg-type]
    finish(axes, label)


def _draw_modes(axes: Axes, run: DrivetrainTrajectory) -> None:
    """A bar wherever a contact sticks."""
    for i, name in enumerate(run.names.contacts):
        sticks = run.mode_codes[:, i] == 0
        axes.fill_between(run.t, i, i + 0.8, where=sticks, step="post", color=COLOURS[i % len(COLOURS)], label=name)
    axes.set_yticks([])
    finish(axes, "sticks")


def plot_work_precision(found: Comparison) -> Figure:
    """Draw mean error over time, both relative and logarithmic, one mark per method and step."""
    figure, (axes,) = new_figure(1, [3.2])
    methods = list(dict.fromkeys(row.method for row in found.rows))
    for i, method in enumerate(methods):
        rows: list[Row] = [row for row in found.rows if row.method == method]
        axes.plot(
            [row.ratio for row in rows], [row.error for row in rows], label=method, linewidth=0.8,
            marker=_MARKERS[i // len(COLOURS) % len(_MARKERS)], markersize=5, **_style(i),  # type: ignore[arg-type]
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("time, relative to the Switch Model with Euler steps of 1 ms")
    finish(axes, "mean error [rad/s]")
    return figure
