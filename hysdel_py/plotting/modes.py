"""Pictures of a piecewise affine system: the graph of its modes, and a section through their regions."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.plotting.style import COLOURS, MUTED
from hysdel_py.systems.mode import Mode
from hysdel_py.systems.pwa import Pwa
from hysdel_py.systems.signals import Variable

if TYPE_CHECKING:
    import networkx as nx
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["clip", "new_axes", "plot_graph", "plot_section"]

_LINE = 34
"""Characters in a line of a label."""
_TITLE = 110
"""Characters in a line above a section."""
_MOST_CONDITIONS = 12
"""Graphs of more modes than this show words without conditions."""

_ALPHAS = (0.35, 0.7, 0.95)
"""For the first, second and third round of colours."""

Matrix = NDArray[np.float64]


def plot_graph(pwa: Pwa, graph: nx.Graph | nx.DiGraph) -> Figure:
    """Draw a graph of the modes: each mode with its word and conditions, in the colour of its dynamics.

    Parameters
    ----------
    graph : networkx.Graph or networkx.DiGraph
        What :meth:`Pwa.adjacency` or :meth:`Pwa.transitions` returned.
    """
    size = float(np.clip(2.2 * np.sqrt(len(pwa.modes)) + 4.0, 6.0, 24.0))
    figure, axes = new_axes(1.5 * size, size)
    places = _layout(graph)
    loops = {first for first, second in graph.edges if first == second}
    short = len(pwa.modes) > _MOST_CONDITIONS
    boxes = {}
    for number, group in enumerate(pwa.dynamics):
        for index in group:
            colour = COLOURS[number % len(COLOURS)]
            text = _mode_text(pwa.modes[index], stays=index in loops, short=short)
            boxes[index] = _draw_box(axes, text, places[index], colour, dashed=pwa.modes[index].is_flat)
    for first, second in graph.edges:
        if first != second:
            _draw_edge(axes, (places[first], places[second]), (boxes[first], boxes[second]), graph.is_directed())
    _finish_graph(axes, pwa, places)
    return figure


def new_axes(width: float, height: float) -> tuple[Figure, Axes]:
    """A figure with one panel, which belongs to no window."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.add_subplot()


def _layout(graph: nx.Graph | nx.DiGraph) -> dict[int, Matrix]:
    """Places of the nodes, the same each time."""
    import networkx as nx

    plain = nx.Graph(graph)
    circle = nx.circular_layout(plain)
    if len(plain) < 4:
        return {node: np.array([1.0 * k, 0.0]) for k, node in enumerate(plain)}
    if plain.number_of_edges() and nx.is_connected(plain):
        return {node: np.asarray(place) for node, place in nx.kamada_kawai_layout(plain, pos=circle).items()}
    return {node: np.asarray(place) for node, place in circle.items()}


def _draw_edge(axes: Axes, ends: tuple[Matrix, Matrix], boxes: tuple[Any, Any], is_directed: bool) -> None:
    """Draw from box to box; drawn after the boxes, whose extent is known only then."""
    from matplotlib.patches import FancyArrowPatch

    arrow = FancyArrowPatch(
        tuple(ends[0]), tuple(ends[1]), patchA=boxes[0], patchB=boxes[1], shrinkA=1, shrinkB=1, mutation_scale=12,
        arrowstyle="-|>" if is_directed else "-", connectionstyle=f"arc3,rad={0.08 * is_directed}", color=MUTED,
        linewidth=0.9, alpha=0.8, zorder=3,
    )  # fmt: skip
    axes.add_patch(arrow)


def _mode_text(mode: Mode, *, stays: bool, short: bool) -> str:
    head = f"{mode.index}: {mode.bits}" + " (flat)" * mode.is_flat + " ↺" * stays
    lines = [] if short else [fill(text, _LINE, subsequent_indent="   ") for text in mode.conditions]
    return "\n".join([head, *lines])


def _draw_box(axes: Axes, text: str, place: Matrix, colour: str, *, dashed: bool) -> Any:
    box = {"boxstyle": "round,pad=0.35", "facecolor": "white", "edgecolor": colour, "linewidth": 1.8,
           "linestyle": "--" if dashed else "-"}  # fmt: skip
    drawn = axes.text(float(place[0]), float(place[1]), text, ha="center", va="center", fontsize=8, zorder=2, bbox=box)
    return drawn.get_bbox_patch()


def _finish_graph(axes: Axes, pwa: Pwa, places: Mapping[int, Matrix]) -> None:
    points = np.array(list(places.values())).reshape(-1, 2)
    low, high = points.min(axis=0, initial=0.0), points.max(axis=0, initial=0.0)
    margin = 0.12 * np.maximum(high - low, 1.0)
    axes.set_xlim(low[0] - margin[0], high[0] + margin[0])
    axes.set_ylim(low[1] - margin[1], high[1] + margin[1])
    axes.set_axis_off()
    axes.set_title(f"{pwa.name}: word = {_letters(pwa)}; equal colours: equal dynamics; ↺: can stay", fontsize=9)


def _letters(pwa: Pwa) -> str:
    """Names of the Booleans in the words of the modes."""
    return ", ".join(name for name, _ in pwa.modes[0].word) if pwa.modes else ""


def plot_section(pwa: Pwa, horizontal: str, vertical: str, at: Mapping[str, float] | None = None) -> Figure:
    """Draw a section through the regions, with one colour for each mode.

    Parameters
    ----------
    horizontal, vertical : str
        Real states or inputs on the axes; their declared ranges are drawn.
    at : mapping of name to number, optional
        Values of the other states and inputs; by default the middle of the range, and 0 for a Boolean.

    Raises
    ------
    ArgumentError
        A name is no real state or input, or its range is not finite.
    """
    variables = {v.name: v for v in (*pwa.x, *pwa.u)}
    across, upwards = (_drawable(name, variables) for name in (horizontal, vertical))
    values = {name: _middle(v) for name, v in variables.items()} | dict(at or {})
    unknown = [name for name in at or {} if name not in variables]
    if unknown:
        raise ArgumentError(f"there is no state or input {', '.join(unknown)}: there are {', '.join(variables)}")
    figure, axes = new_axes(8.0, 5.5)
    axes.set(xlim=(across.low, across.high), ylim=(upwards.low, upwards.high))
    for mode in pwa.modes:
        corners = _polygon(mode, (across, upwards), values)
        if len(corners) > 2:
            _fill(axes, corners, mode)
    axes.set_xlabel(across.label)
    axes.set_ylabel(upwards.label)
    _section_title(axes, values, (horizontal, vertical), _letters(pwa))
    return figure


def _drawable(name: str, variables: Mapping[str, Variable]) -> Variable:
    found = variables.get(name)
    if found is None or found.is_bool:
        reals = ", ".join(v.name for v in variables.values() if not v.is_bool)
        raise ArgumentError(f"{name} is no real state or input: there are {reals}")
    if not np.isfinite(found.low) or not np.isfinite(found.high):
        raise ArgumentError(f"{name} has no finite range that could be drawn")
    return found


def _middle(variable: Variable) -> float:
    if variable.is_bool:
        return 0.0
    low, high = (end if np.isfinite(end) else 0.0 for end in (variable.low, variable.high))
    return (low + high) / 2.0


def _polygon(mode: Mode, axes: tuple[Variable, Variable], values: Mapping[str, float]) -> Matrix:
    """Corners of the section: the drawn rectangle cut by one row after the other."""
    columns = [mode.names.index(v.name) for v in axes]
    rest = np.array([0.0 if i in columns else values[name] for i, name in enumerate(mode.names)])
    (left, right), (low, high) = ((v.low, v.high) for v in axes)
    corners = np.array([[left, low], [right, low], [right, high], [left, high]])
    for row, side in zip(mode.region.A, mode.region.b, strict=True):
        corners = clip(corners, row[columns], float(side - row @ rest))
    return corners


def clip(corners: Matrix, a: Matrix, b: float) -> Matrix:
    """The part of a polygon with ``a v <= b`` (Sutherland and Hodgman, 1974)."""
    kept: list[Matrix] = []
    excess = corners @ a - b
    for k in range(len(corners)):
        here, before = excess[k], excess[k - 1]
        if here * before < 0:
            kept.append(corners[k - 1] + (corners[k] - corners[k - 1]) * before / (before - here))
        if here <= 0:
            kept.append(corners[k])
    return np.array(kept).reshape(-1, 2)


def _fill(axes: Axes, corners: Matrix, mode: Mode) -> None:
    colour = COLOURS[mode.index % len(COLOURS)]
    alpha = _ALPHAS[mode.index // len(COLOURS) % len(_ALPHAS)]
    axes.fill(corners[:, 0], corners[:, 1], facecolor=colour, alpha=alpha, edgecolor="white", linewidth=1.0,
              label=f"{mode.index}: {mode.bits}")  # fmt: skip
    span = np.ptp(corners, axis=0) / np.array([np.ptp(axes.get_xlim()) or 1.0, np.ptp(axes.get_ylim()) or 1.0])
    if span.min() > 0.02:
        middle = corners.mean(axis=0)
        axes.text(float(middle[0]), float(middle[1]), str(mode.index), ha="center", va="center", fontsize=9)


def _section_title(axes: Axes, values: Mapping[str, float], drawn: tuple[str, str], letters: str) -> None:
    fixed = ", ".join(f"{name} = {value:.4g}" for name, value in values.items() if name not in drawn)
    lines = [f"at {fixed}"] * bool(fixed) + [f"word = {letters}"] * bool(letters)
    axes.set_title("\n".join(fill(line, _TITLE) for line in lines), fontsize=8, loc="left")
    handles, names = axes.get_legend_handles_labels()
    if names:
        axes.legend(handles, names, title="mode", loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False,
                    fontsize="small")  # fmt: skip
