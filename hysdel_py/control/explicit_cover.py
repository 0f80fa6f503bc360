"""Where a search tree needs no further test: leaves whose cell holds nothing but regions, within an outer hull.

A tree ends in some leaf at every point, also outside the map. The hull is the set that satisfies all rows of regions
that no region crosses. A leaf whose cell within the hull is covered by its regions is closed: there the hull alone
decides whether a point belongs to the map. At other leaves, of maps with holes or notches, the regions must be asked.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_planes import Planes, Rows
from hysdel_py.control.explicit_tree import LawTree
from hysdel_py.optimize.parametric.cover import point_inside, uncovered_point
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Cover", "cover_of"]

_ROOM = 1e-7
"""What a leaf leaves out counts if it holds a ball of this radius."""

_MOST_MEMBERS = 64
"""Leaves with more regions are not examined, and stay open."""


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


def cover_of(law: ExplicitLaw, planes: Planes, tree: LawTree) -> Cover:
    """Hull and open leaves of a map.

    Parameters
    ----------
    law : ExplicitLaw
    planes : Planes
        Those of the law.
    tree : LawTree
        A search tree of the law.
    """
    settings = MpQpSettings()
    hull = _hull(law, planes, settings)
    rows = law.A[hull], law.b[hull]
    is_open = np.zeros(len(tree.members), dtype=bool)
    for leaf, path in _paths(tree, law.p):
        cell = np.vstack([rows[0], path[0]]), np.concatenate([rows[1], path[1]])
        is_open[leaf] = _leaves_something(law, cell, tree.members[leaf], settings)
    return Cover(hull, is_open)


def _hull(law: ExplicitLaw, planes: Planes, settings: MpQpSettings) -> NDArray[np.int64]:
    """Rows that no region crosses; most fall at the inner point of some region."""
    _, first = np.unique(planes.numbers * 2 + (planes.signs > 0), return_index=True)
    rows = np.sort(first)
    centres = [point_inside(law.rows(region), 0.0, settings) for region in range(law.count)]
    inner = np.array([centre for centre in centres if centre is not None]).reshape(-1, law.p)
    rows = rows[np.all(law.A[rows] @ inner.T <= law.b[rows, None] + _ROOM, axis=1)]
    kept = [row for row in rows.tolist() if not any(_crosses(law, row, r, settings) for r in range(law.count))]
    return np.array(kept, dtype=np.int64)


def _crosses(law: ExplicitLaw, row: int, region: int, settings: MpQpSettings) -> bool:
    if law.starts[region] <= row < law.starts[region + 1]:
        return False
    A, b = law.rows(region)
    beyond = np.vstack([A, -law.A[row]]), np.append(b, -law.b[row] - _ROOM)
    return point_inside(beyond, 0.0, settings) is not None


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


def _leaves_something(law: ExplicitLaw, cell: Rows, members: tuple[int, ...], settings: MpQpSettings) -> bool:
    if len(members) > _MOST_MEMBERS:
        return True
    return uncovered_point(cell, [law.rows(region) for region in members], _ROOM, settings) is not None
