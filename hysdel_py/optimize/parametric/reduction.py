"""From a problem as stated to the canonical one: equalities, scaling, curvature, rows that never matter."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.lp import LpStatus, maximise
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.facets import facets, inner_point, same_rows
from hysdel_py.optimize.parametric.nearest import FOUND
from hysdel_py.optimize.parametric.problem import MpQp
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["canonical_form"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class _Affine:
    """``z = basis y + offset (1, s)``: what is left of z after equalities, over scaled parameters."""

    basis: Matrix
    offset: Matrix


def canonical_form(problem: MpQp, settings: MpQpSettings) -> Canonical | None:
    """Canonical form of a problem, or None if no theta of the domain has a feasible z.

    Raises
    ------
    ArgumentError
        The domain is empty, flat or unbounded; H is not positive semidefinite; or the feasible parameters lie in a
        subspace.
    """
    problem = _without_infinite_rows(problem)
    centre, half = _scaling(problem.theta)
    tight: list[int] = []
    while True:
        affine = _without_equalities(problem, tight, centre, half)
        form = _transformed(problem, affine, centre, half, tight, settings)
        status, inner = _joint_inner_point(form, settings)
        if status == FOUND:
            return _without_redundant_rows(replace(form, inner=inner), settings)
        more = _always_tight(form)
        if more is None:
            return None
        if not more:
            raise ArgumentError(
                "the feasible parameters lie in a subspace: some rows allow no inner point in theta; fix a parameter "
                "or widen the rows"
            )
        tight = sorted({*tight, *more})


def _without_infinite_rows(problem: MpQp) -> MpQp:
    """Infinite sides become rows that say nothing, which keeps the numbers of the others."""
    endless = ~np.isfinite(problem.w)
    if not endless.any():
        return problem
    keep = ~endless[:, None]
    return replace(problem, G=problem.G * keep, w=np.where(endless, 1.0, problem.w), S=problem.S * keep)


def _scaling(theta: Polyhedron) -> tuple[Vector, Vector]:
    if not theta.n:
        raise ArgumentError("theta has no coordinates: a problem without parameters is an ordinary quadratic program")
    low, high = _box(theta)
    unbounded = ~np.isfinite(low) | ~np.isfinite(high)
    if np.any(low > high) or (_radius(theta, low, high) < -theta.precision.empty):
        raise ArgumentError("the polyhedron of theta is empty: parameters to solve for were expected")
    if unbounded.any():
        raise ArgumentError(f"theta is unbounded in coordinate {_listed(unbounded)}: add rows that bound it")
    if _radius(theta, low, high) <= theta.precision.empty:
        thin = high - low <= 2 * theta.precision.empty
        where = f" in coordinate {_listed(thin)}" if thin.any() else ""
        raise ArgumentError(f"the polyhedron of theta is flat{where}: put fixed parameters into the problem instead")
    return (low + high) / 2, (high - low) / 2


def _radius(theta: Polyhedron, low: Vector, high: Vector) -> float:
    """Radius of an inscribed ball, without a linear program if the rows already are a box."""
    return float(np.min(high - low)) / 2 if _is_box(theta) else theta.ball.radius


def _is_box(theta: Polyhedron) -> bool:
    return bool((np.count_nonzero(theta.A, axis=1) == 1).all())


def _listed(marked: NDArray[np.bool_]) -> str:
    return ", ".join(str(int(number)) for number in np.flatnonzero(marked))


def _box(theta: Polyhedron) -> tuple[Vector, Vector]:
    """Bounding box, without linear programs if the rows already are one."""
    if not _is_box(theta):
        return theta.bounding_box
    low, high = np.full(theta.n, -np.inf), np.full(theta.n, np.inf)
    for row, side in zip(theta.A, theta.b, strict=True):
        coordinate = int(np.flatnonzero(row)[0])
        end = side / row[coordinate]
        if row[coordinate] > 0:
            high[coordinate] = min(high[coordinate], end)
        else:
            low[coordinate] = max(low[coordinate], end)
    return low, high


def _over_scaled(constant: Vector, coefficients: Matrix, centre: Vector, half: Vector) -> Matrix:
    """``constant + coefficients theta`` as columns over (1, s)."""
    return np.asarray(np.column_stack([constant + coefficients @ centre, coefficients * half]))


def _without_equalities(problem: MpQp, tight: list[int], centre: Vector, half: Vector) -> _Affine:
    """Particular solution and null space of the equalities, those of always tight rows included."""
    assert problem.E is not None
    assert problem.e is not None
    assert problem.D is not None
    E = np.vstack([problem.E, problem.G[tight]])
    right = np.vstack(
        [
            _over_scaled(problem.e, problem.D, centre, half),
            _over_scaled(problem.w[tight], problem.S[tight], centre, half),
        ]
    )
    if not len(E):
        return _Affine(np.eye(problem.n), np.zeros((problem.n, problem.p + 1)))
    U, size, Vt = np.linalg.svd(E)
    rank = int(np.sum(size > 1e-10 * max(size[0], 1e-300)))
    rest = U[:, rank:].T @ right
    scale = np.abs(right).max(initial=1.0)
    if np.abs(rest[:, 1:]).max(initial=0.0) > 1e-9 * scale or np.abs(rest).max(initial=0.0) > 1e-9 * scale:
        raise ArgumentError(
            "the equalities hold for no theta or restrict theta to a subspace: equalities that determine z from theta "
            "were expected"
        )
    offset = Vt[:rank].T @ ((U[:, :rank].T @ right) / size[:rank, None])
    return _Affine(Vt[rank:].T, offset)


def _transformed(
    problem: MpQp, affine: _Affine, centre: Vector, half: Vector, tight: list[int], settings: MpQpSettings
) -> Canonical:
    """Canonical form with all rows that restrict something."""
    basis, offset = affine.basis, affine.offset
    H = basis.T @ problem.H @ basis
    linear = basis.T @ (_over_scaled(problem.f, problem.F, centre, half) + problem.H @ offset)
    G = problem.G @ basis
    curved, level = _curvature((H + H.T) / 2, settings)
    flat = _without_lines(level, G, linear)
    back = np.hstack([curved, flat])
    shift = -curved @ (curved.T @ linear)
    sides = _over_scaled(problem.w, problem.S, centre, half) - problem.G @ offset - G @ shift
    M, b, rows, domain = _unit_rows(G @ back, sides, tight, np.linalg.norm(G, axis=1))
    own = _over_scaled(problem.theta.b, -problem.theta.A, centre, half)
    return Canonical(
        M,
        np.column_stack([b, _spread(len(b), 1.0, 1.5)]),
        np.column_stack([flat.T @ linear, _spread(flat.shape[1], -1.0, 1.0)]),
        _normals(np.vstack([own, domain])),
        rows,
        basis @ back,
        basis @ shift + offset,
        centre,
        half,
        np.zeros(back.shape[1] + problem.p),
    )


def _curvature(H: Matrix, settings: MpQpSettings) -> tuple[Matrix, Matrix]:
    """``T1`` with ``T1'H T1 = I`` and an orthonormal basis of the null space of H."""
    values, vectors = np.linalg.eigh(H)
    greatest = float(np.abs(values).max(initial=0.0))
    if len(values) and values[0] < -1e-9 * greatest:
        raise ArgumentError(f"H has the eigenvalue {values[0]:.3g}: a positive semidefinite matrix was expected")
    real = values > settings.curvature * greatest
    if real.all() and len(values):
        return np.asarray(np.linalg.solve(np.linalg.cholesky(H), np.eye(len(H))).T), np.zeros((len(H), 0))
    return vectors[:, real] / np.sqrt(values[real]), vectors[:, ~real]


def _without_lines(level: Matrix, G: Matrix, linear: Matrix) -> Matrix:
    """The flat directions that a row or the cost sees.

    Along the others neither changes, so that the feasible set has no corners to begin at; z does not move along them.
    """
    seen = np.vstack([_relative(G), _relative(linear.T)]) @ level
    size, Vt = np.linalg.svd(seen)[1:]
    rank = int(np.sum(size > _UNSEEN))
    return level if rank == level.shape[1] else np.asarray(level @ Vt[:rank].T)


_UNSEEN = 1e-10
"""A direction is not seen if rows of length one and a cost of size one change less along it."""


def _relative(rows: Matrix) -> Matrix:
    """Rows divided by the length of the greatest one."""
    return np.asarray(rows / max(float(np.linalg.norm(rows, axis=1).max(initial=0.0)), 1e-300))


def _unit_rows(
    M: Matrix, sides: Matrix, tight: list[int], before: Vector
) -> tuple[Matrix, Matrix, NDArray[np.int64], Matrix]:
    """Rows of length one, and apart from them those that restrict theta alone."""
    lengths = np.linalg.norm(M, axis=1)
    vanish = (before <= 1e-12 * max(1.0, float(before.max(initial=0.0)))) | (lengths == 0)
    vanish[tight] = False
    keep = ~vanish
    keep[tight] = False
    rows = np.flatnonzero(keep)
    return M[rows] / lengths[rows, None], sides[rows] / lengths[rows, None], rows, sides[vanish]


def _normals(sides: Matrix) -> Matrix:
    """Rows ``0 <= side(s)`` as side and normal of length one; those without normal are left to say no or nothing."""
    normal = -sides[:, 1:]
    length = np.linalg.norm(normal, axis=1)
    trivial = length <= 1e-12 * np.maximum(1.0, np.abs(sides[:, 0]))
    if np.any(sides[trivial, 0] < -1e-9):
        raise ArgumentError("a row without z says 0 <= a negative number: no theta is feasible")
    real = ~trivial
    return np.asarray(np.column_stack([sides[real, 0], normal[real]]) / length[real, None])


def _spread(count: int, low: float, high: float) -> Vector:
    """Numbers without pattern between two ends: the perturbation that breaks ties."""
    return np.asarray(low + (high - low) * ((0.5 + np.arange(1, count + 1) * (np.sqrt(5.0) - 1) / 2) % 1.0))


def _joint(form: Canonical) -> tuple[Matrix, Vector]:
    """All rows in the joint space of (v, s), of length one."""
    rows = np.hstack([form.M, -form.b[:, 1:-1]])
    length = np.linalg.norm(rows, axis=1)
    own = np.hstack([np.zeros((len(form.domain), form.n)), form.domain[:, 1:]])
    return np.vstack([rows / length[:, None], own]), np.concatenate([form.b[:, 0] / length, form.domain[:, 0]])


def _joint_inner_point(form: Canonical, settings: MpQpSettings) -> tuple[int, Vector]:
    N, h = _joint(form)
    status, point = inner_point(N, h, np.zeros(N.shape[1]), settings.margins, settings.violation, settings.angle)
    return int(status), point


def _always_tight(form: Canonical) -> list[int] | None:
    """Stated numbers of rows that hold with equality wherever all hold; None if that is nowhere.

    One linear program: the greatest sum of slacks that count up to one each.
    """
    N, h = _joint(form)
    m, n = N.shape
    A = np.hstack([N, np.eye(m)])
    bounds = np.full(n, np.inf)
    answer = maximise(
        np.concatenate([np.zeros(n), np.ones(m)]),
        A,
        h,
        np.concatenate([-bounds, np.zeros(m)]),
        np.concatenate([bounds, np.full(m, 1e-3)]),
    )
    if answer.status is LpStatus.INFEASIBLE or not answer.is_optimal:
        return None
    tight = np.flatnonzero(answer.w[n:] < 1e-7)
    return [int(form.rows[row]) for row in tight if row < form.m]


def _without_redundant_rows(form: Canonical, settings: MpQpSettings) -> Canonical:
    N, h = _joint(form)
    first = same_rows(N, h, settings.same)
    own = np.flatnonzero(first == np.arange(len(first)))
    needed, _, _ = facets(N[own], h[own], np.array(form.inner), settings.radius, settings.violation, settings.angle)
    keep = own[needed]
    rows, domain = keep[keep < form.m], keep[keep >= form.m] - form.m
    return replace(form, M=form.M[rows], b=form.b[rows], rows=form.rows[rows], domain=form.domain[domain])
