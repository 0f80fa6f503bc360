"""A quadratic program without its fixed variables and without rows that say the same.

In a node of a branch and bound most binaries are fixed, and with them pairs of big-M rows close on each other:
``z <= f`` and ``z >= f`` remain of a switch. Together they leave no interior, which an interior-point method needs, so
that it stalls on exactly the problems that are nearly decided. Here fixed variables are put in, parallel rows are
merged to one row with two sides, and a row whose sides meet becomes an equality. The answer is brought back to the full
problem.

Parallel rows are found by their products with random vectors: the ratios of such products do not depend on the scale
of a row. A false match would give a wrong reduced problem, whose answer the certificates of the full problem refuse.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.qp import Qp

__all__ = ["Reducer", "Reduction", "parallel_groups"]

Vector = NDArray[np.float64]
Indices = NDArray[np.intp]

MATCH = 1e-11
"""Ratios of products that differ by less than this, relative to their size, come from parallel rows."""
MEET = 1e-9
"""Sides of a merged row that are closer than this, relative to their size, are one side."""
SEED = 20051


@dataclass(frozen=True, eq=False, slots=True)
class Reduction:
    """A reduced problem and the way back.

    Attributes
    ----------
    qp : Qp
        Over the free variables and the merged rows.
    full : Qp
    free : array of int
        Free variables.
    upper, lower : arrays of int
        For each merged row the row of the full problem that gives its upper and its lower side.
    upper_scale, lower_scale : arrays
        The merged row times this scale is that row of the full problem.
    """

    qp: Qp
    full: Qp
    free: Indices
    upper: Indices
    lower: Indices
    upper_scale: Vector
    lower_scale: Vector

    def primal(self, x: Vector) -> Vector:
        """The point in all variables."""
        point = self.full.lb.copy()
        point[self.free] = x
        return point

    def multipliers(self, y: Vector) -> Vector:
        """Multipliers of all rows: each merged one goes to the row whose side it pushes against."""
        result = np.zeros(self.full.m)
        up, down = y > 0, y < 0
        result[self.upper[up]] += y[up] / self.upper_scale[up]
        result[self.lower[down]] += y[down] / self.lower_scale[down]
        return result


@dataclass(slots=True)
class Reducer:
    """What the reduction needs to know of the matrices, prepared once."""

    qp: Qp
    _rows: Any = field(init=False)
    _pattern: Any = field(init=False)
    _random: Vector = field(init=False)

    def __post_init__(self) -> None:
        from scipy.sparse import csr_array

        self._rows = csr_array(self.qp.A)
        self._pattern = csr_array((np.ones(self._rows.nnz), self._rows.indices, self._rows.indptr), self._rows.shape)
        self._random = np.random.default_rng(SEED).uniform(1.0, 2.0, (self.qp.n, 3))

    def reduce(self, qp: Qp) -> Reduction | None:
        """Reduce a problem of these matrices; None where nothing is left of the variables or of the rows."""
        fixed = qp.lb >= qp.ub
        free = np.flatnonzero(~fixed)
        if not free.size:
            return None
        inside = np.where(fixed, qp.lb, 0.0)
        base = self._rows @ inside
        rows = np.flatnonzero((self._pattern @ (~fixed).astype(float) > 0) & (np.isfinite(qp.l) | np.isfinite(qp.u)))
        if not rows.size:
            return None
        products = self._rows[rows] @ (self._random * ~fixed[:, None])
        merged = _merge(rows, products, (qp.l - base)[rows], (qp.u - base)[rows])
        return self._assemble(qp, free, inside, merged)

    def _assemble(self, qp: Qp, free: Indices, inside: Vector, merged: _Merged) -> Reduction:
        P = self.qp.P
        columns = P[:, free]
        gradient = qp.q + P @ inside
        constant = qp.constant + float(inside @ (qp.q + 0.5 * (P @ inside)))
        reduced = Qp(
            columns[free, :], gradient[free], self._rows[merged.row][:, free], merged.low, merged.high, qp.lb[free],
            qp.ub[free], constant,
        )  # fmt: skip
        return Reduction(reduced, qp, free, merged.upper, merged.lower, merged.upper_scale, merged.lower_scale)


@dataclass(frozen=True, eq=False, slots=True)
class _Merged:
    """Groups of parallel rows: a representative, the tightest sides, and which row gives each of them."""

    row: Indices
    low: Vector
    high: Vector
    upper: Indices
    lower: Indices
    upper_scale: Vector
    lower_scale: Vector


def _merge(rows: Indices, products: Vector, low: Vector, high: Vector) -> _Merged:
    group, first = parallel_groups(products)
    representative = first[group]
    scale = products[:, 0] / products[representative, 0]
    with np.errstate(invalid="ignore"):
        ends = np.stack([low / scale, high / scale])
    low, high = ends.min(axis=0), ends.max(axis=0)
    # The last of each group in this order has the tightest side.
    count = len(first)
    lower = _last_of_groups(np.lexsort((low, group)), group, count)
    upper = _last_of_groups(np.lexsort((-high, group)), group, count)
    low, high = _closed(low[lower], high[upper])
    return _Merged(rows[first], low, high, rows[upper], rows[lower], scale[upper], scale[lower])


def parallel_groups(products: Vector) -> tuple[Indices, Indices]:
    """Group number of each row from its products with three random vectors, and one row of each group."""
    keys = products[:, 1:] / products[:, :1]
    order = np.lexsort((keys[:, 1], keys[:, 0]))
    ordered = keys[order]
    apart = np.abs(np.diff(ordered, axis=0)) > MATCH * (1.0 + np.abs(ordered[1:]))
    starts = np.concatenate([[True], apart.any(axis=1)])
    group = np.empty(len(order), dtype=np.intp)
    group[order] = np.cumsum(starts) - 1
    return group, order[starts]


def _last_of_groups(order: Indices, group: Indices, count: int) -> Indices:
    last = np.empty(count, dtype=np.intp)
    last[group[order]] = order
    return last


def _closed(low: Vector, high: Vector) -> tuple[Vector, Vector]:
    """Sides that meet made equal; sides that have crossed by more stay as they are."""
    finite = np.isfinite(low) & np.isfinite(high)
    left, right = np.where(finite, low, 0.0), np.where(finite, high, 1.0)
    meet = finite & (np.abs(right - left) <= MEET * (1.0 + np.abs(right)))
    middle = 0.5 * (left + right)
    return np.where(meet, middle, low), np.where(meet, middle, high)
