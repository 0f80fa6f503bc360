"""How two polyhedra lie to each other, and what they make together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.lp import LpStatus
from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["are_equal", "common_facet", "includes", "minkowski_sum", "pontryagin_difference", "share_boundary"]

Matrix = NDArray[np.float64]

_MOST_SUMS = 20_000
"""Up to this many sums of two vertices the Minkowski sum is a convex hull; beyond, a projection."""
_EASY_HULL = 4
"""Up to this dimension a convex hull of many points costs little."""


def includes(outer: Polyhedron, inner: Polyhedron, tolerance: float | None = None) -> bool:
    """Whether every point of a polyhedron lies in another one.

    Parameters
    ----------
    outer, inner : Polyhedron
        Of the same dimension of space.
    tolerance : float, optional
        By how much rows of unit length may be exceeded, relative to 1 and their sides; the precision of the outer
        polyhedron by default.
    """
    _check_spaces(outer, inner)
    if inner.is_empty:
        return True
    allowed = outer.precision.empty if tolerance is None else tolerance
    rows = outer.normalised()
    return all(_within(inner, a, b + allowed * (1.0 + abs(b))) for a, b in zip(rows.A, rows.b, strict=True))


def _within(inner: Polyhedron, a: Matrix, side: float) -> bool:
    answer = inner.maximise(a)
    return answer.status is LpStatus.INFEASIBLE or (answer.is_optimal and answer.value <= side)


def are_equal(first: Polyhedron, second: Polyhedron, tolerance: float | None = None) -> bool:
    """Whether two polyhedra are the same set."""
    return includes(first, second, tolerance) and includes(second, first, tolerance)


def pontryagin_difference(outer: Polyhedron, inner: Polyhedron) -> Polyhedron:
    """``{w : w + v is in the outer polyhedron for every v of the inner one}``.

    Each row moves inwards by the support of the inner polyhedron (I. Kolmanovsky and E. G. Gilbert, "Theory and
    computation of disturbance invariant sets for discrete-time linear systems", Mathematical Problems in Engineering 4,
    1998).
    """
    _check_spaces(outer, inner)
    if inner.is_empty:
        raise ArgumentError("the set that is taken away is empty: every point would remain")
    support = [inner.maximise(a) for a in outer.A]
    if any(not answer.is_optimal for answer in support):
        return Polyhedron.empty(outer.n, outer.precision)
    return Polyhedron(outer.A, outer.b - np.array([answer.value for answer in support]), outer.precision)


def minkowski_sum(first: Polyhedron, second: Polyhedron) -> Polyhedron:
    """``{v + w : v in the first, w in the second polyhedron}``."""
    _check_spaces(first, second)
    if first.is_empty or second.is_empty:
        return Polyhedron.empty(first.n, first.precision)
    if first.n <= _EASY_HULL:
        ours, theirs = first.generators, second.generators
        if len(ours.points) * len(theirs.points) <= _MOST_SUMS:
            points = (ours.points[:, None] + theirs.points[None]).reshape(-1, first.n)
            rays, lines = np.vstack([ours.rays, theirs.rays]), np.vstack([ours.lines, theirs.lines])
            return Polyhedron.hull(points, rays, lines, first.precision)
    return _projected_sum(first, second)


def _projected_sum(first: Polyhedron, second: Polyhedron) -> Polyhedron:
    """Shadow of ``{(s, v) : v in the first, s - v in the second}`` in s."""
    n = first.n
    A = np.vstack([np.hstack([np.zeros((first.m, n)), first.A]), np.hstack([second.A, -second.A])])
    return Polyhedron(A, np.concatenate([first.b, second.b]), first.precision).project(range(n))


def share_boundary(first: Polyhedron, second: Polyhedron) -> bool:
    """Whether two polyhedra with disjoint interiors have a piece of a facet in common."""
    _check_spaces(first, second)
    both = first & second
    return both.dimension == first.n - 1


def common_facet(first: Polyhedron, second: Polyhedron) -> tuple[int, int] | None:
    """The row of each whose facets are the same set, if there are such rows."""
    _check_spaces(first, second)
    if not share_boundary(first, second):
        return None
    both = first & second
    ours = [i for i in range(first.m) if _is_facet(first, i, both)]
    theirs = [j for j in range(second.m) if _is_facet(second, j, both)]
    return (ours[0], theirs[0]) if ours and theirs else None


def _is_facet(polyhedron: Polyhedron, row: int, piece: Polyhedron) -> bool:
    """Whether a piece of the boundary is the whole facet of a row."""
    facet = polyhedron.facet(row)
    return facet.dimension == polyhedron.n - 1 and are_equal(facet, piece)


def _check_spaces(first: Polyhedron, second: Polyhedron) -> None:
    if first.n != second.n:
        raise ArgumentError(f"both polyhedra must have the same number of coordinates; found {first.n} and {second.n}")
