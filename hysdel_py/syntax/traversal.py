"""Bottom-up evaluation of trees without recursion, so that depth is limited by memory alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

__all__ = ["fold"]

N = TypeVar("N")
R = TypeVar("R")


def fold(root: N, children: Callable[[N], Sequence[N]], build: Callable[[N, list[R]], R]) -> R:
    """Combine a tree from its leaves up.

    Parameters
    ----------
    root : node
    children : callable
        Direct sub-nodes of a node, left to right.
    build : callable
        Result of a node from the node and the results of its children; called in post-order.
    """
    pending: list[tuple[N, int]] = [(root, -1)]
    results: list[R] = []
    while pending:
        node, arity = pending.pop()
        if arity < 0:
            below = children(node)
            pending.append((node, len(below)))
            pending.extend((child, -1) for child in reversed(below))
        else:
            split = len(results) - arity
            arguments = results[split:]
            del results[split:]
            results.append(build(node, arguments))
    return results[0]
