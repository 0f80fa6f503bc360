"""Pictures of the modes of a run: signals over coloured bands, a line for each mode, and the moves between modes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from hysdel_py.errors import ArgumentError
from hysdel_py.plotting.modes import new_axes
from hysdel_py.plotting.style import COLOURS, MUTED, finish, new_figure
from hysdel_py.plotting.trajectory import plot_trajectory, time_label
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["mode_names", "plot_bands", "plot_timeline", "plot_visits"]

_BAND = 0.22
"""How much of its colour a band behind signals has."""
_COLOURS = (*COLOURS[4:6], COLOURS[3], COLOURS[2], COLOURS[0], COLOURS[1])
"""Signals begin with the others."""
_ALL_OFF, _OFF_COLOUR = "all off", "#BBBBBB"
_MOST_NAMED = 8
"""Legends name the modes that last longest."""

Span = tuple[str, float, float]
Point = tuple[float, float]


def mode_names(trajectory: Trajectory, booleans: Sequence[str] = ()) -> tuple[str, ...]:
    """What the mode of each step is called: the Booleans that are true, or "all off".

    Parameters
    ----------
    trajectory : Trajectory
    booleans : sequence of str
        The auxiliaries that make the mode; all of them by default.

    Raises
    ------
    ArgumentError
        A name is no Boolean auxiliary, or the run has none.
    """
    names = trajectory.names.get("d", ())
    if not names:
        raise ArgumentError("modes are made of Boolean auxiliaries, and the run has none")
    unknown = [name for name in booleans if name not in names]
    if unknown:
        raise ArgumentError(f"{', '.join(unknown)} is no Boolean auxiliary: there are {', '.join(names)}")
    columns = [names.index(name) for name in booleans or names]
    return tuple(" ".join(names[i] for i in columns if row[i] > 0.5) or _ALL_OFF for row in trajectory.d)


def plot_bands(
    trajectory: Trajectory, names: Sequence[str] = (), *, booleans: Sequence[str] = (), time_unit: str = ""
) -> Figure:
    """Draw signals as :meth:`Trajectory.plot` does, over bands in the colour of the mode.

    Parameters
    ----------
    names : sequence of str
        Signals to draw; all states, inputs and outputs by default.
    booleans : sequence of str
        The auxiliaries that make the mode; all by default.
    time_unit : str
    """
    from matplotlib.patches import Patch

    spans = _spans(trajectory, booleans)
    colours = _colours(spans)
    figure = plot_trajectory(trajectory, names, time_unit)
    for axes in figure.axes:
        for name, begin, end in spans:
            axes.axvspan(begin, end, color=colours[name], alpha=_BAND, linewidth=0, zorder=-1)
    handles = [Patch(color=colours[name], alpha=2 * _BAND, label=name) for name in _longest(spans)]
    figure.legend(handles=handles, loc="outside upper left", ncols=4, frameon=False, fontsize="small")
    return figure


def plot_timeline(trajectory: Trajectory, *, booleans: Sequence[str] = (), time_unit: str = "") -> Figure:
    """Draw one line for each mode, with a bar where the run is in it; modes in the order of their first time."""
    spans = _spans(trajectory, booleans)
    colours = _colours(spans)
    figure, (axes,) = new_figure(1, [0.25 + 0.14 * len(colours)])
    for row, name in enumerate(reversed(colours)):
        bars = [(begin, end - begin) for word, begin, end in spans if word == name]
        axes.broken_barh(bars, (row - 0.38, 0.76), facecolors=colours[name], linewidth=0)
    axes.set_yticks(range(len(colours)), list(reversed(colours)), fontsize="small")
    axes.set_ylim(-0.6, len(colours) - 0.4)
    finish(axes, "mode", legend=False)
    axes.set_xlabel(time_label(trajectory, time_unit))
    return figure


def plot_visits(trajectory: Trajectory, *, booleans: Sequence[str] = ()) -> Figure:
    """Draw the modes that a run visits, with an arrow for each move between two and how often it was made."""
    words = mode_names(trajectory, booleans)
    stays = Counter(words)
    moves = Counter((before, after) for before, after in pairwise(words) if before != after)
    figure, axes = new_axes(7.0, 5.0)
    places = _circle(list(stays))
    colours = _coloured(stays)
    boxes = {name: _draw_mode(axes, places[name], _stay(name, count), colours[name]) for name, count in stays.items()}
    for (before, after), count in moves.items():
        _draw_move(axes, (places[before], places[after]), (boxes[before], boxes[after]), str(count))
    heights = [height for _, height in places.values()]
    axes.set(xlim=(-1.7, 1.7), ylim=(min(heights) - 0.35, max(heights) + 0.35))
    axes.set_axis_off()
    return figure


def _spans(trajectory: Trajectory, booleans: Sequence[str]) -> list[Span]:
    """(mode, begin, end) of each stay."""
    words, t = mode_names(trajectory, booleans), trajectory.t
    spans, step = [], 0
    for word, stay in groupby(words):
        length = len(list(stay))
        spans.append((word, float(t[step]), float(t[step + length])))
        step += length
    return spans


def _colours(spans: Sequence[Span]) -> dict[str, str]:
    """A colour for each mode, in the order of its first time."""
    names = dict.fromkeys(name for name, _, _ in spans)
    every = _coloured(names)
    return {name: every[name] for name in names}


def _coloured(names: Iterable[str]) -> dict[str, str]:
    others = [name for name in names if name != _ALL_OFF]
    return {_ALL_OFF: _OFF_COLOUR} | {name: _COLOURS[i % len(_COLOURS)] for i, name in enumerate(others)}


def _longest(spans: Sequence[Span]) -> list[str]:
    """The modes that last longest, in the order of their first time."""
    lasted: Counter[str] = Counter()
    for name, begin, end in spans:
        lasted[name] += end - begin  # type: ignore[assignment]
    kept = {name for name, _ in lasted.most_common(_MOST_NAMED)}
    return [name for name in lasted if name in kept]


def _circle(names: Sequence[str]) -> dict[str, Point]:
    """Places on a circle, clockwise from the top."""
    angles = np.pi / 2 - 2 * np.pi * np.arange(len(names)) / len(names)
    return {name: (1.2 * float(np.cos(a)), float(np.sin(a))) for name, a in zip(names, angles, strict=True)}


def _stay(name: str, count: int) -> str:
    return f"{name}\n{count} step{'s' * (count > 1)}"


def _draw_mode(axes: Axes, place: Point, text: str, colour: str) -> Any:
    box = {"boxstyle": "round,pad=0.4", "facecolor": "white", "edgecolor": colour, "linewidth": 2.0}
    return axes.text(*place, text, ha="center", va="center", fontsize=9, zorder=2, bbox=box).get_bbox_patch()


def _draw_move(axes: Axes, ends: tuple[Point, Point], boxes: tuple[Any, Any], text: str) -> None:
    """An arrow that is bent to one side, so that the way back has room; the count beside its middle."""
    from matplotlib.patches import FancyArrowPatch

    arrow = FancyArrowPatch(
        *ends, patchA=boxes[0], patchB=boxes[1], shrinkA=2, shrinkB=2, mutation_scale=14, arrowstyle="-|>",
        connectionstyle="arc3,rad=0.18", color=MUTED, linewidth=1.2, zorder=3,
    )  # fmt: skip
    axes.add_patch(arrow)
    along = np.subtract(ends[1], ends[0])
    middle = np.add(*ends) / 2 + 0.13 * np.array([along[1], -along[0]])
    axes.text(float(middle[0]), float(middle[1]), text, ha="center", va="center", fontsize=9, color=MUTED, zorder=4)
