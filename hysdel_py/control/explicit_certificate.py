"""What an explicit law is worth: compared with the problem solved online, and across its facets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import OUTSIDE, Array, ExplicitLaw, Vector
from hysdel_py.control.online_problem import OnlineProblem
from hysdel_py.optimize.mpqp import MpQp
from hysdel_py.optimize.parametric.cover import point_inside
from hysdel_py.optimize.parametric.settings import MpQpSettings
from hysdel_py.optimize.qp import QpStatus

__all__ = ["LawCertificate", "certify", "random_points"]

_STEPS = 20
"""Steps of a random walk between two points that are kept."""


@dataclass(frozen=True, slots=True)
class LawCertificate:
    """Greatest deviations found.

    Attributes
    ----------
    samples : int
        Values of theta that were solved online.
    feasible : int
        Those with a solution.
    missing : int
        Feasible ones that no region holds.
    superfluous : int
        Infeasible or unbounded ones that a region holds by more than the tolerance.
    law_error : float
        Greatest difference of the moves, relative to 1 and their size.
    violation : float
        Greatest violation of the problem's rows by the law, relative to 1 and the side; nan after merging.
    value_error : float
        Greatest difference of the values, relative to 1 and their size; nan for a law without value function.
    form_error : float
        The same for the values that the coefficients P, q, r alone give, as other programs read them from a file.
    overlaps : int
        Values of theta well inside two regions with different moves.
    jump, value_jump : float
        Greatest difference of the moves, and of the values relative to 1 and their size, of two regions at a common
        point of their boundary.
    unique : bool
        Whether H is positive definite, so that the solution is unique and continuous; where it is not, another
        solution is no error and the moves may jump.
    undecided : int
        Values of theta at which the online solver proved nothing.
    """

    samples: int
    feasible: int
    missing: int
    superfluous: int
    law_error: float
    violation: float
    value_error: float
    form_error: float
    overlaps: int
    jump: float
    value_jump: float
    unique: bool
    undecided: int

    def holds(self, accuracy: float = 1e-6) -> bool:
        """Whether nothing is missing, superfluous or doubled and all differences are small.

        An interior-point solution whose value is wrong by a share a may be off by the square root of a where a row is
        weakly active, so that the moves are compared with that; feasibility and value are what proves them.
        """
        clean = not (self.missing or self.superfluous or self.overlaps)
        exact = np.nan_to_num([self.value_error, self.form_error, self.violation, self.value_jump]).max()
        same = not self.unique or (self.jump <= accuracy and self.law_error <= np.sqrt(accuracy))
        return bool(clean and exact <= accuracy and same)


def certify(law: ExplicitLaw, problem: MpQp, samples: int = 200, seed: int = 0) -> LawCertificate:
    """Compare a law with its problem at random parameters, half of them on boundaries of regions.

    Parameters
    ----------
    law : ExplicitLaw
    problem : MpQp
    samples : int
    seed : int
    """
    rng = np.random.default_rng(seed)
    points = random_points(law, samples - samples // 2, rng)
    boundary, jumps = _boundary(law, samples // 2, rng)
    online = OnlineProblem(problem)
    answers = [_Comparison.at(law, online, point) for point in np.vstack([points, boundary])]
    return LawCertificate(
        samples=len(answers),
        feasible=sum(answer.feasible for answer in answers),
        missing=sum(answer.missing for answer in answers),
        superfluous=sum(answer.superfluous for answer in answers),
        law_error=max((answer.law_error for answer in answers), default=0.0),
        violation=max((answer.violation for answer in answers), default=0.0) if law.has_value else np.nan,
        value_error=max((answer.value_error for answer in answers), default=0.0) if law.has_value else np.nan,
        form_error=max((answer.form_error for answer in answers), default=0.0) if law.has_value else np.nan,
        overlaps=sum(_doubled(law, point) for point in points),
        jump=float(jumps[0]),
        value_jump=float(jumps[1]),
        unique=_is_definite(problem),
        undecided=sum(answer.undecided for answer in answers),
    )


@dataclass(frozen=True, slots=True)
class _Comparison:
    """Law and online solution at one point."""

    feasible: bool = False
    missing: bool = False
    superfluous: bool = False
    law_error: float = 0.0
    violation: float = 0.0
    value_error: float = 0.0
    form_error: float = 0.0
    undecided: bool = False

    @classmethod
    def at(cls, law: ExplicitLaw, online: OnlineProblem, theta: Vector) -> _Comparison:
        status, z, value = online.solve(theta)
        region = law.locate(theta)
        if status is QpStatus.OPTIMAL and region == OUTSIDE:
            return cls(feasible=True, missing=float(np.min(law.domain.slack(theta))) > law.tolerance)
        if status is QpStatus.OPTIMAL:
            return cls(
                feasible=True,
                law_error=_move_error(law, region, theta, z),
                violation=_violation(online.problem, law, region, theta) if law.has_value else 0.0,
                value_error=_relative(law.value(theta), value) if law.has_value else 0.0,
                form_error=_relative(_forms(law, theta)[region], value) if law.has_value else 0.0,
            )
        if status in (QpStatus.INFEASIBLE, QpStatus.UNBOUNDED):
            return cls(superfluous=region != OUTSIDE and float(np.min(law.excess(theta))) < -law.tolerance)
        return cls(undecided=True)


def _relative(found: float, true: float) -> float:
    return float(abs(found - true) / max(1.0, abs(true)))


def _forms(law: ExplicitLaw, point: Vector) -> Vector:
    """Value that the coefficients of each region give at a point."""
    return np.asarray(0.5 * (law.P @ point) @ point + law.q @ point + law.r)


def _move_error(law: ExplicitLaw, region: int, theta: Vector, z: Vector) -> float:
    own = law.K[region, : law.moves] @ theta + law.k[region, : law.moves]
    return float(np.max(np.abs(own - z[: law.moves]))) / max(1.0, float(np.max(np.abs(own))))


def _violation(problem: MpQp, law: ExplicitLaw, region: int, theta: Vector) -> float:
    assert problem.E is not None
    assert problem.e is not None
    assert problem.D is not None
    z = law.K[region] @ theta + law.k[region]
    upper, equal = problem.w + problem.S @ theta, problem.e + problem.D @ theta
    excess = np.concatenate([problem.G @ z - upper, np.abs(problem.E @ z - equal)])
    return float(np.max(excess / np.maximum(1.0, np.abs(np.concatenate([upper, equal]))), initial=0.0))


def random_points(law: ExplicitLaw, count: int, rng: np.random.Generator) -> Array:
    """Points spread over the domain by a hit-and-run walk."""
    settings = MpQpSettings()
    length = law.domain.lengths
    A, b = law.domain.A / length[:, None], law.domain.b / length
    point = point_inside((A, b), settings.radius, settings)
    if point is None:
        return np.zeros((0, law.p))
    found = []
    for _ in range(count):
        for _ in range(_STEPS):
            point = _walk(A, b, point, rng)
        found.append(point)
    return np.array(found).reshape(-1, law.p)


def _walk(A: Array, b: Vector, point: Vector, rng: np.random.Generator) -> Vector:
    """A point on the chord of the domain through the given one in a random direction."""
    direction = rng.normal(size=len(point))
    speed, room = A @ direction, b - A @ point
    with np.errstate(divide="ignore"):
        times = room / speed
    low = np.max(times[speed < 0], initial=-np.inf)
    high = np.min(times[speed > 0], initial=np.inf)
    return np.asarray(point + rng.uniform(low, high) * direction)


def _is_definite(problem: MpQp) -> bool:
    values = np.linalg.eigvalsh(problem.H)
    return bool(values[0] > MpQpSettings().curvature * max(float(values[-1]), 0.0))


def _boundary(law: ExplicitLaw, count: int, rng: np.random.Generator) -> tuple[Array, Vector]:
    """Points on facets of random regions, and the greatest jumps of the moves and of the value there."""
    points, jumps = [], np.zeros(2)
    for row in rng.integers(0, len(law.b), count) if len(law.b) else []:
        region = int(np.searchsorted(law.starts, row, side="right")) - 1
        point = _on_facet(law, region, int(row - law.starts[region]))
        if point is not None:
            points.append(point)
            jumps = np.maximum(jumps, _jumps(law, region, point))
    return np.array(points).reshape(-1, law.p), jumps


def _on_facet(law: ExplicitLaw, region: int, row: int) -> Vector | None:
    A, b = law.rows(region)
    settings = MpQpSettings()
    for margin in settings.margins:
        sides = b - margin
        sides[row] = b[row]
        rows = np.vstack([A, -A[row]]), np.append(sides, -b[row])
        point = point_inside(rows, 0.0, settings)
        if point is not None:
            return point
    return None


def _jumps(law: ExplicitLaw, region: int, point: Vector) -> Vector:
    others: NDArray[np.intp] = np.flatnonzero(law.excess(point) <= law.tolerance)
    moves = law.K[:, : law.moves] @ point + law.k[:, : law.moves]
    jump = np.max(np.abs(moves[others] - moves[region]), initial=0.0)
    if not law.has_value:
        return np.array([jump, 0.0])
    values = _forms(law, point)
    gap = np.max(np.abs(values[others] - values[region]), initial=0.0) / max(1.0, abs(values[region]))
    return np.array([jump, gap])


def _doubled(law: ExplicitLaw, point: Vector) -> bool:
    """Whether a point lies well inside two regions whose moves differ there."""
    inside = np.flatnonzero(law.excess(point) < -10 * law.tolerance)
    moves = law.K[inside, : law.moves] @ point + law.k[inside, : law.moves]
    return len(inside) > 1 and float(np.ptp(moves, axis=0).max()) > 1e3 * law.tolerance
