"""Products of the program's matrices that every call of a controller needs, formed once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.objective import Objective

if TYPE_CHECKING:
    from scipy.sparse import csc_array, csr_array

__all__ = ["Prepared", "prepare"]

Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]

SMALL = 20_000
"""Entries up to which a dense product is faster than a sparse one."""


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """What the vectors of a call and the check of a plan are computed with.

    Attributes
    ----------
    gain : array or sparse array of shape (n, tracked)
        ``2 V'Q``, which takes the tracked signals at v = 0 to the linear cost.
    weights : array or sparse array of shape (tracked, tracked)
        Q. Both are dense where they are small: most of the time of a small sparse product is not arithmetic.
    entries : mapping of name to (integer array, integer array)
        Places of a reference among the tracked signals, and their times.
    rows : (start, column, value)
        A in compressed rows.
    """

    gain: csr_array | Matrix
    weights: csr_array | Matrix
    entries: Mapping[str, tuple[Indices, Indices]]
    rows: tuple[NDArray[np.int64], NDArray[np.int64], Matrix]

    def targets(self, references: Mapping[str, Matrix], size: int) -> Matrix:
        """References of all tracked signals, 0 where none is given."""
        targets = np.zeros(size)
        for name, values in references.items():
            if name in self.entries:
                places, times = self.entries[name]
                targets[places] = values[times]
        return targets


def prepare(objective: Objective, A: csc_array) -> Prepared:
    """Form the products of a program."""
    from scipy.sparse import csr_array

    gain = csr_array(2.0 * (objective.signals.V.T @ objective.Q))
    rows = csr_array(A)
    compressed = rows.indptr.astype(np.int64), rows.indices.astype(np.int64), rows.data.astype(float)
    return Prepared(_dense_if_small(gain), _dense_if_small(objective.Q), _entries(objective), compressed)


def _dense_if_small(matrix: csr_array) -> csr_array | Matrix:
    dense: csr_array | Matrix = matrix.toarray() if np.prod(matrix.shape) <= SMALL else matrix
    return dense


def _entries(objective: Objective) -> dict[str, tuple[Indices, Indices]]:
    """Increments have no reference."""
    found: dict[str, list[tuple[int, int]]] = {}
    for place, signal in enumerate(objective.tracked):
        if signal.group != "du":
            found.setdefault(signal.name, []).append((place, signal.time))
    tables = {name: np.array(pairs, dtype=np.intp) for name, pairs in found.items()}
    return {name: (table[:, 0], table[:, 1]) for name, table in tables.items()}
