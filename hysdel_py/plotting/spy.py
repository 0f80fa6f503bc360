"""Which variables stand in which rows of an MLD form, row by row beside the line of the source that made them."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.errors import ArgumentError
from hysdel_py.plotting.modes import new_axes
from hysdel_py.plotting.style import COLOURS, MUTED
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_spy"]

_LABEL = 48
"""Characters of a source line that are shown."""
_GROUPS = (("u", "E1", "inputs"), ("x", "E4", "states"), ("d", "E2", "Booleans"), ("z", "E3", "reals"))
_MOST_ROWS = 400
"""Pictures of more rows show their first ones."""


def plot_spy(mld: Mld) -> Figure:
    """Draw the nonzero coefficients of ``E2 d + E3 z <= E1 u + E4 x + E5``, one colour for each section of the source.

    Rows that come from one line stand together beside its text. Of more than 400 rows the first are drawn.

    Raises
    ------
    ArgumentError
        The form has no rows.
    """
    if not mld.rows:
        raise ArgumentError(f"{mld.name or 'the form'} has no rows that could be drawn")
    shown = min(len(mld.rows), _MOST_ROWS)
    names = [v.name for key, _, _ in _GROUPS for v in getattr(mld, key)]
    figure, axes = new_axes(4.5 + 0.24 * len(names), 1.6 + 0.17 * shown)
    colours = _colours(mld.rows)
    _draw_points(axes, mld, shown, colours)
    _draw_lines(axes, mld.rows[:shown])
    _draw_groups(axes, mld, shown)
    axes.set_xticks(range(len(names)), names, rotation=90, fontsize=7)
    axes.set(xlim=(-0.6, len(names) - 0.4), ylim=(shown - 0.4, -0.6))
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    axes.legend(title="section", loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize="small")
    axes.set_xlabel(f"{mld.name}: {len(mld.rows)} rows" + f", the first {shown} shown" * (shown < len(mld.rows)))
    return figure


def _section(row: RowOrigin) -> str:
    return row.section or "generated"


def _colours(rows: tuple[RowOrigin, ...]) -> dict[str, str]:
    sections = dict.fromkeys(_section(row) for row in rows)
    return {section: COLOURS[i % len(COLOURS)] for i, section in enumerate(sections)}


def _draw_points(axes: Axes, mld: Mld, shown: int, colours: dict[str, str]) -> None:
    """One square for each coefficient, in the colour of the section of its row."""
    blocks = [getattr(mld, matrix).toarray()[:shown] for _, matrix, _ in _GROUPS]
    row, column = np.nonzero(np.hstack(blocks))
    section = np.array([_section(origin) for origin in mld.rows[:shown]])[row]
    for name, colour in colours.items():
        chosen = section == name
        axes.scatter(column[chosen], row[chosen], s=22, marker="s", color=colour, linewidth=0, label=name)


def _draw_lines(axes: Axes, rows: tuple[RowOrigin, ...]) -> None:
    """Bands behind the rows of every second line, and the lines as labels."""
    ticks, labels, first = [], [], 0
    for number, (origin, group) in enumerate(groupby(rows, key=lambda row: (row.line, row.text))):
        count = len(list(group))
        if number % 2:
            axes.axhspan(first - 0.5, first + count - 0.5, color="#f2f2f2", linewidth=0, zorder=0)
        ticks.append(first + (count - 1) / 2)
        labels.append(_label(*origin))
        first += count
    axes.set_yticks(ticks, labels, fontsize=7, family="monospace")


def _label(line: int, text: str) -> str:
    short = text if len(text) <= _LABEL else text[: _LABEL - 1] + "…"
    return f"{short}  {line}" if line else short


def _draw_groups(axes: Axes, mld: Mld, shown: int) -> None:
    """Names of the vectors above their columns, and lines between them."""
    first = 0
    for key, matrix, word in _GROUPS:
        count = len(getattr(mld, key))
        if not count:
            continue
        if first:
            axes.plot([first - 0.5] * 2, [-0.6, shown - 0.4], color=MUTED, linewidth=0.6)
        axes.text(first + (count - 1) / 2, -0.9, f"{matrix}\n{word}", ha="center", va="bottom", fontsize=7)
        first += count
