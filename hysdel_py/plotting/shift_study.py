"""Picture of many runs of gear shifts on plants that are not the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hysdel_py.plotting.style import COLOURS, LIMIT, finish, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_study"]

_PANELS = (
    ("relative_release", 100.0, "torque off,\npart 1 [%]", "log"),
    ("deviation_engage", 1.0, "torque off,\npart 2 [Nm]", "log"),
    ("shift_time", 1.0, "locked after [s]", "linear"),
)
_GOAL = 2.0
_WIDTH = 1.8  # of a column, per factor of friction
_HALF = 0.42

Group = Sequence[Mapping[str, Any]]


def plot_study(groups: Sequence[Group]) -> Figure:
    """Draw the figures of each run, a column for each group, with the friction of the plant from left to right.

    Parameters
    ----------
    groups : sequence of sequences of mappings
        Runs that belong together; see :func:`hysdel_py.demos.shifts.study.run_trial`.
    """
    figure, axes = new_figure(len(_PANELS), [1.3] * len(_PANELS))
    for panel, (name, scale, label, kind) in zip(axes, _PANELS, strict=True):
        for k, group in enumerate(groups):
            _column(panel, k, group, name, scale)
        if name == "relative_release":
            panel.axhline(_GOAL, color=LIMIT, linewidth=0.8, linestyle="--", label="goal: 2 %")
        panel.set_yscale(kind)
        if kind == "log":
            panel.yaxis.set_major_formatter("{x:g}")
        finish(panel, label)
        panel.grid(visible=False, axis="x")
    axes[-1].set_xticks(range(len(groups)), [_title(group[0], len(group)) for group in groups], fontsize="small")
    axes[-1].set_xlabel("in each column: friction of the plant, from least to greatest")
    return figure


def _column(panel: Axes, k: int, group: Group, name: str, scale: float) -> None:
    """The runs of a group and their median."""
    rows = [row for row in group if row[name] is not None]
    values = [scale * row[name] for row in rows]
    places = [k + _WIDTH * (row["friction"] - 1.0) for row in rows]
    colour = COLOURS[k % len(COLOURS)]
    panel.plot(places, values, linestyle="", marker=".", markersize=4, color=colour, alpha=0.6)
    label = "median" if k == 0 else "_"  # the legend names one of them
    if values:
        panel.hlines(float(np.median(values)), k - _HALF, k + _HALF, color="black", linewidth=1.2, label=label)


def _title(row: Mapping[str, Any], count: int) -> str:
    controller = "" if row["controller"] == "hybrid" else f"\n{row['controller']}"
    observer = "" if row["observed"] else "\nno observer"
    return f"{row['shift']}{controller}{observer}\n{count} runs"
