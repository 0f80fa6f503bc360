"""An explicit law as the tables that a small machine walks: hyperplanes, tests, and the distinct laws of the moves."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_cover import cover_of
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_planes import Planes, planes_of
from hysdel_py.control.explicit_sides import RegionStack
from hysdel_py.control.explicit_tree import build_tree, same_moves
from hysdel_py.errors import ArgumentError
from hysdel_py.export.law_number import Number, Scaling, scaling_of
from hysdel_py.geometry.search_tree import NOWHERE

__all__ = ["LawTable", "Method", "law_table"]

Array = NDArray[np.float64]
Ints = tuple[int, ...]


class Method(Enum):
    """How the law of a point is found."""

    AUTO = "auto"
    TREE = "tree"
    SEQUENTIAL = "sequential"

    @classmethod
    def of(cls, name: str) -> Method:
        """The method with a name.

        Raises
        ------
        ArgumentError
            There is none.
        """
        try:
            return cls(name)
        except ValueError:
            raise ArgumentError(f"method is {name!r}: auto, tree or sequential was expected") from None


@dataclass(frozen=True, eq=False, slots=True)
class LawTable:
    """Everything that the code needs; numbers are those of the scaling.

    A row is a hyperplane with a side: ``n + 1`` for ``value <= 0`` of hyperplane n, ``-(n + 1)`` for ``-value <= 0``.
    A child of a test is a test, -1 where no region lies, ``-2 - map`` where the law is known, or ``-2 - (maps + leaf)``
    at a leaf whose regions have to be tried in turn.

    Attributes
    ----------
    method : Method
    scaling : Scaling
    planes : array of shape (h, p + 1)
        Normal and offset.
    maps : array of shape (L, moves, p + 1)
        Distinct laws of the moves.
    tests : tuple of (plane, first child, second child)
    root : int
    hull : tuple of int
        Rows that hold on the whole map.
    leaves : tuple of tuple of int
        For each open leaf the positions of its regions in `regions`.
    regions : tuple of tuple of int
        Rows of the regions that may have to be tried.
    region_maps : tuple of int
        Law of each of them.
    tolerance : float
        Value up to which a row holds.
    depth : int
        Greatest number of tests, 0 without a tree.
    is_cut : bool
        Whether the growth of the tree was limited.
    """

    method: Method
    scaling: Scaling
    planes: Array
    maps: Array
    tests: tuple[Ints, ...]
    root: int
    hull: Ints
    leaves: tuple[Ints, ...]
    regions: tuple[Ints, ...]
    region_maps: Ints
    tolerance: float
    depth: int = 0
    is_cut: bool = False

    @property
    def p(self) -> int:
        """Number of parameters."""
        return int(self.planes.shape[1]) - 1

    @property
    def moves(self) -> int:
        """Number of moves."""
        return int(self.maps.shape[1])


def law_table(law: ExplicitLaw, number: Number, method: Method) -> LawTable:
    """Tables of a law for one of the methods TREE and SEQUENTIAL.

    Raises
    ------
    ArgumentError
        The law has no regions, or an unbounded domain.
    """
    if not law.count:
        raise ArgumentError("the law has no regions: there is nothing to write")
    scaling, planes = scaling_of(law, number), planes_of(law)
    chosen, kind_of = _distinct(law)
    maps = scaling.maps(law.K[chosen, : law.moves], law.k[chosen, : law.moves])
    walk = _tree(law, planes, kind_of, len(chosen)) if method is Method.TREE else _Walk(regions=tuple(range(law.count)))
    used, rows, hull = _renumbered(law, planes, walk)
    table = scaling.planes(planes.normals[used], planes.offsets[used])
    position = {plane: place for place, plane in enumerate(used)}
    return LawTable(
        method, scaling, table, maps,
        tests=tuple((position[plane], first, second) for plane, first, second in walk.tests),
        root=walk.root,
        hull=hull,
        leaves=walk.leaves,
        regions=rows,
        region_maps=tuple(kind_of[region] for region in walk.regions),
        tolerance=scaling.slack(table) + (0.0 if number.is_fixed else law.tolerance),
        depth=walk.depth,
        is_cut=walk.is_cut,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Walk:
    """How points are led to regions; planes and rows have the numbers of the law."""

    tests: tuple[Ints, ...] = ()
    root: int = NOWHERE
    hull: Ints = ()
    leaves: tuple[Ints, ...] = ()
    regions: Ints = ()
    depth: int = 0
    is_cut: bool = False


def _distinct(law: ExplicitLaw) -> tuple[list[int], list[int]]:
    """One region for each distinct law of the moves, and the number of the law of each region."""
    keys = same_moves(law)
    numbers = {key: number for number, key in enumerate(dict.fromkeys(keys))}
    kinds = [numbers[key] for key in keys]
    return [kinds.index(number) for number in range(len(numbers))], kinds


def _tree(law: ExplicitLaw, planes: Planes, kind_of: list[int], kinds: int) -> _Walk:
    stack = RegionStack(law)
    tree = build_tree(law, tuple(kind_of), stack=stack)
    cover = cover_of(law, planes, tree, stack)
    mixed = [len({kind_of[region] for region in members}) > 1 for members in tree.members]
    open_leaves = np.flatnonzero(cover.is_open | np.array(mixed)).tolist()
    regions = sorted({region for leaf in open_leaves for region in tree.members[leaf]})
    place = {region: number for number, region in enumerate(regions)}
    number_of = {leaf: kinds + number for number, leaf in enumerate(open_leaves)}

    def code(child: int) -> int:
        if child >= NOWHERE:
            return child
        leaf = -2 - child
        return -2 - number_of.get(leaf, kind_of[int(tree.targets[leaf])])

    children = [tuple(map(code, pair)) for pair in tree.tree.children.tolist()]
    tests = zip(_plane_numbers(planes, tree.tree.normals, tree.tree.offsets), children, strict=True)
    return _Walk(
        tests=tuple((plane, first, second) for plane, (first, second) in tests),
        root=code(tree.tree.root),
        hull=tuple(cover.hull.tolist()),
        leaves=tuple(tuple(place[region] for region in tree.members[leaf]) for leaf in open_leaves),
        regions=tuple(regions),
        depth=tree.tree.depth,
        is_cut=tree.is_cut,
    )


def _plane_numbers(planes: Planes, normals: Array, offsets: Array) -> list[int]:
    rows = {row.tobytes(): number for number, row in enumerate(np.column_stack([planes.normals, planes.offsets]))}
    return [rows[row.tobytes()] for row in np.column_stack([normals, offsets])]


def _renumbered(law: ExplicitLaw, planes: Planes, walk: _Walk) -> tuple[list[int], tuple[Ints, ...], Ints]:
    """Planes that are used, in their order; rows of the regions, and of the hull, by their place among them."""
    bounds = list(pairwise(law.starts.tolist()))
    rows = [range(*bounds[region]) for region in walk.regions]
    numbers, signs = planes.numbers.tolist(), planes.signs.tolist()
    every = [*walk.hull, *(row for part in rows for row in part)]
    used = sorted({numbers[row] for row in every} | {plane for plane, _, _ in walk.tests})
    place = {plane: number for number, plane in enumerate(used)}

    def written(part: Ints | range) -> Ints:
        return tuple(int(signs[row]) * (place[numbers[row]] + 1) for row in part)

    return used, tuple(map(written, rows)), written(walk.hull)
