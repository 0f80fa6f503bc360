"""Points at which every way to compute a law must give the same move: away from borders, and outside the map."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.errors import ArgumentError
from hysdel_py.export.law_number import Scaling

__all__ = ["ReplayPoints", "far_from_borders", "replay_points"]

Array = NDArray[np.float64]

_LEAST = 1e-6
"""Points are at least so far from every facet."""

_WIDER = 0.3
"""Share of its size by which the box around the domain is widened for points outside."""

_TRIES = 20
"""Points drawn for each one that is kept."""


@dataclass(frozen=True, eq=False, slots=True)
class ReplayPoints:
    """Points with the moves that Python finds.

    Attributes
    ----------
    zeta : array of shape (n, p)
    u : array of shape (n, moves)
        Not a number outside the map.
    tolerance : array of shape (moves,)
        What rounding may change.
    """

    zeta: Array
    u: Array
    tolerance: Array


def replay_points(law: ExplicitLaw, scaling: Scaling, count: int, seed: int) -> ReplayPoints:
    """Points well inside single regions, and a quarter outside the map; fewer where regions are thin.

    Raises
    ------
    ArgumentError
        The count or the seed is no whole number, or negative.
    """
    for name, number in (("points", count), ("seed", seed)):
        if not isinstance(number, Integral) or number < 0:
            raise ArgumentError(f"{name} is {number!r}: a whole number, zero or more, was expected")
    if not count:
        return ReplayPoints(np.zeros((0, law.p)), np.zeros((0, law.moves)), np.zeros(law.moves))
    rng = np.random.default_rng(seed)
    margin = max(_LEAST, 2.0 * scaling.margin(law.A, -law.b))
    inside = _kept(law, random_points(law, _TRIES * count if count else 0, rng), margin, inside=True)
    outside = _kept(law, _around(law, _TRIES * count, rng), margin, inside=False)
    quarter = min(count // 4, len(outside))
    zeta = np.vstack([inside[: count - quarter], outside[:quarter]])
    moves = [law(point) for point in zeta]
    u = np.array([np.full(law.moves, np.nan) if move is None else move for move in moves]).reshape(-1, law.moves)
    error = scaling.move_error(law.K[:, : law.moves], law.k[:, : law.moves])
    return ReplayPoints(zeta, u, 2.0 * error)


def far_from_borders(law: ExplicitLaw, points: Array, margin: float) -> NDArray[np.bool_]:
    """Whether each point keeps a distance from all facets: deep in one region and far from the others, or in none."""
    excess = np.array([law.excess(point) for point in points]).reshape(len(points), -1)
    deepest = np.sort(excess, axis=1)[:, :2]
    alone = deepest[:, 1] >= margin if deepest.shape[1] > 1 else np.ones(len(points), dtype=bool)
    return np.asarray(alone & (np.abs(deepest[:, 0]) >= margin))


def _kept(law: ExplicitLaw, points: Array, margin: float, *, inside: bool) -> Array:
    far = points[far_from_borders(law, points, margin)]
    held = np.array([law.locate(point) >= 0 for point in far], dtype=bool)
    return np.asarray(far[held == inside])


def _around(law: ExplicitLaw, count: int, rng: np.random.Generator) -> Array:
    low, high = law.domain.bounding_box
    room = _WIDER * (high - low)
    return np.asarray(rng.uniform(low - room, high + room, (count, law.p)))
