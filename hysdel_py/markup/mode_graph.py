"""The graph of the modes of a Pwa as SVG: modes on a circle, arrows for transitions, a ring where a mode can stay."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import cos, hypot, pi, sin

from hysdel_py.markup.charts import COLOURS
from hysdel_py.markup.elements import Markup, element

__all__ = ["Node", "graph_picture"]

_ROOM = 44.0
_BEND = 0.12
"""Height of an arc over its chord."""


@dataclass(frozen=True, slots=True)
class Node:
    """One mode.

    Attributes
    ----------
    key : int
        Number of the mode.
    title : str
        What is told about it.
    colour : int
        Number of its dynamics.
    is_flat : bool
    """

    key: int
    title: str
    colour: int
    is_flat: bool = False


def graph_picture(nodes: Sequence[Node], edges: Iterable[tuple[int, int]], label: str) -> Markup:
    """The picture.

    Parameters
    ----------
    nodes : sequence of Node
    edges : iterable of pairs of keys
    label : str
        What the picture shows, for those who do not see it.
    """
    radius = max(13.0, 9.0 + 4.0 * len(str(len(nodes))))
    reach = max(90.0, (2.6 * radius + 8.0) * len(nodes) / (2 * pi))
    middle = reach + _ROOM
    places = {node.key: _on_circle(k, len(nodes), reach, middle) for k, node in enumerate(nodes)}
    ordered = sorted(set(edges))
    arcs = [_arc(pair, places, radius) for pair in ordered if pair[0] != pair[1]]
    staying = {first for first, second in ordered if first == second}
    circles = [_circle(node, places[node.key], radius, stays=node.key in staying) for node in nodes]
    size = f"{2 * middle:.0f}"
    return element(
        "svg", element("title", label), element("defs", _head()), *arcs, *circles, viewBox=f"0 0 {size} {size}",
        role="group", aria_label=label, class_="graph", width=size,
    )  # fmt: skip


def _head() -> Markup:
    shape = element("path", d="M0 0 8 4 0 8z", class_="head")
    return element("marker", shape, id="arrow", markerWidth=8, markerHeight=8, refX=8, refY=4, orient="auto",
                   markerUnits="userSpaceOnUse")  # fmt: skip


def _on_circle(k: int, count: int, reach: float, middle: float) -> tuple[float, float]:
    angle = 2 * pi * k / count - pi / 2
    return middle + (count > 1) * reach * cos(angle), middle + (count > 1) * reach * sin(angle)


def _arc(pair: tuple[int, int], places: dict[int, tuple[float, float]], radius: float) -> Markup:
    (x0, y0), (x1, y1) = places[pair[0]], places[pair[1]]
    length = hypot(x1 - x0, y1 - y0)
    along, across = ((x1 - x0) / length, (y1 - y0) / length), (-(y1 - y0) / length, (x1 - x0) / length)
    bend = (0.5 * (x0 + x1) + _BEND * length * across[0], 0.5 * (y0 + y1) + _BEND * length * across[1])
    start = (x0 + radius * along[0], y0 + radius * along[1])
    end = _towards((x1, y1), bend, radius + 2)
    points = " ".join(f"{value:.1f}" for value in (*bend, *end))
    return element("path", d=f"M{start[0]:.1f} {start[1]:.1f}Q{points}", class_="edge", marker_end="url(#arrow)",
                   data_from=pair[0], data_to=pair[1])  # fmt: skip


def _towards(point: tuple[float, float], other: tuple[float, float], distance: float) -> tuple[float, float]:
    dx, dy = other[0] - point[0], other[1] - point[1]
    length = hypot(dx, dy) or 1.0
    return point[0] + distance * dx / length, point[1] + distance * dy / length


def _circle(node: Node, place: tuple[float, float], radius: float, *, stays: bool) -> Markup:
    x, y = (f"{value:.1f}" for value in place)
    shape = element(
        "circle", cx=x, cy=y, r=f"{radius:g}", class_=f"mode b{node.colour % COLOURS}" + " flat" * node.is_flat
    )
    ring = element("circle", cx=x, cy=y, r=f"{radius + 3.5:g}", class_="stays") if stays else None
    name = element("text", str(node.key), x=x, y=f"{place[1] + 4:.1f}", text_anchor="middle")
    return element("g", element("title", node.title), ring, shape, name, class_="node", data_mode=node.key)
