"""Whether polyhedra cover another one, and a point that they leave out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.facets import inner_point
from hysdel_py.optimize.parametric.nearest import FOUND
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Rows", "parts_outside", "point_inside", "uncovered_point"]

Vector = NDArray[np.float64]
Rows = tuple[NDArray[np.float64], Vector]


def point_inside(rows: Rows, margin: float, settings: MpQpSettings, guess: Vector | None = None) -> Vector | None:
    """A point of ``{x : N x <= h}``, rows of length one, that keeps a distance from all rows; None without one."""
    N, h = map(np.array, rows)  # copies: kernels are compiled anew for read-only arrays
    start = np.zeros(N.shape[1]) if guess is None else np.array(guess)
    margins = np.array([margin])
    status, point = inner_point(N, h, start, margins, settings.violation, settings.angle)
    return point if status == FOUND else None


def uncovered_point(rows: Rows, covers: Sequence[Rows], margin: float, settings: MpQpSettings) -> Vector | None:
    """A point of a polyhedron that is in no cover and has room around it, or None.

    What a cover leaves is cut into the parts that violate one of its rows and keep those before it.
    """
    pending = [(rows, 0)]
    while pending:
        piece, number = pending.pop()
        point = point_inside(piece, margin, settings)
        if point is None:
            continue
        if number == len(covers):
            return point
        if _apart(piece, covers[number], margin, point, settings):
            pending.append((piece, number + 1))
        else:
            pending += [(part, number + 1) for part in parts_outside(piece, covers[number])]
    return None


def _apart(rows: Rows, cover: Rows, margin: float, point: Vector, settings: MpQpSettings) -> bool:
    """Whether a cover has nothing in common with a polyhedron, so that it need not be cut."""
    both = np.vstack([rows[0], cover[0]]), np.concatenate([rows[1], cover[1]])
    return point_inside(both, margin, settings, point) is None


def parts_outside(rows: Rows, cover: Rows) -> list[Rows]:
    """What a polyhedron has outside a cover, cut into parts that violate one row of it and keep those before it."""
    N, h = cover
    return [
        (np.vstack([rows[0], N[:row], -N[row : row + 1]]), np.concatenate([rows[1], h[:row], -h[row : row + 1]]))
        for row in range(len(h))
    ]
