"""Is a region never best? Upper bounds of the difference of two quadratic values over a polyhedron.

All in parameters scaled to [-1, 1]. A quadratic form is the sum of a convex and a concave part along its eigenvectors.
Along a direction of the convex part it lies below the chord between the ends of the polyhedron; the concave part lies
below any tangent. So linear programs give upper bounds, and the bounds of these programs are proven by their
multipliers. A polyhedron for which this is not enough is halved, a few times.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.hybrid_sequences import TIE
from hysdel_py.geometry.lp import LpResult, maximise
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.parametric.cover import Rows, point_inside, uncovered_point
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Region", "Scale", "is_never_best", "meet", "scale_of", "upper_bound"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_ROOM = 1e-7
"""Regions meet if they have a ball of this radius in common."""

_HALVES = 8
"""Most parts of a polyhedron over which a difference is bounded."""

_TANGENTS = 3
_SAMPLES = 24
_SEED = 7


@dataclass(frozen=True, slots=True, eq=False)
class Scale:
    """``theta = centre + half s``."""

    centre: Vector
    half: Vector


def scale_of(domain: Polyhedron) -> Scale:
    """Scale that brings a domain into [-1, 1]."""
    low, high = domain.bounding_box
    return Scale((low + high) / 2, (high - low) / 2)


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """A region with its value ``1/2 s'P s + q's + r`` in scaled parameters.

    Attributes
    ----------
    sequence, number : int
        Where it comes from.
    rows : pair of arrays
        Of length one.
    P, q, r : value
    low, high : arrays
        Bounding box.
    scale : Scale
    """

    sequence: int
    number: int
    rows: Rows
    P: Matrix
    q: Vector
    r: float
    low: Vector
    high: Vector
    scale: Scale

    @classmethod
    def of(cls, law: ExplicitLaw, sequence: int, number: int, scale: Scale) -> Region:
        """One region of a law."""
        centre, half = scale.centre, scale.half
        A, b = law.rows(number)
        N, h = A * half, b - A @ centre
        length = np.linalg.norm(N, axis=1)
        rows = N / length[:, None], h / length
        P, q, r = law.P[number], law.q[number], float(law.r[number])
        low, high = Polyhedron(*rows).bounding_box
        value = 0.5 * centre @ P @ centre + q @ centre + r
        return cls(
            sequence, number, rows, P * np.outer(half, half), half * (q + P @ centre), float(value), low, high, scale
        )

    def unscaled(self, rows: Rows) -> Rows:
        """Rows over the parameters themselves."""
        A = rows[0] / self.scale.half
        b = rows[1] + A @ self.scale.centre
        length = np.linalg.norm(A, axis=1)
        return A / length[:, None], b / length

    def value(self, points: Matrix) -> Vector:
        """Values at some points, one per row."""
        return np.asarray(0.5 * ((points @ self.P) * points).sum(axis=1) + points @ self.q + self.r)


def meet(one: Region, other: Region) -> bool:
    """Whether two regions have inner points in common."""
    if not _boxes_meet(one, other):
        return False
    return point_inside(_common(one.rows, other.rows), _ROOM, MpQpSettings()) is not None


def is_never_best(region: Region, rivals: list[Region]) -> bool:
    """Whether rivals that are proven to be nowhere worse cover a region.

    Points of the region at which it wins end the question without any program. A few points tell which rivals are
    worth a proof, those that hold most of them first, and that there is no hope once no rival is left for one of them.
    """
    settings = MpQpSettings()
    points = _points(region)
    near = [rival for rival in rivals if _boxes_meet(region, rival)]
    if _wins_somewhere(region, near, points):
        return False
    left = _candidates(region, near, points)
    proven: list[Region] = []
    found = np.zeros(_SAMPLES + 1, dtype=bool)
    while left and np.logical_or.reduce([found, *(inside for _, inside in left)]).all():
        rival, inside = left.pop(0)
        if not _is_nowhere_worse(rival, region):
            continue
        proven.append(rival)
        found = found | inside
        if found.all() and uncovered_point(region.rows, [p.rows for p in proven], _ROOM, settings) is None:
            return True
    return False


def _wins_somewhere(region: Region, rivals: list[Region], points: Matrix) -> bool:
    """Whether at one of some points no rival that holds it is as good: nothing can cover the region then."""
    beaten = np.zeros(len(points), dtype=bool)
    most = _up_to_a_tie(region.value(points))
    for rival in rivals:
        N, h = rival.rows
        left = np.flatnonzero(~beaten)
        if not len(left):
            return False
        inside = np.all(points[left] @ N.T <= h + _ROOM, axis=1)
        beaten[left] = inside & (rival.value(points[left]) <= most[left])
    return not bool(beaten.all())


def _up_to_a_tie(values: Vector) -> Vector:
    return np.asarray(values + TIE * np.maximum(1.0, np.abs(values)))


def _boxes_meet(one: Region, other: Region) -> bool:
    return not (np.any(one.low > other.high - _ROOM) or np.any(other.low > one.high - _ROOM))


def _candidates(region: Region, rivals: list[Region], points: Matrix) -> list[tuple[Region, NDArray[np.bool_]]]:
    """Rivals that are nowhere worse at some points, and which of the points they hold."""
    most = _up_to_a_tie(region.value(points))
    found = []
    for rival in rivals:
        N, h = rival.rows
        inside = np.all(points @ N.T <= h, axis=1)
        if np.all(rival.value(points[inside]) <= most[inside]) and meet(region, rival):
            found.append((rival, inside))
    return sorted(found, key=lambda entry: -int(entry[1].sum()))


def _points(region: Region) -> Matrix:
    """Points of a region by a walk along chords in fixed random directions."""
    N, h = region.rows
    settings = MpQpSettings()
    start = next(
        (p for m in settings.margins if (p := point_inside(region.rows, float(m), settings)) is not None), None
    )
    if start is None:
        start = np.zeros(N.shape[1])  # in no region: nothing will be removed
    rng = np.random.default_rng(_SEED)
    points = [start]
    for _ in range(_SAMPLES):
        direction = rng.normal(size=N.shape[1])
        speed, room = N @ direction, np.maximum(h - N @ points[-1], 0.0)
        low = np.max(room[speed < 0] / speed[speed < 0], initial=-np.inf)
        high = np.min(room[speed > 0] / speed[speed > 0], initial=np.inf)
        points.append(points[-1] + rng.uniform(low, high) * direction)
    return np.array(points)


def _is_nowhere_worse(rival: Region, region: Region) -> bool:
    """Whether a rival's value is proven not to exceed that of a region on what they have in common."""
    P, q, r = rival.P - region.P, rival.q - region.q, rival.r - region.r
    size = max(1.0, abs(region.r), float(np.abs(region.q).max(initial=0.0)))
    pending = [_common(region.rows, rival.rows)]
    for _ in range(_HALVES):
        if not pending:
            return True
        rows = pending.pop()
        bound, widest = upper_bound((P, q, r), rows)
        if bound <= TIE * size:
            continue
        if widest is None:
            return False
        pending += _halves(rows, *widest)
    return not pending


def upper_bound(form: tuple[Matrix, Vector, float], rows: Rows) -> tuple[float, tuple[Vector, float] | None]:
    """Upper bound of ``1/2 s'P s + q's + r`` over a polyhedron, and the cut that makes its chords shorter, if any.

    Minus infinity if the polyhedron is proven to be empty.
    """
    P, q, r = form
    ball = Polyhedron(*rows).ball
    if ball.radius < -_ROOM:
        return -np.inf, None
    weights, directions = np.linalg.eigh(P)
    negligible = 1e-14 * float(np.abs(weights).max(initial=0.0))
    slope, constant, gaps = q.copy(), r, []
    for weight, direction in zip(weights, directions.T, strict=True):
        if weight > negligible:
            low, high = -_greatest(-direction, rows).bound, _greatest(direction, rows).bound
            slope, constant = slope + weight * (low + high) / 2 * direction, constant - weight * low * high / 2
            gaps.append((weight * (high - low) ** 2, direction, (low + high) / 2))
    concave = (directions * np.minimum(weights, 0.0)) @ directions.T
    at, least = ball.centre, np.inf
    for _ in range(_TANGENTS):
        answer = _greatest(slope + concave @ at, rows)
        least = min(least, float(answer.bound + constant - 0.5 * at @ concave @ at))
        if not answer.is_optimal:
            break
        at = (at + answer.w) / 2
    widest = max(gaps, key=lambda gap: gap[0], default=None)
    return least, None if widest is None else (widest[1], float(widest[2]))


def _greatest(direction: Vector, rows: Rows) -> LpResult:
    """Support function, with a bound that the box of the scaled parameters makes finite."""
    end = np.full(len(direction), 1.0 + _ROOM)
    return maximise(direction, *rows, -end, end)


def _halves(rows: Rows, direction: Vector, middle: float) -> list[Rows]:
    N, h = rows
    return [(np.vstack([N, sign * direction]), np.append(h, sign * middle)) for sign in (1.0, -1.0)]


def _common(one: Rows, other: Rows) -> Rows:
    return np.vstack([one[0], other[0]]), np.concatenate([one[1], other[1]])
