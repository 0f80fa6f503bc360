"""Pictures of trajectories."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.plotting.style import COLOURS, finish, new_figure
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_modes", "draw_signal", "plot_trajectory"]


def plot_trajectory(trajectory: Trajectory, names: Sequence[str] = ()) -> Figure:
    """Draw signals over time: one panel for each unit, and one for all Boolean signals.

    Parameters
    ----------
    trajectory : Trajectory
    names : sequence of str
        Signals to draw; all states, inputs and outputs by default.
    """
    chosen = _chosen(trajectory, names)
    booleans = [(key, v) for key, v in chosen if v.is_bool]
    panels = _grouped([(key, v) for key, v in chosen if not v.is_bool])
    heights = [1.0] * len(panels) + ([0.25 + 0.15 * len(booleans)] if booleans else [])
    figure, axes = new_figure(max(1, len(heights)), heights or None)
    for panel, ((what, unit), signals) in zip(axes, panels.items(), strict=False):
        for index, (key, variable) in enumerate(signals):
            draw_signal(panel, trajectory, key, variable, COLOURS[index % len(COLOURS)])
        finish(panel, f"{what} [{unit}]" if unit else what)
    if booleans:
        draw_modes(axes[-1], trajectory, booleans)
    axes[-1].set_xlabel(_time_label(trajectory))
    return figure


def _time_label(trajectory: Trajectory) -> str:
    whole = trajectory.steps == 0 or np.allclose(np.diff(trajectory.t), 1.0)
    return "step" if whole else "time [s]"


def _chosen(trajectory: Trajectory, names: Sequence[str]) -> list[tuple[str, Variable]]:
    every = [(key, v) for key, group in trajectory.variables.items() for v in group]
    if not names:
        return [(key, v) for key, v in every if key in ("x", "u", "y")]
    for name in names:
        _ = trajectory[name]  # an unknown name is an error that lists the known ones
    return [next((key, v) for key, v in every if v.name == name) for name in names]


def _grouped(signals: list[tuple[str, Variable]]) -> dict[tuple[str, str], list[tuple[str, Variable]]]:
    """Signals by vector and unit, in the order of first use."""
    words = {"x": "state", "u": "input", "y": "output", "z": "auxiliary"}
    panels: dict[tuple[str, str], list[tuple[str, Variable]]] = {}
    for key, variable in signals:
        panels.setdefault((words.get(key, key), variable.unit), []).append((key, variable))
    return panels


def draw_signal(axes: Axes, trajectory: Trajectory, key: str, variable: Variable, colour: str) -> None:
    """Draw one real signal: a line for states, steps for what is held between samples."""
    values = trajectory[variable.name]
    t = trajectory.t[: len(values)]
    style = "default" if key == "x" else "steps-post"
    axes.plot(t, values, color=colour, linewidth=1.5, drawstyle=style, label=variable.name)


def draw_modes(axes: Axes, trajectory: Trajectory, booleans: list[tuple[str, Variable]]) -> None:
    """Draw Boolean signals as bands that are filled where they are true."""
    from matplotlib.patches import Patch

    for row, (_, variable) in enumerate(reversed(booleans)):
        values = trajectory[variable.name][: trajectory.steps] > 0.5
        ends = trajectory.t
        spans = [(ends[k], ends[k + 1] - ends[k]) for k in np.flatnonzero(values)]
        axes.broken_barh(spans, (row - 0.38, 0.76), facecolors=COLOURS[0], linewidth=0)
    axes.set_yticks(range(len(booleans)), [v.name for _, v in reversed(booleans)], fontsize="small")
    axes.set_ylim(-0.6, len(booleans) - 0.4)
    finish(axes, "true", legend=False)
    axes.legend(handles=[Patch(color=COLOURS[0], label="true")], loc="center left", bbox_to_anchor=(1.01, 0.5),
                frameon=False, fontsize="small")  # fmt: skip
    axes.set_ylabel("")
