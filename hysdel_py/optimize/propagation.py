"""Interval bound propagation over the rows ``l <= A w <= u`` of a mixed-integer problem.

The least value of a row over a box is the sum of the least values of its terms. What is left of a side when all other
terms take their least value bounds the remaining one; bounds of integers are rounded inwards. A round looks only at the
rows that touch a bound changed in the round before. Everything is done for all these rows at once.

Source: M. W. P. Savelsbergh, "Preprocessing and probing techniques for mixed integer programming problems", ORSA
Journal on Computing 6, 1994, section 1; T. Achterberg, "Constraint Integer Programming", 2007, section 7.1.

No feasible point is lost: each side is moved outwards by a margin, relative to its size, and by what the rounding of
the sum can amount to, and a conflict counts only beyond that. The margin stays far below the 1e-6 by which a HYSDEL
model separates "greater" from "greater or equal", as long as the sides of the row stay below about a thousand.

Inside, a box is one vector ``d = (-lb, ub)``, so that every bound is one that can only fall, and a row ``a'w`` lies
between ``-sum |a_j| d[low_j]`` and ``sum |a_j| d[high_j]``, where low and high exchange roles with the sign of a_j.
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

UNIT_ROUNDOFF = float(np.finfo(float).eps)


@dataclass(frozen=True, slots=True)
class PropagationSettings:
    """Margins and effort of the propagation.

    Attributes
    ----------
    margin : float
        Slack given to a side and to a pair of bounds, relative to its size and at least absolute.
    integrality : float
        An integer's bound is rounded inwards only if it misses the next integer by more than this.
    progress : float
        A bound is moved only if its interval shrinks at least by this share.
    huge : float
        Derived bounds of a larger absolute value are not kept.
    rounds : int
        Largest number of rounds.
    """

    margin: float = 1e-9
    integrality: float = 1e-9
    progress: float = 1e-2
    huge: float = 1e7
    rounds: int = 200

    def __post_init__(self) -> None:
        for name in ("margin", "integrality", "progress", "huge", "rounds"):
            if not getattr(self, name) > 0:
                raise ArgumentError(f"{name} is {getattr(self, name)}: a positive number was expected")


@dataclass(frozen=True, eq=False, slots=True)
class Box:
    """Bounds after propagation.

    Attributes
    ----------
    lb, ub : arrays of shape (n,)
    conflict : int or None
        A row, or the number of rows where a pair of bounds has crossed: no integer point satisfies the rows. None as
        long as there may be one.
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
        column, positive = rows.indices.astype(np.intp), rows.data > 0
        self._high, self._low = column + self.n * positive, column + self.n * ~positive
        self._weight = np.abs(rows.data)
        self._touching = np.split(columns.indices.astype(np.intp), columns.indptr[1:-1])
        integer = np.zeros(self.n, dtype=bool)
        integer[integers] = True
        self._integer = np.concatenate([integer, integer])
        self._every = self._gather(np.flatnonzero(self._count))

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
        d = self._rounded(np.concatenate([-lb, ub]))
        conflict = self._crossed(d, np.arange(self.n))
        sides = self._sides(d, l, u)
        if conflict is None and changed is None:
            conflict = self._empty_row(l, u)
        entries = self._every if changed is None else self._entries_touching(changed)
        rounds = 0
        while conflict is None and entries.rows.size and rounds < self.settings.rounds:
            rounds += 1
            conflict, moved = self._round(entries, d, sides)
            entries = self._entries_touching(moved) if conflict is None else NOTHING
        return Box(-d[: self.n], d[self.n :], conflict, rounds)

    def _round(self, e: _Entries, d: Vector, sides: tuple[Vector, Vector]) -> tuple[int | None, Indices]:
        """Tighten in place by the given rows; return a conflict, and the variables whose bounds moved."""
        count = len(e.of)
        current = d[e.slots]
        terms = e.weight * current
        highs, lows = terms[:count], terms[count:]
        high_sum, low_sum = np.add.reduceat(highs, e.first), np.add.reduceat(lows, e.first)
        to_upper, to_lower = sides[1][e.rows] + low_sum, high_sum - sides[0][e.rows]
        room = np.minimum(to_upper, to_lower)
        if room.size and room.min() < 0:
            return int(e.rows[room.argmin()]), NO_INDICES
        if np.isfinite(high_sum).all() and np.isfinite(low_sum).all():
            left = np.concatenate([to_upper[e.of] - lows, to_lower[e.of] - highs])
        else:
            left = _left_with_missing_bounds(e, lows, highs, sides)
        return self._apply(e, left / e.weight, current, d)

    def _apply(self, e: _Entries, found: Vector, current: Vector, d: Vector) -> tuple[int | None, Indices]:
        """Round the bounds that were found and keep those that are worth it."""
        s, count = self.settings, len(e.of)
        np.floor(found + s.integrality, out=found, where=self._integer[e.slots])
        width = current[:count] + current[count:]
        width[np.isinf(width)] = 0.0
        step = s.progress * width + s.margin
        good = (found < current - np.concatenate([step, step])) & (np.abs(found) < s.huge)
        slots = e.slots[good]
        np.minimum.at(d, slots, found[good])
        moved = slots % self.n
        return self._crossed(d, moved), moved

    def _sides(self, d: Vector, l: Vector, u: Vector) -> tuple[Vector, Vector]:  # noqa: E741
        """Sides moved outwards by the margin and by the possible rounding of the sums."""
        margin = self.settings.margin
        e = self._every
        size = np.minimum(np.maximum(np.abs(d[: self.n]), np.abs(d[self.n :])), self.settings.huge)
        total = np.zeros(self.m)
        if e.rows.size:
            terms = self._weight * size[self._high % self.n]
            total[e.rows] = np.add.reduceat(terms, e.first)
        slack = margin + 2 * UNIT_ROUNDOFF * (self._count + 4) * total
        return l - slack - margin * _finite_size(l), u + slack + margin * _finite_size(u)

    def _crossed(self, d: Vector, among: Indices) -> int | None:
        width = d[among] + d[among + self.n]
        if width.size == 0 or width.min() >= 0:
            return None
        allowed = -self.settings.margin * (1 + np.abs(d[among]))
        return self.m if (width < allowed).any() else None

    def _empty_row(self, l: Vector, u: Vector) -> int | None:  # noqa: E741
        """A row without coefficients whose sides exclude zero, or a row with crossed sides."""
        margin = self.settings.margin
        bad = l > u + margin * (1 + np.abs(u))
        bad |= (self._count == 0) & ((l > margin) | (u < -margin))
        return int(bad.argmax()) if bad.any() else None

    def _rounded(self, d: Vector) -> Vector:
        return np.where(self._integer, np.floor(d + self.settings.integrality), d)

    def _entries_touching(self, variables: Indices) -> _Entries:
        marked = np.zeros(self.m, dtype=bool)
        if variables.size:
            marked[np.concatenate([self._touching[variable] for variable in set(variables.tolist())])] = True
        return self._gather(marked.nonzero()[0])

    def _gather(self, rows: Indices) -> _Entries:
        """Entries of some rows, row after row."""
        if not rows.size:
            return NOTHING
        count = self._count[rows]
        end = count.cumsum()
        first = end - count
        of = np.arange(len(rows)).repeat(count)
        where = np.arange(end[-1]) + (self._start[rows] - first)[of]
        weight = self._weight[where]
        slots = np.concatenate([self._high[where], self._low[where]])
        return _Entries(rows, first, of, slots, np.concatenate([weight, weight]))


@dataclass(frozen=True, eq=False, slots=True)
class _Entries:
    """Nonzero coefficients of some rows.

    Row numbers, first entry of each row, row of each entry; then twice as long: where the bounds stand in d that make
    the term great, followed by those that make it small, and the absolute values of the coefficients.
    """

    rows: Indices
    first: Indices
    of: Indices
    slots: Indices
    weight: Vector


NO_INDICES: Indices = np.zeros(0, dtype=np.intp)
NOTHING = _Entries(NO_INDICES, NO_INDICES, NO_INDICES, NO_INDICES, np.zeros(0))


def _left_with_missing_bounds(e: _Entries, lows: Vector, highs: Vector, sides: tuple[Vector, Vector]) -> Vector:
    """What the other terms of the row leave of its sides, some of the terms being infinite."""
    below, above = _sum_of_others(e, lows), _sum_of_others(e, highs)
    return np.concatenate([sides[1][e.rows][e.of] + below, above - sides[0][e.rows][e.of]])


def _sum_of_others(e: _Entries, terms: Vector) -> Vector:
    endless = np.isinf(terms)
    finite = np.where(endless, 0.0, terms)
    missing = np.add.reduceat(endless.astype(np.intp), e.first)[e.of] - endless
    return np.where(missing > 0, np.inf, np.add.reduceat(finite, e.first)[e.of] - finite)


def _finite_size(side: Vector) -> Vector:
    return np.where(np.isfinite(side), np.abs(side), 0.0)
