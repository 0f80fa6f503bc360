"""The method for a law: size of the tables and rows evaluated at random points decide between tree and sequence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.export.law_c_tables import c_tables
from hysdel_py.export.law_number import Number
from hysdel_py.export.law_table import LawTable, Method, law_table

__all__ = ["chosen_table", "mean_rows"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_POINTS = 300
_SEED = 11


def chosen_table(law: ExplicitLaw, number: Number, method: Method) -> tuple[LawTable, str]:
    """Tables of a law, and why their method was taken.

    With AUTO both are made. The tree is taken if the ratio of the sizes times the ratio of the rows that are evaluated
    at a point is less than one: a smaller tree that is no slower, or a faster one that is not larger by more.
    """
    if method is not Method.AUTO:
        return law_table(law, number, method), "asked for"
    tree, turn = law_table(law, number, Method.TREE), law_table(law, number, Method.SEQUENTIAL)
    points = random_points(law, _POINTS, np.random.default_rng(_SEED))
    rows = [mean_rows(table, points) for table in (tree, turn)]
    sizes = [c_tables(table).bytes for table in (tree, turn)]
    takes_tree = sizes[0] * rows[0] < sizes[1] * rows[1]
    cut = ", with leaves of several regions because its growth was limited" if tree.is_cut else ""
    figures = f"{sizes[0]} bytes and {rows[0]:.1f} rows a point as a tree{cut}"
    return (tree if takes_tree else turn), f"{figures}; {sizes[1]} bytes and {rows[1]:.1f} rows in turn"


def mean_rows(table: LawTable, points: Array) -> float:
    """Rows and tests that the code evaluates at a point, in the mean."""
    scaling, number = table.scaling, table.scaling.number
    raw = np.column_stack([scaling.raw(points), np.full(len(points), number.one if number.is_fixed else 1.0)])
    values = table.planes @ raw.T
    everywhere = np.arange(len(points))
    if table.method is Method.SEQUENTIAL:
        return float(_tried(table, range(len(table.regions)), values, everywhere)) / len(points)
    total, held = _rows_of(table.hull, values, table.tolerance, everywhere)
    count = int(total.sum())
    for point in np.flatnonzero(held).tolist():
        node = table.root
        while node >= 0:
            plane, first, second = table.tests[node]
            node = second if values[plane, point] > 0 else first
            count += 1
        leaf = -2 - node - len(table.maps)
        if leaf >= 0:
            count += _tried(table, table.leaves[leaf], values, np.array([point]))
    return count / len(points)


def _tried(table: LawTable, regions: Sequence[int], values: Array, points: NDArray[np.int64]) -> int:
    """Rows evaluated until each of the points is found in one of the regions."""
    count, open_points = 0, points
    for region in regions:
        if not len(open_points):
            break
        rows, held = _rows_of(table.regions[region], values, table.tolerance, open_points)
        count += int(rows.sum())
        open_points = open_points[~held]
    return count


def _rows_of(
    rows: Sequence[int], values: Array, tolerance: float, points: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Flags]:
    """How many of some rows are evaluated at each point, and where all of them hold."""
    if not rows:
        return np.zeros(len(points), dtype=np.int64), np.ones(len(points), dtype=bool)
    numbers = np.array(rows)
    fails = np.sign(numbers)[:, None] * values[np.ix_(np.abs(numbers) - 1, points)] > tolerance
    held = ~fails.any(axis=0)
    return np.where(held, len(rows), np.argmax(fails, axis=0) + 1), held
