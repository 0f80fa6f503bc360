"""Rows of a convex hull of points, rays and lines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.affine_hull import AffineHull, affine_hull
from hysdel_py.geometry.cone import across, cone_of, orthonormal
from hysdel_py.geometry.generators import generators_of
from hysdel_py.geometry.precision import Precision

__all__ = ["hull_rows", "hull_volume"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_LOST = 1e-9
"""A coordinate with less than this in all rows of unit length is lost in linear programs: the set has no end there."""

_NO_ROW = 1e-10
"""A vertex of the polar this close to the origin, relative to the farthest one, gives no row."""


def hull_rows(points: Matrix, rays: Matrix, lines: Matrix, precision: Precision) -> tuple[Matrix, Vector]:
    """Rows ``A w <= b`` of ``conv(points) + cone(rays) + span(lines)``; equalities are pairs of opposite rows.

    Parameters
    ----------
    points : array of shape (p, n), p >= 1
    rays : array of shape (r, n)
    lines : array of shape (l, n)

    Raises
    ------
    ArgumentError
        The size of the points differs too much between the coordinates.
    """
    n = points.shape[1]
    if not n:
        return np.zeros((0, 0)), np.zeros(0)
    middle, sizes = points.mean(axis=0), _sizes(points, precision)
    shifted, directions, axes = (points - middle) / sizes, _unit(rays / sizes), _unit(lines / sizes)
    found = _few_rows(shifted, directions, axes)
    rows, sides = _many_rows(shifted, directions, axes, precision) if found is None else found
    A = rows / sizes
    lengths = np.linalg.norm(A, axis=1)
    A, b = A / lengths[:, None], (sides + A @ middle) / lengths
    if not len(rays) and not len(lines) and np.min(np.max(np.abs(A), axis=0, initial=0.0)) < _LOST:
        raise ArgumentError(
            f"the hull of points whose coordinates spread by {np.ptp(points, axis=0)} can't be told by rows: scale the "
            "coordinates"
        )
    return A, b


def _few_rows(points: Matrix, rays: Matrix, lines: Matrix) -> tuple[Matrix, Vector] | None:
    """Rows of ``conv(points) + cone(rays) + span(lines)`` around the origin; None as of :func:`cone_of`.

    The rows ``a'w <= b`` that hold for all generators are a cone; its extreme rays are the facets, its lines equalities.
    """
    n = points.shape[1]
    H = np.zeros((len(points) + len(rays) + 2 * len(lines), n + 1))
    H[: len(points), 0] = 1.0
    H[:, 1:] = -np.vstack([points, rays, lines, -lines])
    cone = cone_of(H / np.sqrt(np.einsum("ij,ij->i", H, H))[:, None])
    if cone is None:
        return None
    equal = orthonormal(cone.lines[:, 1:])
    facets = across(cone.rays[:, 1:], equal)
    real = np.einsum("ij,ij->i", facets, facets) > _NO_ROW**2
    facets, sides = facets[real], cone.rays[real, 0]
    order = _order(facets, sides - facets @ rays.sum(axis=0))
    rows = np.vstack([facets[order], equal, -equal])
    return rows, np.concatenate([sides[order], np.zeros(2 * len(equal))])


def _order(facets: Matrix, sides: Vector) -> NDArray[np.intp]:
    """Order of the rows, by the points of the polar around an inner point."""
    polar = facets / np.where(sides > 0, sides, 1.0)[:, None]
    return np.lexsort(polar.round(9).T[::-1]) if len(facets) else np.zeros(0, dtype=np.intp)


def _many_rows(points: Matrix, directions: Matrix, lines: Matrix, precision: Precision) -> tuple[Matrix, Vector]:
    """The same by the vertices of the polar.

    The rows of the set moved so that the origin is inside are the generators of its polar ``{a : p'a <= 1, r'a <= 0,
    l'a = 0}``: a vertex gives ``a'w <= 1``, a line ``a'w = 0``. The origin is inside, hence the polar has no rays.
    """
    inner = directions.sum(axis=0)
    polar = generators_of(*_polar(points - inner, directions, lines, precision))
    rows = np.vstack([polar.points, polar.lines, -polar.lines])
    sides = np.concatenate([np.ones(len(polar.points)), np.zeros(2 * len(polar.lines))]) + rows @ inner
    lengths = np.linalg.norm(rows, axis=1)
    real = lengths > _NO_ROW * np.max(lengths, initial=0.0)  # the origin is a vertex of the polar of an unbounded set
    return rows[real], sides[real]


def _sizes(points: Matrix, precision: Precision) -> Vector:
    """Size of the points along each coordinate; where they are flat, that of all of them, or 1 for a single point.

    With one size for all coordinates a set that is thin in one of them would be taken for flat.
    """
    away = np.max(np.abs(points - points.mean(axis=0)), axis=0)
    noise = np.finfo(float).eps * np.max(np.abs(points), axis=0)
    whole = float(np.max(away))
    if whole <= float(np.max(noise)):
        return np.ones(points.shape[1])
    return np.where(away > np.maximum(precision.empty, noise), away, whole)


def _unit(rows: Matrix) -> Matrix:
    """Rows of unit length, without those of none."""
    lengths = np.linalg.norm(rows, axis=1)
    return np.asarray(rows[lengths > 0] / lengths[lengths > 0, None])


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
