"""The distinct hyperplanes of all facets of an explicit law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import Array, ExplicitLaw, Vector

__all__ = ["Planes", "Rows", "planes_of"]

Rows = tuple[Array, Vector]

_LEADING = 1e-9
"""The first entry of a row of unit length that is greater fixes its orientation."""

_DIGITS = 8
"""Rows that agree to so many digits are one hyperplane."""


@dataclass(frozen=True, eq=False, slots=True)
class Planes:
    """Hyperplanes ``normal w + offset = 0``, each in one orientation.

    Attributes
    ----------
    normals : array of shape (h, p)
    offsets : array of shape (h,)
    numbers : int array of shape (r,)
        Hyperplane of each row of the law.
    signs : array of shape (r,)
        1 where the row of the law is ``normal w <= -offset``, else -1.
    """

    normals: Array
    offsets: Vector
    numbers: NDArray[np.int64]
    signs: Vector

    @property
    def count(self) -> int:
        """Number of hyperplanes."""
        return len(self.offsets)

    def side(self, rows: Rows, number: int, sign: float, depth: float = 0.0) -> Rows:
        """Rows, and those points only that lie at least so deep on one side of a hyperplane (-1: first child)."""
        normal, offset = self.normals[number], self.offsets[number]
        return np.vstack([rows[0], -sign * normal]), np.append(rows[1], sign * offset - depth)


def planes_of(law: ExplicitLaw) -> Planes:
    """Hyperplanes in the order in which the rows of the law name them first."""
    lead = np.array([row[np.flatnonzero(np.abs(row) > _LEADING)[0]] for row in law.A])
    signs = np.where(lead < 0, -1.0, 1.0)
    table = np.column_stack([law.A, -law.b]) * signs[:, None]
    _, first, inverse = np.unique(np.round(table, _DIGITS) + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    chosen = table[first[order]]
    return Planes(chosen[:, :-1].copy(), chosen[:, -1].copy(), rank[inverse.reshape(-1)], signs)
