"""A balanced search tree over the regions of an explicit law.

Each test is the hyperplane of a facet that splits the regions left over most evenly (P. Tøndel, T. A. Johansen and
A. Bemporad, "Evaluation of piecewise affine control via binary search tree", Automatica 39, 2003). A region lies on
one side of a hyperplane or on both; the second is decided by nearest-point problems.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.explicit_law import Array, ExplicitLaw, Vector
from hysdel_py.geometry.search_tree import SearchTree, SearchTreeBuilder, Slot
from hysdel_py.optimize.parametric.cover import point_inside
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["LawTree", "build_tree", "same_moves"]

_CANDIDATES = 24
"""Hyperplanes examined at a node, those that split the centres most evenly."""

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
    """

    tree: SearchTree
    targets: NDArray[np.int64]

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


@dataclass(slots=True)
class _Growth:
    """State of one construction."""

    law: ExplicitLaw
    groups: tuple[Hashable, ...]
    settings: MpQpSettings = field(default_factory=MpQpSettings)
    sides: dict[tuple[int, int], tuple[bool, bool]] = field(default_factory=dict)

    def grow(self) -> LawTree:
        builder = SearchTreeBuilder(self.law.p)
        normals, offsets = _hyperplanes(self.law)
        centres = np.array([self._centre(region) for region in range(self.law.count)]).reshape(-1, self.law.p)
        values = normals @ centres.T + offsets[:, None]
        targets: list[int] = []
        pending: list[tuple[Slot, list[int], frozenset[int]]] = [(None, list(range(self.law.count)), frozenset())]
        while pending:
            slot, regions, used = pending.pop()
            if not regions:
                continue
            best = None if self._alike(regions) else self._best(regions, used, normals, offsets, values)
            if best is None:
                builder.leaf(slot)
                targets.append(regions[0])
                continue
            number, below, above = best
            first, second = builder.test(slot, normals[number], float(offsets[number]), 0.0)
            pending += [(second, above, used | {number}), (first, below, used | {number})]
        return LawTree(builder.build(), np.array(targets, dtype=np.int64))

    def _alike(self, regions: list[int]) -> bool:
        return len({self.groups[region] for region in regions}) == 1

    def _centre(self, region: int) -> Vector:
        A, b = self.law.rows(region)
        for margin in self.settings.margins:
            point = point_inside((A, b), float(margin), self.settings)
            if point is not None:
                return point
        return np.asarray(np.zeros(self.law.p))

    def _best(
        self, regions: list[int], used: frozenset[int], normals: Array, offsets: Vector, values: Array
    ) -> tuple[int, list[int], list[int]] | None:
        """The test with the smaller larger half; None if no test separates anything."""
        here = values[:, regions]
        below = (here <= 0).sum(axis=1)
        order = np.argsort(np.maximum(below, len(regions) - below), kind="stable")
        best: tuple[int, int, list[int], list[int]] | None = None
        tried = 0
        for number in order.tolist():
            if number in used or tried == _CANDIDATES:
                continue
            tried += best is not None
            halves = self._halves(number, regions, normals, offsets, values)
            cost = max(len(halves[0]), len(halves[1]))
            if cost < len(regions) and (best is None or cost < best[0]):
                best = (cost, number, *halves)
        return None if best is None else best[1:]

    def _halves(
        self, number: int, regions: list[int], normals: Array, offsets: Vector, values: Array
    ) -> tuple[list[int], list[int]]:
        below, above = [], []
        for region in regions:
            low, high = self._sides(number, region, normals[number], offsets[number], values[number, region])
            if low:
                below.append(region)
            if high:
                above.append(region)
        return below, above

    def _sides(self, number: int, region: int, normal: Vector, offset: float, centre: float) -> tuple[bool, bool]:
        """Whether a region has points on either side of a hyperplane; one side is that of its centre."""
        key = number, region
        if key not in self.sides:
            sign = 1.0 if centre <= 0 else -1.0
            A, b = self.law.rows(region)
            rows = np.vstack([A, -sign * normal]), np.append(b, sign * offset - _THIN)
            other = point_inside(rows, 0.0, self.settings) is not None
            self.sides[key] = (centre <= 0 or other, centre > 0 or other)
        return self.sides[key]


def _hyperplanes(law: ExplicitLaw) -> tuple[Array, Vector]:
    """Distinct hyperplanes of all facets, ``normal x + offset``, each in one orientation."""
    lead = np.array([row[np.flatnonzero(np.abs(row) > 1e-9)[0]] for row in law.A])
    sign = np.where(lead < 0, -1.0, 1.0)
    table = np.column_stack([law.A, -law.b]) * sign[:, None]
    _, first = np.unique(np.round(table, 8) + 0.0, axis=0, return_index=True)
    chosen = table[np.sort(first)]
    return chosen[:, :-1].copy(), chosen[:, -1].copy()
