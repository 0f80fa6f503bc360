"""A balanced search tree over the regions of an explicit law.

Each test is the hyperplane of a facet that splits the regions left over most evenly (P. Tøndel, T. A. Johansen and
A. Bemporad, "Evaluation of piecewise affine control via binary search tree", Automatica 39, 2003). A region lies on
one side of a hyperplane or on both; the second is decided by nearest-point problems.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.explicit_law import ExplicitLaw, Vector
from hysdel_py.control.explicit_planes import Rows, planes_of
from hysdel_py.geometry.search_tree import SearchTree, SearchTreeBuilder, Slot
from hysdel_py.optimize.parametric.cover import point_inside
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["LawTree", "build_tree", "same_moves"]

Halves = tuple[list[int], list[int]]
Cost = tuple[int, int, int]

_CANDIDATES = 24
"""Hyperplanes examined at a node, those that split the centres most evenly."""

_EXAMINED = 6
"""The best of them, for which the regions are cut with the cell of the node."""

_THIN = 1e-7
"""A region is on a side of a hyperplane if it holds points at this distance from it."""


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
    """

    tree: SearchTree
    targets: NDArray[np.int64]
    members: tuple[tuple[int, ...], ...]

    def locate(self, zeta: ArrayLike) -> int:
        """Region at the leaf of a point, -1 without a leaf; where no region holds the point, some region."""
        leaf = self.tree.locate(zeta, nearest=True).leaf
        return int(self.targets[leaf]) if leaf >= 0 else -1


def build_tree(law: ExplicitLaw, groups: tuple[Hashable, ...] | None = None) -> LawTree:
    """Search tree of a law.

    Parameters
    ----------
    law : ExplicitLaw
    groups : tuple of hashable, optional
        One entry for each region; a leaf holds regions of one group. By default every region is its own group; with
        :func:`same_moves` a leaf holds one law of the moves, and the tree is smaller.
    """
    return _Growth(law, groups or tuple(range(law.count))).grow()


def same_moves(law: ExplicitLaw, digits: int = 9) -> tuple[Hashable, ...]:
    """For each region a key that regions with the same law of the moves share."""
    table = np.concatenate([law.K[:, : law.moves].reshape(law.count, -1), law.k[:, : law.moves]], axis=1)
    scale = np.maximum(1.0, np.abs(table).max(axis=0, initial=0.0))
    return tuple((np.round(row / scale, digits) + 0.0).tobytes() for row in table)


class _Growth:
    """State of one construction."""

    def __init__(self, law: ExplicitLaw, groups: tuple[Hashable, ...]) -> None:
        self.law = law
        self.groups = groups
        self.settings = MpQpSettings()
        self.planes = planes_of(law)
        self.centres = np.array([self._centre(region) for region in range(law.count)]).reshape(-1, law.p)
        self.values = self.planes.normals @ self.centres.T + self.planes.offsets[:, None]
        self.facets = [self.planes.numbers[a:b] for a, b in pairwise(law.starts.tolist())]
        self.sides: dict[tuple[int, int], tuple[bool, bool]] = {}

    def grow(self) -> LawTree:
        planes, builder = self.planes, SearchTreeBuilder(self.law.p)
        members: list[tuple[int, ...]] = []
        whole = np.zeros((0, self.law.p)), np.zeros(0)
        pending: list[tuple[Slot, list[int], Rows]] = [(None, list(range(self.law.count)), whole)]
        while pending:
            slot, regions, path = pending.pop()
            if not regions:
                continue
            best = None if self._alike(regions) else self._best(regions, path)
            if best is None:
                builder.leaf(slot)
                members.append(tuple(regions))
                continue
            number, (below, above) = best
            first, second = builder.test(slot, planes.normals[number], float(planes.offsets[number]), 0.0)
            pending += [
                (second, above, planes.side(path, number, 1.0)),
                (first, below, planes.side(path, number, -1.0)),
            ]
        targets = np.array([regions[0] for regions in members], dtype=np.int64)
        return LawTree(builder.build(), targets, tuple(members))

    def _alike(self, regions: list[int]) -> bool:
        return self._kinds(regions) == 1

    def _kinds(self, regions: list[int]) -> int:
        return len({self.groups[region] for region in regions})

    def _centre(self, region: int) -> Vector:
        A, b = self.law.rows(region)
        for margin in self.settings.margins:
            point = point_inside((A, b), float(margin), self.settings)
            if point is not None:
                return point
        return np.asarray(np.zeros(self.law.p))

    def _best(self, regions: list[int], path: Rows) -> tuple[int, Halves] | None:
        """The test that leaves the fewest groups on its fuller side; None if no test separates anything."""
        numbers = self._candidates(regions)
        found = self._separating(numbers[:_CANDIDATES], regions, path, _EXAMINED)
        found = found or self._separating(numbers[_CANDIDATES:], regions, path, 1)
        return min(found)[1:] if found else None

    def _candidates(self, regions: list[int]) -> list[int]:
        """Hyperplanes of facets of some regions, those first that split the centres most evenly."""
        numbers = np.unique(np.concatenate([self.facets[region] for region in regions]))
        below = (self.values[numbers][:, regions] <= 0).sum(axis=1)
        order = np.argsort(np.maximum(below, len(regions) - below), kind="stable")
        return list(numbers[order].tolist())

    def _separating(
        self, numbers: list[int], regions: list[int], path: Rows, most: int
    ) -> list[tuple[Cost, int, Halves]]:
        """Tests that leave fewer regions on both sides, at most so many, the promising ones first."""
        halves = [(number, self._halves(number, regions)) for number in numbers]
        found: list[tuple[Cost, int, Halves]] = []
        for _, number, pair in sorted((self._cost(pair), number, pair) for number, pair in halves):
            exact = self._inside(number, pair, path)
            if max(map(len, exact)) < len(regions):
                found.append((self._cost(exact), number, exact))
            if len(found) == most:
                break
        return found

    def _cost(self, halves: Halves) -> Cost:
        kinds = [self._kinds(half) for half in halves]
        return max(kinds), sum(kinds), sum(map(len, halves))

    def _halves(self, number: int, regions: list[int]) -> Halves:
        """Regions with points on either side of a hyperplane, wherever it is."""
        sides = [(region, self._sides(number, region)) for region in regions]
        return [region for region, (low, _) in sides if low], [region for region, (_, high) in sides if high]

    def _sides(self, number: int, region: int) -> tuple[bool, bool]:
        """Whether a region has points on either side of a hyperplane; one side is that of its centre."""
        key = number, region
        if key not in self.sides:
            is_below = bool(self.values[number, region] <= 0)
            rows = self.planes.side(self.law.rows(region), number, 1.0 if is_below else -1.0, _THIN)
            other = self._reaches(region, rows)
            self.sides[key] = (is_below or other, not is_below or other)
        return self.sides[key]

    def _inside(self, number: int, halves: Halves, path: Rows) -> Halves:
        """The halves without the regions whose points on that side lie outside the cell of the node."""
        both = set(halves[0]) & set(halves[1])
        cells = [self.planes.side(path, number, sign, _THIN) for sign in (-1.0, 1.0)]
        below, above = (
            [region for region in half if region not in both or self._meets(region, cell)]
            for half, cell in zip(halves, cells, strict=True)
        )
        return below, above

    def _meets(self, region: int, cell: Rows) -> bool:
        A, b = self.law.rows(region)
        return self._reaches(region, (np.vstack([A, cell[0]]), np.concatenate([b, cell[1]])))

    def _reaches(self, region: int, rows: Rows) -> bool:
        return point_inside(rows, 0.0, self.settings, self.centres[region]) is not None
