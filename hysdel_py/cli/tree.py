"""Draw the searches of a log for a command."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from hysdel_py.optimize.node_log import NodeLog

__all__ = ["save_tree"]


def save_tree(log: NodeLog, variables: Sequence[str], path: str | Path) -> None:
    """Draw the search with the most nodes, the first of several; say so on the error stream where there is none."""
    from hysdel_py.plotting.tree import plot_tree

    searches = [entries for entries in log.searches if all(entry.node is not None for entry in entries)]
    if not searches:
        print(
            "--tree: no branch and bound looked at a node (HiGHS or propagation settled all): no picture",
            file=sys.stderr,
        )
        return
    largest = max(range(len(searches)), key=lambda i: len(searches[i]))
    title = f"search {largest + 1} of {len(searches)}" if len(searches) > 1 else ""
    plot_tree(searches[largest], variables, title).savefig(path)
