"""Linear programs over a cell of a Dha and over the region of a mode, each with a bound that its multipliers prove.

They settle most questions about a mode at a fraction of the time of a mixed-integer search, and only by proof: what
they leave open is searched for.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.comparison import Comparison
from hysdel_py.analysis.pwa_words import Cell, Evaluation
from hysdel_py.geometry.lp import maximise
from hysdel_py.systems.mode import Mode

__all__ = ["CellRows", "cell_rows", "is_inside"]

Vector = NDArray[np.float64]

_PARALLEL = 1e-12
"""Rows whose coefficients differ by less, relative to the greatest, have one direction."""


@dataclass(frozen=True, eq=False, slots=True)
class CellRows:
    """The cell ``A w <= b`` of a word within the ranges ``low <= w <= high``.

    Attributes
    ----------
    A, b : arrays of shapes (m, n), (m,)
        Thresholds on the side that the word tells, false ones kept away by the band, and requirements.
    most : array of shape (m,)
        A region in which each row of A stays at most here has no step of another word outside the band.
    low, high : arrays of shape (n,)
        Ranges, with the Booleans of the word fixed.
    is_empty : bool
        Whether logic, or a threshold without variables, excludes the word.
    """

    A: Vector
    b: Vector
    most: Vector
    low: Vector
    high: Vector
    is_empty: bool

    def is_within(self, a: Vector, level: float) -> bool:
        """Whether no point of the cell has a greater ``a w`` than a level, by proof."""
        return self.is_empty or _never_above(a, level, (self.A, self.b), (self.low, self.high))


def cell_rows(comparison: Comparison, cell: Cell, evaluation: Evaluation) -> CellRows:
    """The rows of the cell of a word."""
    rows = list(_rows(comparison, cell, evaluation))
    ranges = {**comparison.ranges, **{name: (float(value), float(value)) for name, value in cell.word}}
    ends = np.array([ranges[v.name] for v in (*comparison.dha.x, *comparison.dha.u)], dtype=float).reshape(-1, 2)
    real = [row for row in rows if row[0].any()]
    fails = any(not row[0].any() and row[1] < 0.0 for row in rows)
    A = np.array([row[0] for row in real]).reshape(len(real), len(ends))
    b, most = (np.array([row[i] for row in real], dtype=float) for i in (1, 2))
    return CellRows(A, b, most, ends[:, 0], ends[:, 1], fails or not evaluation.is_possible)


def _rows(comparison: Comparison, cell: Cell, evaluation: Evaluation) -> Iterator[tuple[Vector, float, float]]:
    """Each row with the sides that the cell keeps and that a region has to keep."""
    word = dict(cell.word)
    for event, form in evaluation.events:
        band = comparison.band(event)
        if word[event.name]:
            yield form[:-1], -float(form[-1]), 0.5 * band - float(form[-1])
        else:
            yield -form[:-1], float(form[-1]) - band, float(form[-1]) - 0.5 * event.epsilon
    for requirement, form in evaluation.requirements:
        slack = comparison.margins.violation(requirement.value, comparison.ranges)
        yield form[:-1], -float(form[-1]), slack - float(form[-1])


def is_inside(mode: Mode, rows: CellRows) -> bool:
    """Whether the region of a mode lies in a cell, by proof."""
    if rows.is_empty:
        return False
    A, b = mode.region.A, mode.region.b
    fixed = rows.low == rows.high
    low, high = np.where(fixed, -np.inf, rows.low), np.where(fixed, np.inf, rows.high)
    return _has_word(A, b, rows, fixed) and all(
        _never_above(a, level, (A, b), (low, high)) for a, level in zip(rows.A, rows.most, strict=True)
    )


def _has_word(A: Vector, b: Vector, rows: CellRows, fixed: NDArray[np.bool_]) -> bool:
    """Whether rows of one coordinate each give the Boolean coordinates the values of the word."""
    alone = np.count_nonzero(A, axis=1) == 1
    for column in np.flatnonzero(fixed):
        c, value = A[:, column], rows.low[column]
        states = [(alone & (sign * c > 0) & (b <= c * value + _PARALLEL * np.abs(c))).any() for sign in (1.0, -1.0)]
        if not all(states):
            return False
    return True


def _never_above(a: Vector, level: float, rows: tuple[Vector, Vector], ranges: tuple[Vector, Vector]) -> bool:
    """Whether ``a w <= level`` follows from ranges, from a row in the same direction, or from a linear program."""
    (A, b), (low, high) = rows, ranges
    ends = np.where(a > 0, high, low)
    if sum((c * end for c, end in zip(a, ends, strict=True) if c), start=0.0) <= level:
        return True
    if _follows_from_one(a, level, A, b):
        return True
    return bool(maximise(a, A, b, low, high).bound <= level)


def _follows_from_one(a: Vector, level: float, A: Vector, b: Vector) -> bool:
    """Whether a row in the same direction states a side as small."""
    size = np.abs(a).max(initial=0.0)
    sizes = np.abs(A).max(axis=1, initial=0.0)
    if not size or not len(b):
        return False
    scale = size / np.where(sizes > 0, sizes, 1.0)
    same = np.abs(A * scale[:, None] - a).max(axis=1) <= _PARALLEL * size
    return bool((same & (b * scale <= level)).any())
