"""Picture of many runs of gear shifts on plants that are not the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hysdel_py.plotting.style import COLOURS, LIMIT, finish, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_study"]

_PANELS = (
    ("relative_release", 100.0, "torque off,\npart 1 [%]"),
    ("deviation_engage", 1.0, "torque off,\npart 2 [Nm]"),
    ("shift_time", 1.0, "locked after [s]"),
)
_GOAL = 2.0


def plot_study(groups: Sequence[Sequence[Mapping[str, Any]]]) -> Figure:
    """Draw the figures of each run over the friction of its plant.

    Parameters
    ----------
    groups : sequence of sequences of mappings
        Runs that belong together; see :func:`hysdel_py.demos.shifts.study.run_trial`.
    """
    figure, axes = new_figure(len(_PANELS), [1.3] * len(_PANELS))
    for panel, (name, scale, label) in zip(axes, _PANELS, strict=True):
        for colour, group in zip(COLOURS, groups, strict=False):
            rows = [row for row in group if row[name] is not None]
            panel.plot(
                [row["friction"] for row in rows], [scale * row[name] for row in rows], linestyle="", marker=".",
                markersize=5, color=colour, alpha=0.7, label=_title(group[0], len(group)),
            )  # fmt: skip
        if name == "relative_release":
            panel.axhline(_GOAL, color=LIMIT, linewidth=0.8, linestyle="--", label="2 %")
        finish(panel, label, legend=panel is axes[0])
        panel.set_ylim(bottom=0.0)
    axes[-1].set_xlabel("friction of the plant, as a share of the model's [-]")
    return figure


def _title(row: Mapping[str, Any], count: int) -> str:
    return f"{row['shift']}\n{row['controller']}{'' if row['observed'] else ', no observer'}\n{count} runs"
