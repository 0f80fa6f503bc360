"""Pictures of trajectories."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.plotting.style import COLOURS, LINES, finish, new_figure
from hysdel_py.systems.signals import Kind, Type, Variable
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_held", "draw_modes", "draw_signal", "plot_trajectory", "time_label"]

Signal = tuple[str, Variable]
Vector = NDArray[np.float64]

_WORDS = {"x": "state", "u": "input", "y": "output", "z": "auxiliary", "info": "record"}


def plot_trajectory(trajectory: Trajectory, names: Sequence[str] = (), time_unit: str = "") -> Figure:
    """Draw signals over time: one panel for each unit, and one for all Boolean signals.

    Parameters
    ----------
    trajectory : Trajectory
    names : sequence of str
        Signals to draw, named as in :meth:`Trajectory.columns`; all states, inputs and outputs by default.
    time_unit : str
        Unit of the times; without one the axis counts steps where the times are whole steps, and seconds elsewhere.
    """
    chosen = _chosen(trajectory, names)
    booleans = [(key, v) for key, v in chosen if v.is_bool]
    panels = _grouped([(key, v) for key, v in chosen if not v.is_bool])
    heights = [1.0] * len(panels) + ([0.3 + 0.15 * len(booleans)] if booleans else [])
    figure, axes = new_figure(max(1, len(heights)), heights or None)
    for panel, ((what, unit), signals) in zip(axes, panels.items(), strict=False):
        for index, (key, variable) in enumerate(signals):
            draw_signal(panel, trajectory, key, variable, index)
        finish(panel, f"{what} [{unit}]" if unit else what)
        panel.ticklabel_format(axis="y", style="sci", scilimits=(-3, 5), useMathText=True)
    if booleans:
        draw_modes(axes[-1], trajectory, booleans)
    label = time_label(trajectory, time_unit)
    axes[-1].set_xlabel(label)
    axes[-1].locator_params(axis="x", integer=label == "step")
    return figure


def time_label(trajectory: Trajectory, unit: str) -> str:
    """Label of the time axis: with the unit that is given, or steps or seconds."""
    if unit:
        return f"time [{unit}]"
    whole = trajectory.steps == 0 or np.allclose(np.diff(trajectory.t), 1.0)
    return "step" if whole else "time [s]"


def _chosen(trajectory: Trajectory, names: Sequence[str]) -> list[Signal]:
    every = [(key, v) for key, group in trajectory.variables.items() for v in group]
    if not names:
        return [(key, v) for key, v in every if key in ("x", "u", "y")]
    every += [("info", Variable(name, Type.REAL, Kind.OUTPUT)) for name in trajectory.info]
    for name in names:
        _ = trajectory[name]  # an unknown name is an error that lists the known ones
    return [next((key, v) for key, v in every if name in (v.name, f"{key}.{v.name}")) for name in names]


def _grouped(signals: list[Signal]) -> dict[tuple[str, str], list[Signal]]:
    """Signals by vector and unit, in the order of first use."""
    panels: dict[tuple[str, str], list[Signal]] = {}
    for key, variable in signals:
        panels.setdefault((_WORDS.get(key, key), variable.unit), []).append((key, variable))
    return panels


def draw_signal(axes: Axes, trajectory: Trajectory, key: str, variable: Variable, index: int) -> None:
    """Draw one real signal, the one of number `index` in its panel: a line for states, steps for what is held."""
    values = trajectory[f"{key}.{variable.name}"]
    colour, dashes = COLOURS[index % len(COLOURS)], LINES[index // len(COLOURS) % len(LINES)]
    if key == "x":
        marker = "o" if len(values) == 1 else ""  # a line through a single sample would not be seen
        axes.plot(trajectory.t, values, dashes, color=colour, linewidth=1.5, marker=marker, label=variable.name)
    else:
        draw_held(axes, trajectory.t, values, linestyle=dashes, color=colour, linewidth=1.5, label=variable.name)


def draw_held(axes: Axes, times: Vector, values: Vector, **style: Any) -> None:
    """Draw N values that are held between N+1 times, each over its whole step."""
    held = np.append(values, values[-1:])
    axes.plot(times[: len(held)], held, drawstyle="steps-post", **style)


def draw_modes(axes: Axes, trajectory: Trajectory, booleans: list[Signal]) -> None:
    """Draw Boolean signals as bands that are filled where they are true."""
    from matplotlib.patches import Patch

    t = trajectory.t
    for row, (key, variable) in enumerate(reversed(booleans)):
        values = trajectory[f"{key}.{variable.name}"][: trajectory.steps] > 0.5
        spans = [(t[k], t[k + 1] - t[k]) for k in np.flatnonzero(values)]
        axes.broken_barh(spans, (row - 0.38, 0.76), facecolors=COLOURS[0], linewidth=0)
    axes.set_yticks(range(len(booleans)), [v.name for _, v in reversed(booleans)], fontsize="small")
    axes.set_ylim(-0.6, len(booleans) - 0.4)
    axes.update_datalim([(t[0], 0.0), (t[-1], 0.0)])  # the time axis is whole even if nothing is ever true
    finish(axes, "", legend=False)
    axes.legend(handles=[Patch(color=COLOURS[0], label="true")], loc="center left", bbox_to_anchor=(1.01, 0.5),
                frameon=False, fontsize="small")  # fmt: skip
