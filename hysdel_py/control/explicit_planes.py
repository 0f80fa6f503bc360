"""The distinct hyperplanes of all facets of an explicit law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import Array, ExplicitLaw, Vector
from hysdel_py.optimize.parametric.facets import same_rows

__all__ = ["Planes", "Rows", "planes_of"]

Rows = tuple[Array, Vector]

_LEADING = 1e-9
"""The first entry of a row of unit length that is greater fixes its orientation."""

_SAME = 1e-8
"""Rows whose entries differ by less are one hyperplane."""


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
    first = same_rows(table[:, :-1].copy(), table[:, -1].copy(), _SAME)
    chosen, numbers = np.unique(first, return_inverse=True)
    return Planes(table[chosen, :-1].copy(), table[chosen, -1].copy(), numbers.reshape(-1), signs)
