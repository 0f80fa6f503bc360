"""A balanced search tree over the regions of an explicit law.

Each test is the hyperplane of a facet that splits the regions left over well (P. Tøndel, T. A. Johansen and A.
Bemporad, "Evaluation of piecewise affine control via binary search tree", Automatica 39, 2003). A region lies on one
side of a hyperplane or on both. Samples of the regions choose the hyperplanes that are examined and prove sides; what
they leave open is decided by nearest-point problems. A limit on these problems and one on the tests end the
growth; the leaves that are left then hold several regions.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.explicit_law import Array, ExplicitLaw
from hysdel_py.control.explicit_planes import Rows, planes_of
from hysdel_py.control.explicit_sides import Ints, RegionStack
from hysdel_py.geometry.search_tree import SearchTree, SearchTreeBuilder, Slot
from hysdel_py.optimize.parametric.splits import best_split

__all__ = ["LawTree", "TreeLimits", "build_tree", "same_moves"]

_NEAREST = 400
"""Hyperplanes of facets nearest to the middle of the regions, among which those that split best are looked for."""

_CANDIDATES = 24
"""Hyperplanes whose sides are guessed from samples, those that split the regions most evenly."""

_EXAMINED = 6
"""The best of them, for which sides are decided within the cell of the node."""

_THIN = 1e-7
"""A region is on a side of a hyperplane if it holds points at this distance from it."""


_Open = tuple[int, int, Slot, Ints, Rows]
"""Key and number that order the leaves still to be split; place, regions and cell."""


@dataclass(frozen=True, slots=True)
class TreeLimits:
    """Where the growth of a tree ends; the same on every machine.

    Attributes
    ----------
    work : int
        Nearest-point problems that are solved.
    tests : int, optional
        Tests of the tree; by default as many as the law has rows, but 64 at least.
    entries : int, optional
        Regions of all leaves together; by default three for each row, but 192 at least.
    """

    work: int = 500_000
    tests: int | None = None
    entries: int | None = None


@dataclass(frozen=True, eq=False, slots=True)
class LawTree:
    """A search tree whose leaves name regions.

    Attributes
    ----------
    tree : SearchTree
    targets : int array of shape (leaves,)
        Region of each leaf.
    members : tuple of tuple of int
        All regions that have points at each leaf; the target is the first of them.
    is_cut : bool
        Whether a limit ended the growth, so that leaves may hold more than one group.
    """

    tree: SearchTree
    targets: NDArray[np.int64]
    members: tuple[tuple[int, ...], ...]
    is_cut: bool = False

    def locate(self, zeta: ArrayLike) -> int:
        """Region at the leaf of a point, -1 without a leaf; where no region holds the point, some region."""
        leaf = self.tree.locate(zeta, nearest=True).leaf
        return int(self.targets[leaf]) if leaf >= 0 else -1


def build_tree(
    law: ExplicitLaw,
    groups: tuple[Hashable, ...] | None = None,
    limits: TreeLimits | None = None,
    stack: RegionStack | None = None,
) -> LawTree:
    """Search tree of a law.

    Parameters
    ----------
    law : ExplicitLaw
    groups : tuple of hashable, optional
        One entry for each region; a leaf holds regions of one group. By default every region is its own group; with
        :func:`same_moves` a leaf holds one law of the moves, and the tree is smaller.
    limits : TreeLimits, optional
    stack : RegionStack, optional
        That of the law, if it has been made before.
    """
    every = groups or tuple(range(law.count))
    return _Growth(law, every, limits or TreeLimits(), stack or RegionStack(law)).grow()


def same_moves(law: ExplicitLaw, digits: int = 9) -> tuple[Hashable, ...]:
    """For each region a key that regions with the same law of the moves share."""
    table = np.concatenate([law.K[:, : law.moves].reshape(law.count, -1), law.k[:, : law.moves]], axis=1)
    scale = np.maximum(1.0, np.abs(table).max(axis=0, initial=0.0))
    return tuple((np.round(row / scale, digits) + 0.0).tobytes() for row in table)


class _Growth:
    """State of one construction."""

    def __init__(self, law: ExplicitLaw, groups: tuple[Hashable, ...], limits: TreeLimits, stack: RegionStack) -> None:
        self.law, self.stack = law, stack
        self.planes = planes_of(law)
        numbers = {group: number for number, group in enumerate(dict.fromkeys(groups))}
        self.groups = np.array([numbers[group] for group in groups], dtype=np.int64)
        self.facets = [np.unique(self.planes.numbers[a:b]) for a, b in pairwise(law.starts.tolist())]
        self.most_work = stack.work + limits.work
        rows = max(64, len(law.b))
        self.most_tests = rows if limits.tests is None else limits.tests
        self.most_entries = 3 * rows if limits.entries is None else limits.entries

    def grow(self) -> LawTree:
        """Split the fullest leaf until none holds more than one group, nothing separates, or a limit is reached."""
        builder, is_cut = SearchTreeBuilder(self.law.p), False
        members: list[tuple[int, ...]] = []
        every = np.arange(self.law.count)
        pending: list[_Open] = [(0, 0, None, every, (np.zeros((0, self.law.p)), np.zeros(0)))] if len(every) else []
        tests, entered, entries = 0, 0, len(every)
        while pending:
            _, _, slot, regions, path = heappop(pending)
            is_alike = self._kinds(regions) == 1
            is_over = tests >= self.most_tests or entries >= self.most_entries or self.stack.work >= self.most_work
            best = None if is_over or is_alike else self._best(regions, path)
            if best is None:
                is_cut |= is_over and not is_alike
                builder.leaf(slot)
                members.append(tuple(regions.tolist()))
                continue
            number, halves = best
            tests, entries = tests + 1, entries + sum(map(len, halves)) - len(regions)
            slots = builder.test(slot, self.planes.normals[number], float(self.planes.offsets[number]), 0.0)
            for half, side, sign in zip(halves, slots, (-1.0, 1.0), strict=True):
                entered += 1
                if len(half):
                    heappush(pending, (-len(half), entered, side, half, self.planes.side(path, number, sign)))
        targets = np.array([regions[0] for regions in members], dtype=np.int64)
        return LawTree(builder.build(), targets, tuple(members), is_cut)

    def _kinds(self, regions: Ints) -> int:
        return len(np.unique(self.groups[regions]))

    def _best(self, regions: Ints, path: Rows) -> tuple[int, tuple[Ints, Ints]] | None:
        """The test of least cost, with the regions on its two sides; None if no test separates anything."""
        stack, s = self.stack, self.stack.settings
        inside = stack.inside(regions, path, _THIN)
        numbers = self._candidates(regions, stack.representatives(regions, inside))
        place, below, above, work = best_split(
            stack.A, stack.b, stack.starts, stack.centres, stack.points, self.groups, regions, inside, *path,
            self.planes.normals[numbers], self.planes.offsets[numbers], _CANDIDATES, _EXAMINED, _THIN, s.violation,
            s.angle,
        )  # fmt: skip
        stack.work += int(work)
        return None if place < 0 else (int(numbers[place]), (regions[below], regions[above]))

    def _candidates(self, regions: Ints, middle: Array) -> Ints:
        """Hyperplanes of facets of some regions, those first that split the regions most evenly."""
        numbers = np.unique(np.concatenate([self.facets[region] for region in regions]))
        normals, offsets = self.planes.normals, self.planes.offsets
        if len(numbers) > _NEAREST:
            distance = np.abs(normals[numbers] @ middle.mean(axis=0) + offsets[numbers])
            numbers = numbers[np.sort(np.argsort(distance, kind="stable")[:_NEAREST])]
        below = (normals[numbers] @ middle.T <= -offsets[numbers, None]).sum(axis=1)
        return np.asarray(numbers[np.argsort(np.maximum(below, len(regions) - below), kind="stable")])
