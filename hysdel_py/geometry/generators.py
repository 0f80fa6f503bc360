"""Vertices, rays and lines of a polyhedron, and the rows of a convex hull.

Around an inner point the polyhedron ``{v : G v <= h}`` with ``h > 0`` is the polar of the points ``g_i / h_i``. A facet
``n'x <= 1`` of their convex hull with the origin is a vertex ``n`` of the polyhedron, a facet ``n'x <= 0`` an extreme
ray ``n`` (G. M. Ziegler, "Lectures on polytopes", 1995, section 2.3). Qhull computes that hull. The rows of a convex
hull are found by the same step applied to its polar.

Where there are few of them the generators are the extreme rays of the cone ``{(t, v) : h t - G v >= 0, t >= 0}``, those
with t = 0 being rays and the others points ``v / t``; flat and unbounded polyhedra are no case of their own there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.affine_hull import AffineHull, null_space
from hysdel_py.geometry.cone import points_and_ways, sorted_order
from hysdel_py.geometry.precision import Precision

__all__ = ["Generators", "few_generators_of", "generators_of"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_AT_INFINITY = 1e-10
"""A facet of the polar this close to the origin, relative to the size of the polar, belongs to a ray."""
_SAME = 1e-8
"""Generators closer than this, relative to their size, are one."""
_RANK = 1e-9
_TOLD = 1e-6


@dataclass(frozen=True, eq=False, slots=True)
class Generators:
    """``conv(points) + cone(rays) + span(lines)``, one per row.

    Attributes
    ----------
    points : array of shape (p, n)
        Vertices when there are no lines.
    rays : array of shape (r, n)
        Extreme rays, of unit length.
    lines : array of shape (l, n)
        Orthonormal.
    """

    points: Matrix
    rays: Matrix
    lines: Matrix

    @property
    def is_bounded(self) -> bool:
        """Whether points alone generate the set."""
        return not len(self.rays) and not len(self.lines)


def generators_of(A: Matrix, b: Vector, hull: AffineHull) -> Generators:
    """Generators of ``{w : A w <= b}``.

    Parameters
    ----------
    A : array of shape (m, n)
        Rows of unit length.
    b : array of shape (m,)
    hull : AffineHull
        Of this polyhedron.

    Raises
    ------
    ArgumentError
        If Qhull can't compute the hull of the polar.
    """
    G, h = A[~hull.tight] @ hull.basis, (b - A @ hull.origin)[~hull.tight]
    lines = null_space(G, _RANK)
    across = _complement(lines, hull.dimension)
    points, rays = _pointed(G @ across, h)
    frame = hull.basis @ across
    return Generators(
        hull.origin + points @ frame.T, _unit(rays @ frame.T), np.ascontiguousarray((hull.basis @ lines).T)
    )


def few_generators_of(A: Matrix, b: Vector, inside: Vector, precision: Precision) -> Generators | None:
    """Generators of ``{w : A w <= b}`` where they are few and the numbers leave no doubt, else None.

    Parameters
    ----------
    A : array of shape (m, n)
    b : array of shape (m,)
    inside : array of shape (n,)
        A point that satisfies the rows, an inner one if there is one.
    precision : Precision
    """
    found = points_and_ways(A, b, inside, precision.empty)
    if found is None:
        return None
    points, rays, lines, scale = found
    return Generators(_sorted(points, scale), _sorted(rays, np.ones(len(scale))) if len(rays) else rays, lines)


def _sorted(rows: Matrix, scale: Vector) -> Matrix:
    return np.asarray(rows[sorted_order(rows, scale)] + 0.0)


def _distinct(rows: Matrix, scale: Vector) -> Matrix:
    """Rows in order, of those that are the same in coordinates of the given sizes one each."""
    if not len(rows):
        return rows
    from scipy.spatial import cKDTree

    rows = rows[np.lexsort((rows / scale).round(9).T[::-1])] + 0.0
    scaled = rows / scale
    scaled /= 1.0 + np.abs(scaled).max(axis=1, keepdims=True)
    again = np.ones(len(rows), dtype=bool)
    pairs = cKDTree(scaled).query_pairs(_SAME, p=np.inf, output_type="ndarray")
    again[pairs.max(axis=1)] = False
    return np.asarray(rows[again])


def _complement(lines: Matrix, dimension: int) -> Matrix:
    return null_space(lines.T, _RANK) if lines.shape[1] else np.eye(dimension)


def _unit(rays: Matrix) -> Matrix:
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True)) if len(rays) else rays


def _pointed(G: Matrix, h: Vector) -> tuple[Matrix, Matrix]:
    """Vertices and rays of ``{v : G v <= h}`` with the origin inside and no line."""
    if not G.shape[1]:
        return np.zeros((1, 0)), np.zeros((0, 0))
    scale = _scale(G, h)
    facets = _polar_facets((G * scale) / h[:, None])
    far = facets.offsets <= _AT_INFINITY
    corners = (facets.normals[~far] / facets.offsets[~far, None]) * scale
    _, first = np.unique((corners / scale).round(12), axis=0, return_index=True)  # simplices of one facet are equal
    sharp = _sharpened(G, h, corners[first], facets.rows[~far][first])
    return _distinct(sharp, scale), _distinct(_unit(facets.normals[far] * scale), np.ones(len(scale)))


def _scale(G: Matrix, h: Vector) -> Vector:
    """Sizes of the coordinates that make the polar about round: the distance to the first row along each axis."""
    reach = np.max(np.abs(G) / h[:, None], axis=0)
    return np.asarray(1.0 / np.maximum(reach, np.finfo(float).tiny))


@dataclass(frozen=True, eq=False, slots=True)
class _Facets:
    """Facets of the polar, cut into simplices: unit normals, offsets, and the rows whose points span each."""

    normals: Matrix
    offsets: Vector
    rows: NDArray[np.intp]


def _polar_facets(points: Matrix) -> _Facets:
    """Facets of the convex hull of points and the origin; the origin counts as row -1."""
    everything = np.vstack([np.zeros(points.shape[1]), points])
    if points.shape[1] == 1:
        ends = np.array([[np.argmax(everything)], [np.argmin(everything)]])
        return _Facets(np.array([[1.0], [-1.0]]), np.abs(everything[ends[:, 0], 0]), ends - 1)
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(everything)
    except QhullError as error:
        raise ArgumentError(
            "the vertices of the polyhedron can't be computed: its rows are too nearly dependent, or its size differs "
            "too much between directions; scale the coordinates"
        ) from error
    return _Facets(hull.equations[:, :-1], -hull.equations[:, -1], hull.simplices - 1)


def _sharpened(G: Matrix, h: Vector, corners: Matrix, rows: NDArray[np.intp]) -> Matrix:
    """The vertices at which the rows of one simplex of their facets meet; row -1 is none."""
    if not len(corners):
        return corners
    real = (rows >= 0)[:, :, None]
    active = np.where(real, G[rows], 0.0)
    left = np.where(real[:, :, 0], h[rows] - np.einsum("kij,kj->ki", active, corners), 0.0)
    is_corner = real.all(axis=(1, 2)) & _are_told_by(active)
    move = np.empty_like(corners)
    move[is_corner] = np.linalg.solve(active[is_corner], left[is_corner][:, :, None])[:, :, 0]
    move[~is_corner] = np.einsum("kji,ki->kj", np.linalg.pinv(active[~is_corner], rcond=_RANK), left[~is_corner])
    return np.asarray(corners + move)


def _are_told_by(active: Matrix) -> NDArray[np.bool_]:
    """Whether n rows each are clearly independent, by their determinants over the product of their lengths."""
    return np.asarray(np.abs(np.linalg.det(active)) > _TOLD * np.linalg.norm(active, axis=2).prod(axis=1))
