"""Interval bound propagation over the rows ``l <= A w <= u`` of a mixed-integer problem.

The least value of a row over a box is the sum of the least values of its terms. What is left of a side when all other
terms take their least value bounds the remaining one; bounds of integers are rounded inwards. A round looks only at the
rows that touch a bound changed in the round before. Everything is done for all these rows at once.

Source: M. W. P. Savelsbergh, "Preprocessing and probing techniques for mixed integer programming problems", ORSA
Journal on Computing 6, 1994, section 1; T. Achterberg, "Constraint Integer Programming", 2007, section 7.1.

No feasible point is lost: each derived bound is moved outwards by a margin that covers rounding in the data and in the
sums, and a conflict counts only beyond that margin. The margin stays far below the 1e-6 by which a HYSDEL model
separates "greater" from "greater or equal", as long as the terms of the row stay below about a thousand.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["Box", "PropagationSettings", "Propagator"]

Vector = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class PropagationSettings:
    """Margins and effort of the propagation.

    Attributes
    ----------
    margin : float
        Slack given to a side, relative to its size and at least absolute.
    rounding : float
        Further slack relative to the sum of the absolute values of the terms of the row.
    integrality : float
        An integer's bound is rounded inwards only if it misses the next integer by more than this.
    progress : float
        A bound of a real variable is worth another round if its interval shrinks at least by this share.
    huge : float
        Derived bounds of a larger absolute value are not kept.
    rounds : int
        Largest number of rounds.
    """

    margin: float = 1e-9
    rounding: float = 1e-13
    integrality: float = 1e-9
    progress: float = 1e-2
    huge: float = 1e9
    rounds: int = 200

    def __post_init__(self) -> None:
        for name in ("margin", "rounding", "integrality", "progress", "huge", "rounds"):
            if not getattr(self, name) > 0:
                raise ArgumentError(f"{name} is {getattr(self, name)}: a positive number was expected")


@dataclass(frozen=True, eq=False, slots=True)
class Box:
    """Bounds after propagation.

    Attributes
    ----------
    lb, ub : arrays of shape (n,)
    conflict : int or None
        A row or (where it equals the number of rows) a pair of crossed bounds that proves that no integer point
        satisfies the rows; None as long as there may be one.
    rounds : int
        Number of rounds that were needed.
    """

    lb: Vector
    ub: Vector
    conflict: int | None = None
    rounds: int = 0


class Propagator:
    """Propagation over fixed coefficients; sides and bounds come with each call.

    Parameters
    ----------
    A : sparse array of shape (m, n)
    integers : array of int
        Indices of the integer variables.
    settings : PropagationSettings, optional
    """

    def __init__(self, A: Any, integers: Indices, settings: PropagationSettings | None = None) -> None:
        from scipy.sparse import csc_array, csr_array

        rows = csr_array(A)
        rows.eliminate_zeros()
        columns = csc_array(rows)
        self.settings = settings or PropagationSettings()
        self.m, self.n = rows.shape
        self._start, self._count = rows.indptr[:-1].astype(np.intp), np.diff(rows.indptr).astype(np.intp)
        self._column, self._value = rows.indices.astype(np.intp), rows.data
        self._touching = np.split(columns.indices.astype(np.intp), columns.indptr[1:-1])
        self._integer = np.zeros(self.n, dtype=bool)
        self._integer[integers] = True
        self._filled = np.flatnonzero(self._count)
        self._every = self._gather(self._filled)

    def propagate(
        self,
        lb: Vector,
        ub: Vector,
        l: Vector,  # noqa: E741
        u: Vector,
        changed: Indices | None = None,
    ) -> Box:
        """Shrink the box.

        Parameters
        ----------
        lb, ub : arrays of shape (n,)
            Left as they are; the result has new ones.
        l, u : arrays of shape (m,)
        changed : array of int, optional
            Variables whose bounds have changed since the box was last propagated; all rows are looked at if None.
        """
        lb, ub = self._rounded(lb, ub)
        empty = self._crossed(lb, ub) or self._empty_row(l, u)
        entries = self._every if changed is None else self._entries_touching(changed)
        rounds = 0
        while empty is None and entries.size and rounds < self.settings.rounds:
            rounds += 1
            empty, moved = self._round(entries, lb, ub, l, u)
            entries = self._entries_touching(moved) if moved.size and empty is None else NOTHING
        return Box(lb, ub, empty, rounds)

    def _round(
        self, e: _Entries, lb: Vector, ub: Vector, l: Vector, u: Vector  # noqa: E741
    ) -> tuple[int | None, Indices]:
        """Tighten in place by the given rows; return a conflict and the variables whose bounds moved."""
        low, high = lb[e.column], ub[e.column]
        term_low, term_high = e.value * np.where(e.positive, low, high), e.value * np.where(e.positive, high, low)
        size = np.maximum(np.abs(term_low), np.abs(term_high))
        slack = self.settings.rounding * _finite_sum(size, e.first)
        upper = u[e.rows] + self.settings.margin * (1 + np.abs(np.where(np.isfinite(u[e.rows]), u[e.rows], 0))) + slack
        lower = l[e.rows] - self.settings.margin * (1 + np.abs(np.where(np.isfinite(l[e.rows]), l[e.rows], 0))) - slack
        least, rest_low = _sums(term_low, e, -np.inf)
        greatest, rest_high = _sums(term_high, e, np.inf)
        bad = (least > upper) | (greatest < lower)
        if bad.any():
            return int(e.rows[bad.argmax()]), NO_INDICES
        most, fewest = (upper[e.of] - rest_low) / e.value, (lower[e.of] - rest_high) / e.value
        return self._apply(e, np.where(e.positive, fewest, most), np.where(e.positive, most, fewest), lb, ub)

    def _apply(
        self, e: _Entries, low: Vector, high: Vector, lb: Vector, ub: Vector
    ) -> tuple[int | None, Indices]:
        s = self.settings
        integer = self._integer[e.column]
        low = np.where(integer, np.ceil(low - s.integrality), low)
        high = np.where(integer, np.floor(high + s.integrality), high)
        old_low, old_high = lb[e.column], ub[e.column]
        width = np.where(np.isfinite(old_high - old_low), old_high - old_low, 0.0)
        step = np.maximum(s.progress * width, s.margin * (1 + np.minimum(np.abs(low), np.abs(high))))
        up = (low > old_low + step) & (np.abs(low) < s.huge)
        down = (high < old_high - step) & (np.abs(high) < s.huge)
        np.maximum.at(lb, e.column[up], low[up])
        np.minimum.at(ub, e.column[down], high[down])
        moved = np.concatenate([e.column[up], e.column[down]])
        return self._crossed(lb, ub, moved), moved

    def _crossed(self, lb: Vector, ub: Vector, among: Indices | None = None) -> int | None:
        low, high = (lb, ub) if among is None else (lb[among], ub[among])
        over = low > high
        if not over.any():
            return None
        low, high = low[over], high[over]
        return self.m if (low > high + self.settings.margin * (1 + np.abs(high))).any() else None

    def _empty_row(self, l: Vector, u: Vector) -> int | None:  # noqa: E741
        """A row without coefficients whose sides exclude zero, or a row with crossed sides."""
        margin = self.settings.margin
        bad = l > u + margin * (1 + np.abs(u))
        bad |= (self._count == 0) & ((l > margin) | (u < -margin))
        return int(bad.argmax()) if bad.any() else None

    def _rounded(self, lb: Vector, ub: Vector) -> tuple[Vector, Vector]:
        tolerance = self.settings.integrality
        return (
            np.where(self._integer, np.ceil(lb - tolerance), lb),
            np.where(self._integer, np.floor(ub + tolerance), ub),
        )

    def _entries_touching(self, variables: Indices) -> _Entries:
        marked = np.zeros(self.m, dtype=bool)
        for variable in set(variables.tolist()):
            marked[self._touching[variable]] = True
        return self._gather(np.flatnonzero(marked))

    def _gather(self, rows: Indices) -> _Entries:
        """Entries of some rows, row after row."""
        if not rows.size:
            return NOTHING
        count = self._count[rows]
        first = np.cumsum(count) - count
        of = np.repeat(np.arange(len(rows)), count)
        where = np.arange(len(of)) + (self._start[rows] - first)[of]
        value = self._value[where]
        return _Entries(rows, first, of, self._column[where], value, value > 0)


@dataclass(frozen=True, eq=False, slots=True)
class _Entries:
    """Nonzero coefficients of some rows: row numbers, first entry of each row, and row, column, value per entry."""

    rows: Indices
    first: Indices
    of: Indices
    column: Indices
    value: Vector
    positive: NDArray[np.bool_]

    @property
    def size(self) -> int:
        return self.column.size


NO_INDICES: Indices = np.zeros(0, dtype=np.intp)
NOTHING = _Entries(NO_INDICES, NO_INDICES, NO_INDICES, NO_INDICES, np.zeros(0), np.zeros(0, dtype=bool))


def _finite_sum(size: Vector, first: Indices) -> Vector:
    total: Vector = np.add.reduceat(size, first)
    if np.isinf(total).any():
        total = np.add.reduceat(np.where(np.isinf(size), 0.0, size), first)
    return total


def _sums(terms: Vector, e: _Entries, infinity: float) -> tuple[Vector, Vector]:
    """Sum of each row, and for each entry the sum of the other entries of its row."""
    total = np.add.reduceat(terms, e.first)
    if np.isfinite(total).all():
        return total, total[e.of] - terms
    endless = np.isinf(terms)
    finite = np.where(endless, 0.0, terms)
    finite_total, count = np.add.reduceat(finite, e.first), np.add.reduceat(endless.astype(np.intp), e.first)
    others = np.where(count[e.of] - endless > 0, infinity, finite_total[e.of] - finite)
    return np.where(count > 0, infinity, finite_total), others
