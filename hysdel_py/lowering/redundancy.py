"""Rows of an Mld that the others imply.

Input: an Mld. Output: an Mld without rows that follow from its other rows and the ranges of states and inputs, with
Booleans anywhere between 0 and 1, and which rows these were. Preserved: the relaxation, so what a controller can plan
and how tight its bounds are; the kept rows keep their order and their origins.

The ranges of real auxiliaries take no part, since the rows are what these follow from.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.lp import Lp, maximise, sharpened_bound
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable

__all__ = ["Reduced", "RemovedRow", "remove_redundant_rows"]

Vector = NDArray[np.float64]

_REACH = 1e3  # real auxiliaries are looked at within so many times their range, where rounding still proves something
_TOLERANCE = 1e-9  # relative to the largest coefficient of the row
_MOST_ROWS = 80  # that one proof may use


@dataclass(frozen=True, slots=True)
class RemovedRow:
    """A row that is gone: its number in the Mld before, and where it came from."""

    index: int
    origin: RowOrigin


@dataclass(frozen=True, eq=False, slots=True)
class Reduced:
    """Result of :func:`remove_redundant_rows`."""

    mld: Mld
    removed: tuple[RemovedRow, ...]


def remove_redundant_rows(mld: Mld) -> Reduced:
    """Remove rows one after the other, the last first; of equal rows the first stays."""
    rows = _Rows(mld)
    removed = [index for index in reversed(range(mld.ne)) if rows.drop_if_implied(index)][::-1]
    kept = np.array([index for index in range(mld.ne) if index not in set(removed)], dtype=np.intp)
    E5 = mld.E5[kept]
    E5.setflags(write=False)
    smaller = replace(
        mld,
        E1=mld.E1[kept], E2=mld.E2[kept], E3=mld.E3[kept], E4=mld.E4[kept], E5=E5,
        rows=tuple(mld.rows[index] for index in kept),
    )  # fmt: skip
    return Reduced(smaller, tuple(RemovedRow(index, mld.rows[index]) for index in removed))


class _Rows:
    """Rows ``a'w <= b`` over w = (d, z, u, x), those that are still there, and who shares an auxiliary with whom."""

    def __init__(self, mld: Mld) -> None:
        from scipy.sparse import hstack

        matrix = hstack([mld.E2, mld.E3, -mld.E1, -mld.E4], format="csr")
        matrix.eliminate_zeros()
        self._b = mld.E5
        self._auxiliaries = mld.nd + mld.nz
        self._entries = [(matrix.indices[start:end], matrix.data[start:end]) for start, end in pairwise(matrix.indptr)]
        self._lb, self._ub = _ends(mld)
        self._there = set(range(mld.ne))
        self._using: dict[int, list[int]] = {}
        for row, (columns, _) in enumerate(self._entries):
            for column in columns.tolist():
                self._using.setdefault(column, []).append(row)

    def drop_if_implied(self, row: int) -> bool:
        """Drop a row if the others that are still there imply it."""
        if self._is_implied(row):
            self._there.discard(row)
            return True
        return False

    def _is_implied(self, row: int) -> bool:
        columns, values = self._entries[row]
        size = float(np.abs(values).max(initial=0.0))
        limit = self._b[row] + _TOLERANCE * max(size, np.finfo(float).tiny)
        ends = values * np.where(values > 0, self._ub[columns], self._lb[columns])
        if ends.sum() <= limit:
            return True
        others = self._neighbours(row)
        if not others:
            return False
        lp = self._program([*others, row], size)
        found = maximise(lp.c, lp.A, lp.b, lp.lb, lp.ub)
        return found.is_optimal and sharpened_bound(lp, found) <= limit

    def _program(self, rows: list[int], size: float) -> Lp:
        """Greatest value of the last row over all; it is moved outwards itself, so that the program is bounded."""
        columns = {c: k for k, c in enumerate(dict.fromkeys(c for r in rows for c in self._entries[r][0].tolist()))}
        A, order = np.zeros((len(rows), len(columns))), np.array(list(columns), dtype=np.intp)
        for index, r in enumerate(rows):
            where, values = self._entries[r]
            A[index, [columns[c] for c in where.tolist()]] = values
        b = self._b[rows].astype(float)
        b[-1] += size
        return Lp(A[-1].copy(), A, b, self._lb[order], self._ub[order])

    def _neighbours(self, row: int) -> list[int]:
        """Rows that share a variable with a row, then those that share an auxiliary with these."""
        near = self._sharing([row], auxiliaries_only=False)
        far = self._sharing(near, auxiliaries_only=True)
        return [r for r in dict.fromkeys([*near, *far]) if r != row][:_MOST_ROWS]

    def _sharing(self, rows: Iterable[int], *, auxiliaries_only: bool) -> list[int]:
        columns = dict.fromkeys(c for r in rows for c in self._entries[r][0].tolist())
        wanted = sorted(c for c in columns if c < self._auxiliaries or not auxiliaries_only)
        return [r for r in dict.fromkeys(r for c in wanted for r in self._using[c]) if r in self._there]


def _ends(mld: Mld) -> tuple[Vector, Vector]:
    variables = [*mld.d, *(_reach(v) for v in mld.z), *mld.u, *mld.x]
    low = np.array([0.0 if v.is_bool else v.low for v in variables], dtype=float)
    high = np.array([1.0 if v.is_bool else v.high for v in variables], dtype=float)
    return low, high


def _reach(variable: Variable) -> Variable:
    width = _REACH * max(1.0, abs(variable.low), abs(variable.high))
    return replace(variable, low=-width, high=width)
