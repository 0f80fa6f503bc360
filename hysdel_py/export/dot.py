"""Graphs of modes in the DOT language of Graphviz; the same graph gives the same bytes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hysdel_py.systems.mode import Mode
from hysdel_py.systems.pwa import Pwa

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["dot_text"]


def dot_text(pwa: Pwa, graph: nx.Graph | nx.DiGraph) -> str:
    """The text of a graph whose nodes are the modes of a Pwa.

    Parameters
    ----------
    graph : networkx.Graph or networkx.DiGraph
        What :meth:`Pwa.adjacency` or :meth:`Pwa.transitions` returned.
    """
    directed = graph.is_directed()
    arrow = "->" if directed else "--"
    lines = [f"{'digraph' if directed else 'graph'} {_quoted(pwa.name)} {{", "  node [shape=box, fontsize=10];"]
    lines += [f"  {mode.index} [label={_label(mode)}];" for mode in pwa.modes]
    for first, second, data in sorted(graph.edges(data=True), key=lambda edge: edge[:2]):
        across = f" [label={_quoted(data['across'])}]" if data.get("across") else ""
        lines.append(f"  {first} {arrow} {second}{across};")
    return "\n".join([*lines, "}"]) + "\n"


def _label(mode: Mode) -> str:
    flat = " (flat)" if mode.is_flat else ""
    return _quoted("\n".join([f"{mode.index}: {mode.bits}{flat}", *mode.conditions]))


def _quoted(text: str) -> str:
    plain = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{plain}"'
