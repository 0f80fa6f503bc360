"""Picture of a branch-and-bound search: the tree of its nodes, with bounds, fates and branching variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import TYPE_CHECKING

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.mixed_integer import NodeFate, NodeRecord, SearchInfo
from hysdel_py.plotting.style import COLOURS, MUTED
from hysdel_py.systems.summary import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Place", "places", "plot_tree"]

MOST_LABELS = 60
"""Trees of more nodes than this show marks without words."""

_LOOKS = {
    NodeFate.SPLIT: ("o", COLOURS[0]),
    NodeFate.CUT_OFF: ("s", COLOURS[4]),
    NodeFate.INFEASIBLE: ("X", COLOURS[1]),
    NodeFate.LEAF: ("D", COLOURS[2]),
}
_OPEN = "not visited"
_BEST = "better plan found"


@dataclass(frozen=True, slots=True)
class Place:
    """Where a node is drawn: leaves one apart, parents above the middle of their halves, one level per branching.

    A half that was never visited has a place and no record.
    """

    across: float
    level: int
    parent: int
    record: NodeRecord | None


def plot_tree(entries: Sequence[SearchInfo], variables: Sequence[str], title: str = "") -> Figure:
    """Draw one search.

    Parameters
    ----------
    entries : sequence of SearchInfo
        What the progress callback was told, as in one of :attr:`NodeLog.searches`.
    variables : sequence of str
        What each variable of the program is called; lines of the source are left out.
    title : str

    Raises
    ------
    ArgumentError
        No entries, or entries of a search that does not tell its nodes.
    """
    records = [entry.node for entry in entries if entry.node is not None]
    if not records or len(records) < len(entries):
        raise ArgumentError("the log has no nodes to draw: a branch and bound writes them, a search by HiGHS does not")
    drawn = places(records)
    axes = _axes(drawn)
    labelled = len(records) <= MOST_LABELS
    for place in drawn:
        _draw_edge(axes, place, drawn, variables, labelled=labelled)
    for fate, (marker, colour) in _LOOKS.items():
        some = [p for p in drawn if p.record is not None and p.record.fate is fate]
        _draw_marks(axes, some, marker, colour, f"{fate.value} ({len(some)})")
    _draw_marks(axes, [p for p in drawn if p.record is None], "o", "white", _OPEN)
    _draw_best(axes, entries, {p.record.number: p for p in drawn if p.record is not None})
    if labelled:
        _draw_bounds(axes, drawn)
    _finish(axes, entries[-1], title)
    return axes.figure  # type: ignore[return-value]


def places(records: Sequence[NodeRecord]) -> tuple[Place, ...]:
    """Lay the tree out, the half with the value 0 on the left.

    Returns
    -------
    tuple of Place
        Those of the records in their order, then those of halves that were not visited; `parent` is an index into it,
        -1 for the root.
    """
    index = {record.number: i for i, record in enumerate(records)}
    halves: dict[int, dict[float, int]] = {i: {} for i in range(len(records))}
    missing: list[tuple[int, float]] = []
    for i, record in enumerate(records):
        if record.parent:
            halves[index[record.parent]][record.value] = i
    for i, record in enumerate(records):
        if record.fate is NodeFate.SPLIT:
            for value in (0.0, 1.0):
                if value not in halves[i]:
                    halves[i][value] = len(records) + len(missing)
                    missing.append((i, value))
    across = _spread(halves, len(records) + len(missing))
    parents = [index[r.parent] if r.parent else -1 for r in records] + [parent for parent, _ in missing]
    levels = _levels(parents)
    shown = (*records, *([None] * len(missing)))
    return tuple(Place(across[i], levels[i], parents[i], shown[i]) for i in range(len(parents)))


def _spread(halves: Mapping[int, Mapping[float, int]], count: int) -> list[float]:
    """Leaves from left to right at whole numbers, parents in the middle of their halves."""
    across, leaves = [0.0] * count, 0
    stack = [(0, False)]
    while stack:
        i, is_done = stack.pop()
        below = [half for _, half in sorted(halves.get(i, {}).items())]
        if is_done:
            across[i] = sum(across[half] for half in below) / len(below)
        elif below:
            stack += [(i, True), *((half, False) for half in reversed(below))]
        else:
            across[i], leaves = float(leaves), leaves + 1
    return across


def _levels(parents: Sequence[int]) -> list[int]:
    """Level of each node; a parent stands before its halves."""
    levels: list[int] = []
    for parent in parents:
        levels.append(0 if parent < 0 else levels[parent] + 1)
    return levels


def _axes(drawn: Sequence[Place]) -> Axes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    width = min(24.0, max(7.0, 1.0 + max(p.across for p in drawn)))
    height = min(20.0, max(3.5, 1.6 + 0.75 * max(p.level for p in drawn)))
    figure = Figure(figsize=(width, height), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()


def _draw_edge(axes: Axes, place: Place, drawn: Sequence[Place], variables: Sequence[str], *, labelled: bool) -> None:
    """The line from the parent, with the binary that was fixed."""
    if place.parent < 0:
        return
    above = drawn[place.parent]
    style = "-" if place.record is not None else ":"
    axes.plot([above.across, place.across], [-above.level, -place.level], style, color=MUTED, linewidth=0.8, zorder=1)
    if labelled and place.record is not None:
        name = variables[place.record.variable].partition(" (line")[0]
        share = 0.55 if place.record.value else 0.3  # of the way, so that the words of both halves keep clear
        at = above.across + share * (place.across - above.across), -above.level - share
        axes.text(*at, f"{name} = {place.record.value:g}", fontsize=6, color=MUTED, ha="center", va="center",
                  bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6}, zorder=2)  # fmt: skip


def _draw_marks(axes: Axes, some: Sequence[Place], marker: str, colour: str, label: str) -> None:
    if some:
        axes.scatter([p.across for p in some], [-p.level for p in some], marker=marker, color=colour, s=46, zorder=3,
                     edgecolors="white" if colour != "white" else MUTED, linewidths=0.8, label=label)  # fmt: skip


def _draw_best(axes: Axes, entries: Sequence[SearchInfo], at: Mapping[int, Place]) -> None:
    """Rings around the nodes at which the search found a better plan."""
    best, found = inf, []
    for entry in entries:
        if entry.objective < best and entry.node is not None:
            best = entry.objective
            found.append(at[entry.node.number])
    if found:
        axes.scatter([p.across for p in found], [-p.level for p in found], s=150, facecolors="none", zorder=2,
                     edgecolors="black", linewidths=1.2, label=f"{_BEST} ({len(found)})")  # fmt: skip


def _draw_bounds(axes: Axes, drawn: Sequence[Place]) -> None:
    """The number of each node and its certified bound, on the side where no edge comes down."""
    for place in drawn:
        if place.record is not None:
            bound = f"\n{place.record.bound:.5g}" if isfinite(place.record.bound) else ""
            left = place.parent >= 0 and place.across < drawn[place.parent].across
            shift, side = (-7, "right") if left else (7, "left")
            axes.annotate(f"{place.record.number}{bound}", (place.across, -place.level), xytext=(shift, 3),
                          textcoords="offset points", fontsize=6, va="bottom", ha=side)  # fmt: skip


def _finish(axes: Axes, last: SearchInfo, title: str) -> None:
    axes.margins(0.08, 0.1)
    axes.set_axis_off()
    plan = f"best plan {last.objective:.6g}, bound {last.bound:.6g}" if isfinite(last.objective) else "no plan"
    head = f"{title}: " if title else ""
    work = f"{counted(last.nodes, 'node')}, {counted(last.qps, 'quadratic program')}"
    axes.set_title(
        f"{head}{work}, at the last node {plan}; numbers: order, and certified bound below",
        fontsize=8, loc="left",
    )  # fmt: skip
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=6, frameon=False, fontsize=7)
