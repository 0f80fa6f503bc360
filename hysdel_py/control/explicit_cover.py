"""Where a search tree needs no further test: leaves whose cell holds nothing but regions, within an outer hull.

A tree ends in some leaf at every point, also outside the map. The hull is the set that satisfies all rows of regions
that no region crosses. A way from a region to a point that no region holds leaves the map through a facet, and inside
the hull through one that no region beyond it covers. So a leaf whose regions have no such open facet is closed: there
the hull alone decides whether a point belongs to the map. Other leaves, of maps with holes or notches, are examined
one by one; where a part of the cell is left out, the regions must be asked.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_planes import Planes, Rows
from hysdel_py.control.explicit_sides import Flags, Ints, RegionStack
from hysdel_py.control.explicit_tree import LawTree
from hysdel_py.optimize.parametric.cover import uncovered_point
from hysdel_py.optimize.parametric.stack import covered_facets

__all__ = ["Cover", "cover_of"]

_ROOM = 1e-7
"""What a leaf leaves out counts if it holds a ball of this radius; what a facet leaves open, in the facet."""

_MOST_MEMBERS = 16
"""Leaves with more regions are not examined, and stay open."""

_MOST_LEAVES = 1000
"""So many leaves are examined at most; others with open facets stay open."""

_MOST_PARTS = 100
"""Parts of one facet that are looked at; beyond that it counts as open."""


@dataclass(frozen=True, eq=False, slots=True)
class Cover:
    """The hull of a map and the leaves that are open.

    Attributes
    ----------
    hull : int array
        Rows of the law that every region keeps, one for each hyperplane.
    is_open : Boolean array of shape (leaves,)
    """

    hull: NDArray[np.int64]
    is_open: NDArray[np.bool_]


def cover_of(law: ExplicitLaw, planes: Planes, tree: LawTree, stack: RegionStack | None = None) -> Cover:
    """Hull and open leaves of a map.

    Parameters
    ----------
    law : ExplicitLaw
    planes : Planes
        Those of the law.
    tree : LawTree
        A search tree of the law.
    stack : RegionStack, optional
        That of the law, if it has been made before.
    """
    stack = stack or RegionStack(law)
    hull = _hull(law, planes, stack)
    bare = _open_regions(law, planes, hull, stack)
    doubtful = [leaf for leaf, members in enumerate(tree.members) if bare[list(members)].any()]
    is_open = np.zeros(len(tree.members), dtype=bool)
    is_open[doubtful] = True
    looked_at = {leaf for leaf in doubtful if len(tree.members[leaf]) <= _MOST_MEMBERS}
    if 0 < len(looked_at) <= _MOST_LEAVES:
        for leaf, (N, h) in _paths(tree, law.p):
            if leaf in looked_at:
                cell = np.vstack([law.A[hull], N]), np.concatenate([law.b[hull], h])
                covers = [law.rows(region) for region in tree.members[leaf]]
                is_open[leaf] = uncovered_point(cell, covers, _ROOM, stack.settings) is not None
    return Cover(hull, is_open)


def _hull(law: ExplicitLaw, planes: Planes, stack: RegionStack) -> Ints:
    """Rows that no region crosses; most fall at the inner point or a sample of some region."""
    _, first = np.unique(planes.numbers * 2 + (planes.signs > 0), return_index=True)
    rows = np.sort(first)
    for points in (stack.centres, stack.points.reshape(-1, law.p)):
        rows = rows[[bool(np.all(points @ law.A[row] <= law.b[row] + _ROOM)) for row in rows.tolist()]]
    owner = np.searchsorted(law.starts, rows, side="right") - 1
    kept = [row for row, own in zip(rows.tolist(), owner.tolist(), strict=True) if not _is_crossed(row, own, stack)]
    return np.array(kept, dtype=np.int64)


def _is_crossed(row: int, owner: int, stack: RegionStack) -> bool:
    beyond: Rows = (np.negative(stack.A[row : row + 1]), np.subtract(-_ROOM, stack.b[row : row + 1]))
    return stack.any_meeting(np.delete(np.arange(len(stack.centres)), owner), beyond)


def _open_regions(law: ExplicitLaw, planes: Planes, hull: Ints, stack: RegionStack) -> Flags:
    """Regions with a facet, not one of the hull, that regions beyond it do not cover."""
    sides = planes.numbers * 2 + (planes.signs > 0)
    rows = np.flatnonzero(~np.isin(sides, sides[hull]))
    owner = np.searchsorted(law.starts, np.arange(len(law.b)), side="right") - 1
    order = np.argsort(sides, kind="stable")
    sorted_sides, opposite = sides[order], sides[rows] ^ 1
    first = np.searchsorted(sorted_sides, opposite, side="left")
    last = np.searchsorted(sorted_sides, opposite, side="right")
    places = np.concatenate([np.zeros(0, dtype=np.int64), *map(np.arange, first, last)])
    bounds = np.cumsum(np.concatenate([[0], last - first]))
    s = stack.settings
    covered = covered_facets(
        stack.A, stack.b, stack.starts, owner[rows], rows, owner[order][places], bounds, _ROOM, law.tolerance,
        _MOST_PARTS, s.violation, s.angle,
    )  # fmt: skip
    bare = np.zeros(law.count, dtype=bool)
    bare[owner[rows[~covered]]] = True
    return bare


def _paths(tree: LawTree, p: int) -> Iterator[tuple[int, Rows]]:
    """Leaves with the rows of the tests on the way to them."""
    tests = tree.tree
    pending: list[tuple[int, Rows]] = [(tests.root, (np.zeros((0, p)), np.zeros(0)))]
    while pending:
        node, (N, h) = pending.pop()
        if node < -1:
            yield -2 - node, (N, h)
        elif node >= 0:
            normal, offset = tests.normals[node], tests.offsets[node]
            first, second = tests.children[node].tolist()
            pending.append((first, (np.vstack([N, normal]), np.append(h, -offset))))
            pending.append((second, (np.vstack([N, -normal]), np.append(h, offset))))
