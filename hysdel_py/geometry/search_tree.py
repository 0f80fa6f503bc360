"""A binary tree of hyperplane tests in flat arrays: finding the region of a point at the cost of the tree's depth.

The tests of a tree are the thresholds of a system or the boundaries of its regions (P. Tøndel, T. A. Johansen and A.
Bemporad, "Evaluation of piecewise affine control via binary search tree", Automatica 39, 2003).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["NOWHERE", "Place", "SearchTree", "SearchTreeBuilder", "Slot", "leaf_code"]

NOWHERE = -1
"""Child of a test where no region lies."""


def leaf_code(leaf: int) -> int:
    """How a leaf is written among the children."""
    return -2 - leaf


@dataclass(frozen=True, slots=True)
class Place:
    """Where a walk ended.

    Attributes
    ----------
    leaf : int
        Number of the leaf, or -1.
    test : int
        The last test, -1 in a tree without tests.
    in_gap : bool
        Whether it ended between the two sides of the last test.
    """

    leaf: int
    test: int
    in_gap: bool = False


@dataclass(frozen=True, eq=False)
class SearchTree:
    """Tests ``n w + c <= 0`` (first child) against ``n w + c >= gap`` (second child).

    Attributes
    ----------
    normals : array of shape (k, n)
    offsets, gaps : arrays of shape (k,)
    children : array of shape (k, 2)
        Number of the next test, NOWHERE, or the code of a leaf.
    root : int
        A test or the code of a leaf.
    """

    normals: NDArray[np.float64]
    offsets: NDArray[np.float64]
    gaps: NDArray[np.float64]
    children: NDArray[np.int64]
    root: int

    def __post_init__(self) -> None:
        for array in (self.normals, self.offsets, self.gaps, self.children):
            array.setflags(write=False)

    @property
    def size(self) -> int:
        """Number of tests."""
        return len(self.offsets)

    @cached_property
    def depth(self) -> int:
        """Greatest number of tests on the way to a leaf."""
        deepest, pending = 0, [(self.root, 0)]
        while pending:
            node, above = pending.pop()
            deepest = max(deepest, above)
            if node >= 0:
                pending += [(child, above + 1) for child in self._lists[3][node]]
        return deepest

    @cached_property
    def _lists(self) -> tuple[Sequence[NDArray[np.float64]], list[float], list[float], list[list[int]]]:
        """The arrays as lists, whose entries Python reaches faster."""
        return list(self.normals), self.offsets.tolist(), self.gaps.tolist(), self.children.tolist()

    def locate(self, w: ArrayLike, *, absolute: float = 0.0, relative: float = 0.0, nearest: bool = False) -> Place:
        """Walk to the leaf of a point.

        Parameters
        ----------
        w : array_like of shape (n,)
        absolute, relative : float
            By how much a side may be missed, also relative to the sizes of the terms of its test.
        nearest : bool
            Whether a point in a gap takes the side that is nearer.
        """
        point = np.asarray(w, dtype=float)
        size = np.abs(point)
        normals, offsets, gaps, children = self._lists
        node, test = self.root, -1
        while node >= 0:
            test, normal, offset = node, normals[node], offsets[node]
            value = float(normal @ point) + offset
            slack = absolute + relative * (float(np.abs(normal) @ size) + abs(offset)) if relative else absolute
            if value <= slack:
                side = 0
            elif value >= gaps[node] - slack:
                side = 1
            elif nearest:
                side = int(value > gaps[node] / 2.0)
            else:
                return Place(-1, test, in_gap=True)
            node = children[node][side]
        return Place(-2 - node if node != NOWHERE else -1, test)


@dataclass(slots=True)
class _Node:
    normal: NDArray[np.float64]
    offset: float
    gap: float
    children: list[tuple[str, int]]


Slot = tuple[int, int] | None
"""Where something is to be hung: number and side of a test; None is the root."""


class SearchTreeBuilder:
    """Grows a tree from its root: each call fills a slot that an earlier one has opened.

    Ends are leaves or dead ends; dead ends are numbered behind the leaves.
    """

    def __init__(self, dimension: int) -> None:
        self._dimension = dimension
        self._nodes: list[_Node] = []
        self._root: tuple[str, int] = ("none", 0)
        self.leaves = 0
        self.dead_ends = 0

    def test(self, slot: Slot, normal: NDArray[np.float64], offset: float, gap: float) -> tuple[Slot, Slot]:
        """Hang a test; returns the slots of its two sides."""
        number = len(self._nodes)
        self._hang(slot, ("test", number))
        self._nodes.append(_Node(normal, offset, gap, [("none", 0), ("none", 0)]))
        return (number, 0), (number, 1)

    def leaf(self, slot: Slot) -> None:
        """Hang the next leaf."""
        self._hang(slot, ("leaf", self.leaves))
        self.leaves += 1

    def dead_end(self, slot: Slot) -> None:
        """Hang the next dead end."""
        self._hang(slot, ("dead", self.dead_ends))
        self.dead_ends += 1

    def _hang(self, slot: Slot, child: tuple[str, int]) -> None:
        if slot is None:
            self._root = child
        else:
            self._nodes[slot[0]].children[slot[1]] = child

    def build(self) -> SearchTree:
        """The tree."""
        normals = np.array([node.normal for node in self._nodes]).reshape(len(self._nodes), self._dimension)
        offsets = np.array([node.offset for node in self._nodes], dtype=float)
        gaps = np.array([node.gap for node in self._nodes], dtype=float)
        children = [[self._code(child) for child in node.children] for node in self._nodes]
        table = np.array(children, dtype=np.int64).reshape(-1, 2)
        return SearchTree(normals, offsets, gaps, table, self._code(self._root))

    def _code(self, child: tuple[str, int]) -> int:
        kind, number = child
        match kind:
            case "test":
                return number
            case "leaf":
                return leaf_code(number)
            case "dead":
                return leaf_code(self.leaves + number)
            case _:
                return NOWHERE
