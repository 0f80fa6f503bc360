"""One look for all pictures: colours that colour-blind readers can tell apart, thin grid, no box."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["COLOURS", "LIMIT", "LINES", "MUTED", "finish", "new_figure"]

# Okabe and Ito, "Color universal design", 2008.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
LINES = ("-", "--", ":")  # for the first, second and third round of colours
LIMIT = "#B22222"
MUTED = "#777777"


def new_figure(
    panels: int, heights: list[float] | None = None, *, share_time: bool = True
) -> tuple[Figure, list[Axes]]:
    """A figure with panels above each other that share the time axis, unless told otherwise.

    The figure belongs to no window and to no global state of matplotlib.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    ratios = heights or [1.0] * panels
    figure = Figure(figsize=(8.0, 1.2 + 1.7 * sum(ratios)), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(panels, 1, sharex=share_time, squeeze=False, height_ratios=ratios)[:, 0]
    return figure, list(axes)


def finish(axes: Axes, label: str, *, legend: bool = True) -> None:
    """Label, grid and legend of a panel."""
    axes.set_ylabel(label)
    axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(x=0.01)
    handles, names = axes.get_legend_handles_labels()
    if legend and names:
        axes.legend(handles, names, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize="small")
