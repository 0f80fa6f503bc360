"""Rows of a convex hull of points, rays and lines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.affine_hull import AffineHull, affine_hull
from hysdel_py.geometry.cone import across, cone_of, orthonormal, sorted_order
from hysdel_py.geometry.generators import generators_of
from hysdel_py.geometry.precision import Precision

__all__ = ["hull_rows", "hull_volume"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_LOST = 1e-9
"""A coordinate with less than this in all rows of unit length is lost in linear programs: the set has no end there."""

_FEW_POINTS = 40
_THINNEST = 1e-12
"""Points that are thinner than this along some direction, relative to their size, are left to Qhull."""

_ROUNDING = 1e-14
"""What coordinates of points are off by, relative to the greatest."""

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
    from hysdel_py.geometry.kernels.homogeneous import dual  # numba is loaded with kernels

    middle, sizes, H = np.empty(n), np.empty(n), np.empty((len(points) + len(rays) + 2 * len(lines), n + 1))
    dual(
        np.array(points, order="C"),
        np.array(rays, order="C"),
        np.array(lines, order="C"),
        precision.empty,
        middle,
        sizes,
        H,
    )
    found = _few_rows(H, len(points), len(rays))
    if found is None and len(points) == len(H) <= _FEW_POINTS:
        found = _rows_of_sliver(H, _ROUNDING * np.abs(points).max(axis=0) / sizes)
    rows, sides = _many_rows(H, len(points), len(rays), len(lines), precision) if found is None else found
    A = rows / sizes
    lengths = np.sqrt(np.einsum("ij,ij->i", A, A))
    A, b = A / lengths[:, None], (sides + A @ middle) / lengths
    if not len(rays) and not len(lines) and len(A) and np.abs(A).max(axis=0).min() < _LOST:
        raise ArgumentError(
            f"the hull of points whose coordinates spread by {np.ptp(points, axis=0)} can't be told by rows: scale the "
            "coordinates"
        )
    return A, b


def _few_rows(H: Matrix, points: int, rays: int) -> tuple[Matrix, Vector] | None:
    """Rows of the hull in round coordinates; None as of :func:`cone_of`.

    The rows ``a'w <= b`` that hold for all generators are a cone: its extreme rays are facets, its lines equalities.
    """
    cone = cone_of(H)
    if cone is None:
        return None
    equal = orthonormal(cone.lines[:, 1:])
    facets, sides = across(cone.rays[:, 1:], equal), cone.rays[:, 0]
    real = np.einsum("ij,ij->i", facets, facets) > _NO_ROW**2
    if not real.all():
        facets, sides = facets[real], sides[real]
    inner = sides + facets @ H[points : points + rays, 1:].sum(axis=0) if rays else sides
    order = sorted_order(facets / inner[:, None], np.ones(facets.shape[1]))  # that of the points of the polar
    if not len(equal):
        return facets[order], sides[order]
    return np.vstack([facets[order], equal, -equal]), np.concatenate([sides[order], np.zeros(2 * len(equal))])


def _rows_of_sliver(H: Matrix, rounding: Vector) -> tuple[Matrix, Vector] | None:
    """As :func:`_few_rows`, in the principal axes of the points, which are thin along one that is no coordinate.

    Points that are as thin as the rounding of their coordinates are flat, and not for here.
    """
    shifted = H[:, 1:] / H[:, :1]
    _, sizes, axes = np.linalg.svd(shifted, full_matrices=False)
    if len(sizes) < H.shape[1] - 1 or sizes[-1] <= max(_THINNEST * sizes[0], rounding @ np.abs(axes[-1])):
        return None
    turned = np.column_stack([np.ones(len(H)), shifted @ axes.T / sizes])
    found = _few_rows(turned / np.sqrt(np.einsum("ij,ij->i", turned, turned))[:, None], len(H), 0)
    return None if found is None else ((found[0] / sizes) @ axes, found[1])


def _many_rows(H: Matrix, points: int, rays: int, lines: int, precision: Precision) -> tuple[Matrix, Vector]:
    """The same by the vertices of the polar.

    The rows of the set moved so that the origin is inside are the generators of its polar ``{a : p'a <= 1, r'a <= 0,
    l'a = 0}``: a vertex gives ``a'w <= 1``, a line ``a'w = 0``. The origin is inside, hence the polar has no rays.
    """
    directions, axes = -H[points : points + rays, 1:], -H[points + rays : points + rays + lines, 1:]
    inner = directions.sum(axis=0)
    shifted = -H[:points, 1:] / H[:points, :1] - inner
    polar = generators_of(*_polar(shifted, _unit(directions), _unit(axes), precision))
    rows = np.vstack([polar.points, polar.lines, -polar.lines])
    sides = np.concatenate([np.ones(len(polar.points)), np.zeros(2 * len(polar.lines))]) + rows @ inner
    lengths = np.linalg.norm(rows, axis=1)
    real = lengths > _NO_ROW * np.max(lengths, initial=0.0)  # the origin is a vertex of the polar of an unbounded set
    return rows[real], sides[real]


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
