"""One box for many pieces of a set of states, and how much of it holds none of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hysdel_py.analysis.hybrid_set import Piece
from hysdel_py.analysis.reach_images import greatest
from hysdel_py.analysis.templates import boxes
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.sampling import spread_points

__all__ = ["box_around", "empty_share"]

_POINTS = 2000


def box_around(group: Sequence[Piece]) -> Polyhedron:
    """The least box around some pieces."""
    box = boxes(group[0].region.n)
    sides = [[greatest(piece.region, row) for row in box] for piece in group]
    return Polyhedron(box, np.max(sides, axis=0))


def empty_share(box: Polyhedron, group: Sequence[Piece]) -> float:
    """Share of a box that lies in none of some pieces, by points that fill it evenly; 1 for an unbounded box.

    Pieces without inner points hold none of the points.
    """
    low, high = -box.b[box.n :], box.b[: box.n]
    if not np.isfinite(high - low).all():
        return 1.0
    left = low + spread_points(_POINTS, box.n) * (high - low)
    for piece in group:
        inside = np.all(left @ piece.region.A.T <= piece.region.b, axis=1)
        left = left[~inside]
    return len(left) / _POINTS
