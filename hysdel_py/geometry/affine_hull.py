"""The smallest affine space that holds a polyhedron, and a point in the relative interior."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.lp import maximise
from hysdel_py.geometry.precision import Precision

__all__ = ["AffineHull", "affine_hull", "null_space"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class AffineHull:
    """``{origin + basis v}`` with an origin in the relative interior of the polyhedron.

    Attributes
    ----------
    origin : array of shape (n,)
    basis : array of shape (n, k)
        Orthonormal columns.
    tight : array of shape (m,) of bool
        Rows that hold with equality everywhere in the polyhedron.
    """

    origin: Vector
    basis: Matrix
    tight: NDArray[np.bool_]

    @property
    def dimension(self) -> int:
        """Dimension of the polyhedron."""
        return int(self.basis.shape[1])


def null_space(A: Matrix, tolerance: float) -> Matrix:
    """Orthonormal columns that span ``{v : A v = 0}``, for rows of unit length or parts of such.

    Singular values below the tolerance count as zero.
    """
    if not A.size:
        return np.eye(A.shape[1])
    _, values, right = np.linalg.svd(A, full_matrices=len(A) < A.shape[1])
    rank = int(np.sum(values > tolerance))
    return np.asarray(right[rank:].T)


def affine_hull(A: Matrix, b: Vector, centre: Vector, radius: float, precision: Precision) -> AffineHull:
    """Affine hull of a polyhedron ``{w : A w <= b}`` that is not empty, with rows of unit length.

    Parameters
    ----------
    A : array of shape (m, n)
    b : array of shape (m,)
    centre, radius :
        A greatest inscribed ball. A radius that is clearly positive answers the question.
    """
    if radius > precision.empty:
        return AffineHull(centre, np.eye(A.shape[1]), np.zeros(len(b), dtype=bool))
    origin, slack = _point_with_most_slack(A, b, centre, precision)
    tight = slack <= precision.empty
    # Unit normals whose singular values fall below the tolerance of the slacks span no direction of their own.
    return AffineHull(origin, null_space(A[tight], precision.empty), tight)


def _point_with_most_slack(A: Matrix, b: Vector, centre: Vector, precision: Precision) -> tuple[Vector, Vector]:
    """A point at which every row that can be slack is slack, and for each row the most that was found.

    One linear program per row that no earlier point left slack; their solutions are averaged.
    """
    most = np.maximum(b - A @ centre, 0.0)
    points = [centre]
    for row in range(len(b)):
        if most[row] > precision.empty:
            continue
        point = _least(A, b, row, precision)
        if point is not None:
            most = np.maximum(most, b - A @ point)
            points.append(point)
    return np.mean(points, axis=0), most


def _least(A: Matrix, b: Vector, row: int, precision: Precision) -> Vector | None:
    """Where a row is slackest, up to a slack of one."""
    free = np.full(A.shape[1], np.inf)
    rows, sides = np.vstack([A, -A[row]]), np.append(b, 1.0 - b[row])
    answer = maximise(-A[row], rows, sides, -free, free, precision=precision, vertex=True)
    return answer.w if answer.is_optimal else None
