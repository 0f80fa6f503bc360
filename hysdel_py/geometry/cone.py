"""Extreme rays and lines of cones, and with them vertices, rays and lines of polyhedra, where they are few."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import kernels_are_compiled

__all__ = ["Cone", "across", "cone_of", "orthonormal", "points_and_ways", "sorted_order"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_MOST_RAYS = 300
"""With more rays than this Qhull takes less time."""
_MOST_WORK = 3e5
_MOST_ROWS, _MOST_ROWS_PLAIN = 1000, 12
_MISS = 1e-10
"""A vertex that misses a row by more than this is none, and the method has gone astray."""


@dataclass(frozen=True, eq=False, slots=True)
class Cone:
    """``cone(rays) + span(lines)``, one per row.

    Attributes
    ----------
    rays : array of shape (k, d)
        Extreme ones, of unit length.
    lines : array of shape (l, d)
        Independent, of unit length.
    bits : array of shape (k, w) of uint64
        The rows that each ray fulfils with equality.
    """

    rays: Matrix
    lines: Matrix
    bits: NDArray[np.uint64]


def cone_of(H: Matrix) -> Cone | None:
    """Generators of ``{z : H z >= 0}``; None if the numbers leave them in doubt, or if there are many.

    Parameters
    ----------
    H : array of shape (m, d)
        Rows of about unit length.
    """
    from hysdel_py.geometry.kernels.double_description import extreme_rays  # numba is loaded with kernels

    m, d = H.shape
    if m > (_MOST_ROWS if kernels_are_compiled() else _MOST_ROWS_PLAIN):
        return None
    lines, rays = np.empty((d, d)), np.empty((_MOST_RAYS, d))
    bits = np.zeros((_MOST_RAYS, (m + 63) // 64), np.uint64)
    room = np.empty(_MOST_RAYS), np.empty(_MOST_RAYS, np.int64), np.empty((_MOST_RAYS, 2), np.int64)
    count = extreme_rays(H, _MOST_WORK, lines, rays, bits, *room, np.zeros(m, np.bool_))
    if count < 0:
        return None
    return Cone(rays[:count], lines[: d - int(room[1][0])], bits[:count])


def sorted_order(rows: Matrix, scale: Vector) -> NDArray[np.int64]:
    """Order of rows, as far as nine digits of those in coordinates of the given sizes tell."""
    if len(rows) > _MOST_RAYS or not kernels_are_compiled():
        return np.lexsort((rows / scale).round(9).T[::-1])
    from hysdel_py.geometry.kernels.homogeneous import sort

    order = np.empty(len(rows), np.int64)
    sort(np.array(rows, order="C"), np.array(scale), order)
    return order


def across(rows: Matrix, lines: Matrix) -> Matrix:
    """What is left of rows without their parts along orthonormal lines."""
    return np.asarray(rows - (rows @ lines.T) @ lines) if len(lines) else rows


def orthonormal(lines: Matrix) -> Matrix:
    """Orthonormal rows with the same span as independent ones."""
    return np.asarray(np.linalg.qr(lines.T)[0].T) if len(lines) else lines


def points_and_ways(A: Matrix, b: Vector, inside: Vector, least: float) -> tuple[Matrix, Matrix, Matrix, Vector] | None:
    """Points, rays and lines of ``{w : A w <= b}``, and the sizes of its coordinates; None as of :func:`cone_of`.

    Parameters
    ----------
    A : array of shape (m, n)
    b : array of shape (m,)
    inside : array of shape (n,)
        A point of the polyhedron, an inner one if there is one.
    least : float
        Rows of unit length with less room at a point of the set, but more than rounding errors, leave a doubt.
    """
    if not kernels_are_compiled():
        return None  # Qhull takes less time than the loops
    rows, sides, n = np.array(A, order="C"), np.array(b), A.shape[1]
    found = _around(rows, sides, np.array(inside), np.ones(n), least)
    if found is None or not len(found[1]) or len(found[0]) < 2:
        return found
    points, rays, _, _ = found  # of an unbounded set the vertices tell where its middle is
    sizes = np.ptp(points, axis=0)
    middle = points.mean(axis=0) + sizes.max() * rays.mean(axis=0)
    return _around(rows, sides, middle, np.where(sizes > least, sizes, sizes.max()), least)


def _around(
    A: Matrix, b: Vector, point: Vector, scale: Vector, least: float
) -> tuple[Matrix, Matrix, Matrix, Vector] | None:
    """The same from a point of the set and about the sizes of its coordinates, which both change."""
    from hysdel_py.geometry.kernels.homogeneous import generated, homogeneous

    m, n = A.shape
    H = np.empty((m + 1, n + 1))
    if not homogeneous(A, b, least, point, scale, np.empty(m), H):
        return None
    cone = cone_of(H)
    if cone is None:
        return None
    count = len(cone.rays)
    found, is_ray = np.empty((count, n)), np.empty(count, np.bool_)
    vertices = generated(A, b, point, scale, cone.rays, cone.bits, count, _MISS, found, is_ray)
    if vertices < 0:
        return None
    lines = orthonormal(cone.lines[:, 1:] * scale)
    if vertices == count and not len(lines):
        return found, found[:0], lines, scale
    points, rays = point + across(found[~is_ray] - point, lines), across(found[is_ray], lines)
    return points, rays / np.linalg.norm(rays, axis=1, keepdims=True), lines, scale
