"""Is a quadratic function nowhere positive on a bounded polyhedron? Decided by bounds on parts that are halved.

On a part with vertices v and centre m the convex share of the function is greatest at a vertex, and the concave share
lies below its tangent at m. Both together are convex, so that their greatest value at the vertices is an upper bound;
it is exact where the function is convex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["Bounding", "Quadratic", "is_nowhere_positive"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Quadratic:
    """``x'H x + g'x + c`` with symmetric H."""

    H: Matrix
    g: Vector
    c: float

    def __call__(self, x: Matrix) -> Vector:
        """Values at the rows of an array."""
        return np.asarray(np.einsum("ki,ij,kj->k", x, self.H, x) + x @ self.g + self.c)


@dataclass(frozen=True, eq=False, slots=True)
class Bounding:
    """What was found.

    Attributes
    ----------
    holds : bool
        Whether the function is nowhere positive, up to the tolerance.
    witness : array of shape (n,) or None
        Where it is positive; None if it holds, or if neither was found within the parts.
    parts : int
    """

    holds: bool
    witness: Vector | None
    parts: int


def is_nowhere_positive(function: Quadratic, region: Polyhedron, tolerance: float, most: int) -> Bounding:
    """Whether a quadratic function exceeds a tolerance nowhere on a bounded polyhedron.

    Parameters
    ----------
    function : Quadratic
    region : Polyhedron
        Bounded; may be flat.
    tolerance : float
        Values up to this count as zero.
    most : int
        Parts that are looked at, at most.
    """
    pending, parts = [region], 0
    values, vectors = np.linalg.eigh(function.H)
    while pending:
        part = pending.pop()
        corners = part.vertices
        if not len(corners):
            continue
        parts += 1
        worst = int(np.argmax(function(corners)))
        if function(corners)[worst] > tolerance:
            return Bounding(False, corners[worst], parts)
        if _bound(function, corners, values, vectors) <= tolerance:
            continue
        if parts >= most:
            return Bounding(False, None, parts)
        pending += _halves(part, corners, values, vectors)
    return Bounding(True, None, parts)


def _bound(function: Quadratic, corners: Matrix, values: Vector, vectors: Matrix) -> float:
    centre = corners.mean(axis=0)
    away = (corners - centre) @ vectors
    # The concave share falls below its tangent by its own value at the distance from the centre.
    gained = -(away**2) @ np.minimum(values, 0.0)
    return float(np.max(function(corners) + gained))


def _halves(part: Polyhedron, corners: Matrix, values: Vector, vectors: Matrix) -> list[Polyhedron]:
    """Both sides of the plane that halves the direction in which the concave share is lost most."""
    along = corners @ vectors
    lost = np.minimum(values, 0.0) * np.ptp(along, axis=0) ** 2
    k = int(np.argmin(lost))
    row, middle = vectors[:, k], (along[:, k].max() + along[:, k].min()) / 2
    return [part.with_rows([sign * row], [sign * middle]) for sign in (1.0, -1.0)]
