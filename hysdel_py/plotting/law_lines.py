"""A law over one parameter: lines of the moves, and the value beneath."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.control.explicit_law import Array, ExplicitLaw, Vector
from hysdel_py.plotting.law_pieces import colour_of, kinds_of
from hysdel_py.plotting.style import COLOURS, LINES, MUTED, finish, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_lines"]

_POINTS = 50
"""Points of the value in each region."""


def plot_lines(law: ExplicitLaw, label: str, moves: tuple[str, ...], title: str, by: str) -> Figure:
    """Draw the moves over one parameter, each region in its colour, and the value where it is known.

    `moves` labels a panel for each move, or as a single text one panel for all of them.
    """
    figure, axes = new_figure(len(moves) + law.has_value)
    kinds = kinds_of(law, by)
    for region in np.argsort([_ends(law, region)[0] for region in range(law.count)], kind="stable").tolist():
        ends = np.array(_ends(law, region))
        for number in range(law.moves):
            values = law.K[region, number, 0] * ends + law.k[region, number]
            panel, style = (number, "-") if len(moves) > 1 else (0, LINES[number % len(LINES)])
            name = f"{moves[0]} {number}" if law.moves > len(moves) and region == 0 else None
            axes[panel].plot(ends, values, color=colour_of(kinds[region]), linestyle=style, linewidth=2, label=name)
        for panel in range(len(moves)):
            axes[panel].axvline(float(ends[0]), color=MUTED, linewidth=0.5)
        if law.has_value:
            _draw_value(axes[-1], law, region, ends)
    for drawn, text in zip(axes, (*moves, "value"), strict=False):
        finish(drawn, text)
    axes[0].set_title(title, fontsize=9, loc="left")
    axes[-1].set_xlabel(label)
    return figure


def _ends(law: ExplicitLaw, region: int) -> tuple[float, float]:
    A, b = law.rows(region)
    (low,), (high,) = law.domain.bounding_box
    a = A[:, 0]
    return max(float(low), *(b[a < 0] / a[a < 0]), -np.inf), min(float(high), *(b[a > 0] / a[a > 0]), np.inf)


def _draw_value(axes: Axes, law: ExplicitLaw, region: int, ends: Vector) -> None:
    zeta: Array = np.linspace(ends[0], ends[1], _POINTS)
    value = 0.5 * law.P[region, 0, 0] * zeta**2 + law.q[region, 0] * zeta + law.r[region]
    axes.plot(zeta, value, color=COLOURS[0])
    axes.axvline(float(ends[0]), color=MUTED, linewidth=0.5)
