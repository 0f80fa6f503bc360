"""Rows of a convex hull of points, rays and lines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.affine_hull import AffineHull, affine_hull
from hysdel_py.geometry.generators import generators_of
from hysdel_py.geometry.precision import Precision

__all__ = ["hull_rows", "hull_volume"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_NO_ROW = 1e-10
"""A vertex of the polar this close to the origin, relative to the farthest one, gives no row."""


def hull_rows(points: Matrix, rays: Matrix, lines: Matrix, precision: Precision) -> tuple[Matrix, Vector]:
    """Rows ``A w <= b`` of ``conv(points) + cone(rays) + span(lines)``; equalities are pairs of opposite rows.

    The rows of the set moved so that the origin is inside are the generators of its polar ``{a : p'a <= 1, r'a <= 0,
    l'a = 0}``: a vertex gives ``a'w <= 1``, a line ``a'w = 0``. The origin is inside, hence the polar has no rays.

    Parameters
    ----------
    points : array of shape (p, n), p >= 1
    rays : array of shape (r, n)
    lines : array of shape (l, n)
    """
    n = points.shape[1]
    if not n:
        return np.zeros((0, 0)), np.zeros(0)
    directions = [ray / np.linalg.norm(ray) for ray in rays if np.any(ray)]
    size = max(float(np.max(np.abs(points - points.mean(axis=0)))), np.finfo(float).tiny)
    if size < np.finfo(float).eps * float(np.max(np.abs(points), initial=0.0)) or len(points) == 1:
        size = 1.0
    inner = points.mean(axis=0) + size * np.sum(np.array(directions).reshape(-1, n), axis=0)
    polar = generators_of(*_polar((points - inner) / size, np.array(directions).reshape(-1, n), lines, precision))
    equal, sides = polar.lines, polar.points * size
    A = np.vstack([polar.points, equal, -equal])
    b = np.concatenate([np.full(len(sides), size), np.zeros(2 * len(equal))]) + A @ inner
    lengths = np.linalg.norm(A, axis=1)
    real = lengths > _NO_ROW * np.max(lengths, initial=0.0)  # the origin is a vertex of the polar of an unbounded set
    return A[real] / lengths[real, None], b[real] / lengths[real]


def _polar(points: Matrix, rays: Matrix, lines: Matrix, precision: Precision) -> tuple[Matrix, Vector, AffineHull]:
    """Unit rows of the polar and its affine hull."""
    rows = np.vstack([points, rays, lines, -lines])
    sides = np.concatenate([np.ones(len(points)), np.zeros(len(rays) + 2 * len(lines))])
    lengths = np.linalg.norm(rows, axis=1)
    real = lengths > precision.empty
    A, b = rows[real] / lengths[real, None], sides[real] / lengths[real]
    centre = np.zeros(rows.shape[1])
    if not len(rays) and not len(lines):
        return A, b, AffineHull(centre, np.eye(len(centre)), np.zeros(len(b), dtype=bool))
    return A, b, affine_hull(A, b, centre, 0.0, precision)


def hull_volume(points: Matrix) -> float:
    """Volume of the convex hull of points that span their space."""
    if points.shape[1] < 2:
        return float(np.ptp(points)) if points.shape[1] else 1.0
    from scipy.spatial import ConvexHull

    return float(ConvexHull(points).volume)
