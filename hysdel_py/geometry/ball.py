"""Greatest balls inside polyhedra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.lp import LpResult, LpStatus, maximise
from hysdel_py.geometry.precision import Precision
from hysdel_py.geometry.small_programs import are_small, greatest_radius

__all__ = ["LARGEST_RADIUS", "Ball", "greatest_ball"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

LARGEST_RADIUS = 1e6
"""Usual radius at which the search for an inscribed ball stops in a polyhedron that holds balls of any size."""


@dataclass(frozen=True, eq=False, slots=True)
class Ball:
    """A greatest ball inside a polyhedron.

    Attributes
    ----------
    centre : array of shape (n,)
    radius : float
        Zero for a flat polyhedron; negative for an empty one: by how much all rows must move outwards to let a point
        in.
    """

    centre: Vector
    radius: float


def greatest_ball(A: Matrix, b: Vector, precision: Precision, most: float = LARGEST_RADIUS) -> Ball:
    """A greatest ball in ``{w : A w <= b}`` (Boyd and Vandenberghe, "Convex optimization", 2004, section 8.5.1).

    Parameters
    ----------
    A : array of shape (m, n)
    b : array of shape (m,)
    precision : Precision
    most : float
        Radius at which the search stops in a polyhedron that holds balls of any size.
    """
    if are_small(len(b), A.shape[1] + 1):
        small = greatest_radius(A, b, most, precision.lp)
        if small is not None:
            return Ball(small[:-1], float(small[-1]))
    n, lengths = A.shape[1], np.linalg.norm(A, axis=1)
    if float(np.min(b[lengths == 0], initial=np.inf)) < -precision.touch:
        return Ball(np.zeros(n), -LARGEST_RADIUS)
    G, h, lengths = A[lengths > 0], b[lengths > 0], lengths[lengths > 0]
    if not len(h) or not n:
        return Ball(np.zeros(n), most)
    rows = np.column_stack([G / lengths[:, None], np.ones(len(h))])
    answer = _largest(rows, h / lengths, np.inf, precision)
    if answer.status is LpStatus.UNBOUNDED:
        answer = _largest(rows, h / lengths, most, precision)
    return Ball(answer.w[:-1], float(answer.w[-1])) if answer.is_optimal else Ball(np.zeros(n), -np.inf)


def _largest(rows: Matrix, sides: Vector, radius: float, precision: Precision) -> LpResult:
    """Centre and radius of a greatest ball whose radius is bounded."""
    free = np.append(np.full(rows.shape[1] - 1, np.inf), radius)
    return maximise(np.append(np.zeros(len(free) - 1), 1.0), rows, sides, -free, free, precision=precision)
