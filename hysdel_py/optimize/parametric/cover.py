"""Whether polyhedra cover another one, and a point that they leave out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.facets import inner_point, inner_point_in
from hysdel_py.optimize.parametric.nearest import FOUND, workspace
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
    N, h = map(np.array, rows)
    starts = np.cumsum([0, *(len(cover[1]) for cover in covers)])
    cuts = np.concatenate([np.empty((0, N.shape[1])), *(cover[0] for cover in covers)])
    ends = np.concatenate([np.empty(0), *(cover[1] for cover in covers)])
    found, point = _uncovered(N, h, cuts, ends, starts, margin, settings.violation, settings.angle)
    return point if found else None


@compiled
def _uncovered(N: Any, h: Any, cuts: Any, ends: Any, starts: Any, margin: float, violation: float, angle: float) -> Any:
    """Whether there is an uncovered point, and the point."""
    margins, work, x, start = np.full(1, margin), workspace(N.shape[1]), np.empty(N.shape[1]), np.zeros(N.shape[1])
    pending = [(N, h, 0)]
    while pending:
        rows, sides, number = pending.pop()
        if inner_point_in(rows, sides, len(sides), start, margins, x, work, violation, angle) != FOUND:
            continue
        if number == len(starts) - 1:
            return True, x
        first, last = starts[number], starts[number + 1]
        point = x.copy()
        rows, sides = np.concatenate((rows, cuts[first:last])), np.concatenate((sides, ends[first:last]))
        kept = len(sides) - (last - first)
        if inner_point_in(rows, sides, len(sides), point, margins, x, work, violation, angle) != FOUND:
            pending.append((rows[:kept].copy(), sides[:kept].copy(), number + 1))
            continue
        for row in range(kept, len(sides)):
            part, limits = rows[: row + 1].copy(), sides[: row + 1].copy()
            part[row], limits[row] = -rows[row], -sides[row]
            pending.append((part, limits, number + 1))
    return False, x


def parts_outside(rows: Rows, cover: Rows) -> list[Rows]:
    """What a polyhedron has outside a cover, cut into parts that violate one row of it and keep those before it."""
    N, h = cover
    return [
        (np.vstack([rows[0], N[:row], -N[row : row + 1]]), np.concatenate([rows[1], h[:row], -h[row : row + 1]]))
        for row in range(len(h))
    ]
