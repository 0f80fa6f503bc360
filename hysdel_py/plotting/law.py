"""Pictures of explicit laws: the partition, the moves and the value over one or two parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.errors import ArgumentError
from hysdel_py.plotting.law_pieces import Piece, colour_of, pieces_of
from hysdel_py.plotting.style import MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Shown", "check_words", "draw", "name_kinds", "new_partition", "plot_law"]

Array = NDArray[np.float64]

_MOST_NAMED = 12
"""Entries of a legend; the largest pieces are named."""

_SEEN = 0.002
"""Kinds that cover a smaller share are not named."""

_LABELLED = 0.04
"""A region bears its number if it is so wide, as a share of the axes."""

_WORDS = ("partition", "move", "value")


def plot_law(
    law: ExplicitLaw,
    what: str = "partition",
    *,
    section: Mapping[str | int, float] | None = None,
    by: str = "law",
    move: int = 0,
    trace: ArrayLike | None = None,
    units: Sequence[str] = (),
    move_label: str = "",
) -> Figure:
    """Draw a law over the parameters that a section leaves: two, or one.

    Parameters
    ----------
    law : ExplicitLaw
    what : str
        ``"partition"``, ``"move"`` or ``"value"``: regions from above, or a surface over them. Over one parameter all
        three show the moves, and the value beneath where it is known.
    section : mapping of name or position to number, optional
        Parameters that are fixed.
    by : str
        ``"law"``: equal moves have equal colours; ``"region"``: every region has its own, and its number.
    move : int
        The move of a surface.
    trace : array_like of shape (n, p), optional
        Points of a run, drawn over the partition; those of all parameters, the fixed ones are left out.
    units : sequence of str
        Of all parameters.
    move_label : str
        Name of the moves with their unit.

    Raises
    ------
    ArgumentError
        More than two parameters are left; a name, a number or a shape is wrong; there is nothing in the section, or
        the law has no value function.
    """
    _check(law, what, by, move)
    labels = _labels(law, units)
    cut = law.fixed(section) if section else law
    free = [law.names.index(name) for name in cut.names]
    if cut.p > 2:
        raise ArgumentError(f"{cut.p} parameters are left ({', '.join(cut.names)}): fix all but two with section")
    if not cut.count:
        raise ArgumentError("the section meets no region: other values were expected")
    title = ", ".join(f"{law.names[j]} = {v:.4g}" for j, v in _fixed(law, section or {}))
    shown = Shown([labels[j] for j in free], f"at {title}" if title else "", move_label or "move")
    if trace is not None and (cut.p == 1 or what != "partition"):
        raise ArgumentError("a trace is drawn over a partition of two parameters: leave it out, or fix fewer of them")
    path = None if trace is None else _path(law, trace)[:, free]
    return draw(cut, shown, what, by=by, move=move, path=path)


def draw(cut: ExplicitLaw, shown: Shown, what: str, *, by: str, move: int, path: Array | None = None) -> Figure:
    """Draw a law of one or two parameters; words as for :func:`plot_law`, `path` is over these parameters."""
    if cut.p == 1:
        from hysdel_py.plotting.law_lines import plot_lines

        return plot_lines(cut, shown.axes[0], shown.moves or (shown.move,), shown.title, by)
    if what == "partition":
        return _partition(cut, by, shown, path)
    from hysdel_py.plotting.law_surface import plot_surface

    label = shown.moves[move] if shown.moves else shown.move if cut.moves == 1 else f"{shown.move} {move}"
    all_labels = (shown.axes[0], shown.axes[1], label)
    return plot_surface(cut, None if what == "value" else move, by, all_labels, shown.title)


@dataclass(frozen=True, slots=True)
class Shown:
    """Labels of a picture: of the axes, what is fixed, the moves together, and where known each of them."""

    axes: list[str]
    title: str
    move: str
    moves: tuple[str, ...] = ()


def check_words(what: str, by: str) -> None:
    """Refuse words that name no picture or no colouring."""
    if what not in _WORDS:
        raise ArgumentError(f"what is {what!r}: one of {', '.join(_WORDS)} was expected")
    if by not in ("law", "region"):
        raise ArgumentError(f"by is {by!r}: law or region was expected")


def _check(law: ExplicitLaw, what: str, by: str, move: int) -> None:
    check_words(what, by)
    if not 0 <= move < law.moves:
        raise ArgumentError(f"move is {move}: a number from 0 to {law.moves - 1} was expected")
    if what == "value" and not law.has_value:
        raise ArgumentError("this law has no value function: ask the law from before it was merged")


def _labels(law: ExplicitLaw, units: Sequence[str]) -> list[str]:
    if not units:
        return list(law.names)
    if isinstance(units, str) or len(units) != law.p:
        raise ArgumentError(f"units are {units!r}: {law.p} texts were expected")
    return [f"{name} [{unit}]" if unit else name for name, unit in zip(law.names, units, strict=True)]


def _fixed(law: ExplicitLaw, section: Mapping[str | int, float]) -> list[tuple[int, float]]:
    places = {law.names.index(name) if isinstance(name, str) else name: value for name, value in section.items()}
    return sorted(places.items())


def _path(law: ExplicitLaw, trace: ArrayLike) -> Array:
    points = np.asarray(trace, dtype=float)
    if points.ndim != 2 or points.shape[1] != law.p or not np.isfinite(points).all():
        raise ArgumentError(f"trace has shape {points.shape}: finite numbers (n, {law.p}) were expected")
    return points


def _partition(law: ExplicitLaw, by: str, shown: Shown, path: Array | None) -> Figure:
    figure, axes = new_partition(law, shown)
    low, high = law.domain.bounding_box
    pieces = pieces_of(law, by)
    for piece in pieces:
        _fill(axes, piece, high - low, numbered=by == "region")
    if path is not None:
        _draw_path(axes, path)
    areas: dict[int, float] = {}
    for piece in pieces:
        areas[piece.kind] = areas.get(piece.kind, 0.0) + piece.area
    texts = {piece.kind: piece.text for piece in reversed(pieces)}
    name_kinds(axes, areas if by == "law" else {}, texts, shown.move)
    return figure


def new_partition(law: ExplicitLaw, shown: Shown) -> tuple[Figure, Axes]:
    """An empty picture of the domain of a law over two parameters."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.5, 5.0), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    low, high = law.domain.bounding_box
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel=shown.axes[0], ylabel=shown.axes[1])
    axes.set_title(shown.title, fontsize=9, loc="left")
    return figure, axes


def _fill(axes: Axes, piece: Piece, spans: Array, *, numbered: bool) -> None:
    axes.fill(piece.corners[:, 0], piece.corners[:, 1], facecolor=piece.colour, edgecolor="white", linewidth=0.6)
    if numbered and np.min(np.ptp(piece.corners, axis=0) / spans) > _LABELLED:
        middle = piece.corners.mean(axis=0)
        axes.text(float(middle[0]), float(middle[1]), str(piece.region), ha="center", va="center", fontsize=7,
                  clip_on=True)  # fmt: skip


def _draw_path(axes: Axes, path: Array) -> None:
    axes.plot(path[:, 0], path[:, 1], color="black", marker=".", markersize=4, linewidth=1.2, label="run", zorder=4)
    axes.plot(
        *path[0], color="black", marker="o", markersize=8, fillstyle="none", linestyle="", label="start", zorder=5
    )


def name_kinds(axes: Axes, areas: Mapping[int, float], texts: Mapping[int, str], move: str) -> None:
    """A legend of the run and of the kinds that cover most; none of kinds without areas."""
    from matplotlib.patches import Patch

    largest = sorted(areas, key=lambda kind: (-areas[kind], kind))
    named = [kind for kind in largest if areas[kind] > _SEEN * sum(areas.values())][:_MOST_NAMED]
    handles, labels = axes.get_legend_handles_labels()
    for kind in named:
        handles.append(Patch(facecolor=colour_of(kind)))
        labels.append(texts[kind])
    if len(largest) > len(named):
        handles.append(Patch(facecolor="none"))
        labels.append(f"and {len(largest) - len(named)} more on small regions")
    if handles:
        legend = axes.legend(handles, labels, title=move if areas else "", loc="center left",
                             bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize="small")  # fmt: skip
        legend.get_title().set_color(MUTED)
