"""Reachable sets: shadows on two states, or intervals of one state over the steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.hybrid_set import HybridSet, Piece
from hysdel_py.analysis.reach import Reach
from hysdel_py.errors import ArgumentError
from hysdel_py.plotting.modes import new_axes
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["corners_of", "plot_reach", "plot_set"]

Matrix = NDArray[np.float64]

_PALEST, _DARKEST = 0.15, 0.95
"""Ends of the colour map that the first and the last step have."""


def plot_reach(found: Reach, names: Sequence[str] = (), runs: Sequence[Trajectory] = ()) -> Figure:
    """Draw the sets of all steps, the later the darker.

    Parameters
    ----------
    found : Reach
    names : sequence of str
        Two real states, whose plane gets the shadows of the sets, or one, which is drawn over the steps; the first two
        by default.
    runs : sequence of Trajectory
        Drawn on top.

    Raises
    ------
    ArgumentError
        A name is no real state, or a set is unbounded.
    """
    chosen = _chosen(found.sets[0], names)
    figure, axes = new_axes(8.0, 5.5)
    if len(chosen) == 1:
        _draw_over_steps(axes, found, chosen[0], runs)
    else:
        for k, states in enumerate(found.sets):
            _draw(axes, states, chosen, _colour(k, len(found.sets)), f"step {k}" if _is_labelled(k, found) else "")
        for run in runs:
            axes.plot(run[f"x.{chosen[0].name}"], run[f"x.{chosen[1].name}"], "k.-", linewidth=0.6, markersize=3)
        axes.set(xlabel=chosen[0].label, ylabel=chosen[1].label)
    _finish(axes, found)
    return figure


def plot_set(states: HybridSet, names: Sequence[str] = ()) -> Figure:
    """Draw the shadow of one set, as :func:`plot_reach` does with several."""
    return plot_reach(Reach((states,), is_exact=True, settled_at=None, is_complete=True), names)


def corners_of(piece: Piece, columns: Sequence[int]) -> Matrix:
    """Corners of the shadow of a piece on some real coordinates, in order around it; shape (n, 2).

    Raises
    ------
    ArgumentError
        The shadow is unbounded.
    """
    shadow = piece.region.project(columns)
    if not shadow.is_bounded:
        raise ArgumentError("a set is unbounded and cannot be drawn: give the inputs and states finite ranges")
    corners = shadow.vertices
    away = corners - corners.mean(axis=0)
    return np.asarray(corners[np.argsort(np.arctan2(away[:, 1], away[:, 0]))])


def _chosen(states: HybridSet, names: Sequence[str]) -> list[Variable]:
    reals = {v.name: v for v in states.x if not v.is_bool}
    unknown = [name for name in names if name not in reals]
    if unknown or len(names) > 2 or not reals:
        raise ArgumentError(f"one or two real states were expected, found {', '.join(names)}: there are {list(reals)}")
    return [reals[name] for name in (names or list(reals)[:2])]


def _columns(states: HybridSet, chosen: Sequence[Variable]) -> list[int]:
    reals = [v.name for v in states.x if not v.is_bool]
    return [reals.index(v.name) for v in chosen]


def _draw(axes: Axes, states: HybridSet, chosen: Sequence[Variable], colour: str, label: str) -> None:
    for piece in states.pieces:
        if not piece.region.is_empty:
            corners = corners_of(piece, _columns(states, chosen))
            axes.fill(*corners.T, facecolor=colour, edgecolor=colour, alpha=0.55, linewidth=1.2, label=label)
            label = ""


def _draw_over_steps(axes: Axes, found: Reach, state: Variable, runs: Sequence[Trajectory]) -> None:
    for k, low, high in _intervals(found, state):
        axes.fill_between([k - 0.3, k + 0.3], low, high, color=_colour(len(found.sets) - 1, len(found.sets)), alpha=0.5)
    for run in runs:
        axes.plot(run[f"x.{state.name}"], "k.-", linewidth=0.6, markersize=3)
    axes.set(xlabel="step", ylabel=state.label)


def _intervals(found: Reach, state: Variable) -> Iterator[tuple[int, float, float]]:
    for k, states in enumerate(found.sets):
        (column,) = _columns(states, [state])
        for piece in states.pieces:
            if not piece.region.is_empty:
                low, high = piece.region.bounding_box
                yield k, float(low[column]), float(high[column])


def _colour(step: int, count: int) -> str:
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    share = step / max(1, count - 1)
    return str(to_hex(colormaps["viridis_r"](_PALEST + (_DARKEST - _PALEST) * share)))


def _is_labelled(step: int, found: Reach) -> bool:
    """At most about eight labels."""
    return step % max(1, (len(found.sets) - 1) // 6) == 0 or step == len(found.sets) - 1


def _finish(axes: Axes, found: Reach) -> None:
    axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_title("exact sets" if found.is_exact else "sets that hold the states", fontsize=9, loc="left")
    handles, names = axes.get_legend_handles_labels()
    if names:
        axes.legend(handles, names, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize="small")
