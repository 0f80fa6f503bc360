"""An explicit hybrid law as tables: regions of all sequences, their values, and where each Boolean word begins."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.control.hybrid_overlaps import joined
from hysdel_py.control.hybrid_sequences import TIE
from hysdel_py.errors import ArgumentError
from hysdel_py.export.law_number import Number
from hysdel_py.export.law_table import LawTable, Method, law_table

__all__ = ["HybridTable", "hybrid_table"]

Array = NDArray[np.float64]

_MOST_BOOLEANS = 31
"""A word is kept in 32 bits."""

_ROUNDINGS = 64
"""Values that differ by so many roundings of the number type, relative, are a tie as well."""


@dataclass(frozen=True, eq=False, slots=True)
class HybridTable:
    """Everything that the code needs.

    Attributes
    ----------
    law : ExplicitLaw
        All regions over the real parameters, in the order of the sequences.
    table : LawTable
        Its rows and moves, for regions that are tried in turn.
    values : array of shape (V, k)
        Distinct values: coefficients of the products of two parameters, the upper triangle row by row, if there are
        any; then of the parameters; then the constant. Empty if regions do not overlap.
    region_value : tuple of int
        Value of each region.
    words : tuple of int
        Values of the Boolean parameters, bit by bit, for each group of regions.
    starts : tuple of int
        Regions of group i are ``starts[i]`` up to ``starts[i + 1]``.
    real, boolean : tuple of int
        Places of the parameters in zeta.
    tie : float
        Values that differ by less, relative to 1 and their size, are equal.
    """

    law: ExplicitLaw
    table: LawTable
    values: Array
    region_value: tuple[int, ...]
    words: tuple[int, ...]
    starts: tuple[int, ...]
    real: tuple[int, ...]
    boolean: tuple[int, ...]
    tie: float

    @property
    def is_quadratic(self) -> bool:
        """Whether values have products of parameters."""
        return len(self.values) > 0 and self.values.shape[1] > self.table.p + 1


def hybrid_table(law: HybridLaw, number: Number) -> HybridTable:
    """Tables of a law.

    Raises
    ------
    ArgumentError
        The law has no regions, more than 31 Boolean parameters, or a fixed-point number is asked for.
    """
    if number.is_fixed:
        raise ArgumentError(f"number is {number.value!r}: values are compared in double or float")
    used = [sequence for sequence in law.sequences if sequence.law.count]
    if not used:
        raise ArgumentError("the law has no regions: there is nothing to write")
    places = [[k for k, p in enumerate(law.parameters.free) if p.is_bool is flag] for flag in (False, True)]
    size = len(places[1])
    if size > _MOST_BOOLEANS:
        raise ArgumentError(f"the law has {size} Boolean parameters: {_MOST_BOOLEANS} at most were expected")
    whole = replace(joined([sequence.law for sequence in used]), moves=len(law.u))
    groups = [(word, sum(s.law.count for s in part)) for word, part in groupby(used, lambda s: s.word[:size])]
    values, region_value = (np.zeros((0, 0)), ()) if law.partition else _values(whole)
    return HybridTable(
        whole,
        law_table(whole, number, Method.SEQUENTIAL),
        values,
        region_value,
        words=tuple(sum(bit << k for k, bit in enumerate(word)) for word, _ in groups),
        starts=tuple(np.cumsum([0, *(count for _, count in groups)]).tolist()),
        real=tuple(places[0]),
        boolean=tuple(places[1]),
        tie=max(TIE, _ROUNDINGS * number.epsilon),
    )


def _values(law: ExplicitLaw) -> tuple[Array, tuple[int, ...]]:
    rows, columns = np.triu_indices(law.p)
    form = np.where(rows == columns, 0.5, 1.0) * 0.5 * (law.P + law.P.transpose(0, 2, 1))[:, rows, columns]
    parts = [form] if np.any(form) else []
    table = np.column_stack([*parts, law.q, law.r])
    chosen, numbers = np.unique(table, axis=0, return_inverse=True)
    return chosen, tuple(numbers.reshape(-1).tolist())
