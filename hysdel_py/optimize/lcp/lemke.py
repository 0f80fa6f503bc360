"""Lemke's method: complementary pivoting with a covering variable and the lexicographic rule.

Bounds on both sides are brought to the one-sided form with one more unknown for each of them, the excess of the upper
bound: with ``z = lo + p`` and ``w = w1 - v``,

::

    [w1; s] = [[M, I], [-I, 0]] [p; v] + [M lo + q; hi - lo],   all >= 0,   p'w1 = 0,   v's = 0

For friction this is the decomposition with two unknowns per contact (R. I. Leine and H. Nijmeijer, "Dynamics and
Bifurcations of Non-Smooth Mechanical Systems", 2004).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.kernels import lcp as kernels
from hysdel_py.optimize.lcp.problem import Lcp, LcpSettings, LcpStatus, States, states_of

__all__ = ["follow_path"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class _OneSided:
    """``w = M z + q``, one-sided, and how it belongs to the given problem."""

    M: Vector
    q: Vector
    sign: Vector
    base: Vector
    upper: NDArray[np.int64]

    def given(self, z: Vector) -> Vector:
        """A solution in the unknowns of the given problem."""
        return self.base + self.sign * z[: len(self.base)]

    def basic(self, mode: States) -> NDArray[np.bool_]:
        """Which unknowns are basic in a mode of the given problem."""
        oriented = np.where(self.sign > 0, mode, -mode)
        return np.concatenate([oriented >= 0, oriented[self.upper] > 0])


def follow_path(problem: Lcp, guess: Vector | None, settings: LcpSettings) -> tuple[LcpStatus, Vector, int]:
    """Solve a scaled problem, starting from the mode of a guess if there is one.

    Returns
    -------
    status : LcpStatus
        SOLVED, NO_SOLUTION where the ray proves it, RAY, or ITERATION_LIMIT.
    z : array of shape (n,)
    pivots : int

    Raises
    ------
    ArgumentError
        An unknown without any finite bound.
    """
    one_sided = _one_sided(problem)
    spent = 0
    if guess is not None:
        mode = states_of(problem, guess, problem.M @ guess + problem.q)
        warm = _from_basis(one_sided, one_sided.basic(mode), settings)
        if warm is not None and warm[0] is LcpStatus.SOLVED:
            return warm[0], one_sided.given(warm[1]), warm[2]
        spent = 0 if warm is None else warm[2]
    status, z, pivots = _path(one_sided.M, one_sided.q, settings)
    return status, one_sided.given(z), spent + pivots


def _one_sided(problem: Lcp) -> _OneSided:
    low, high = np.isfinite(problem.lo), np.isfinite(problem.hi)
    if not (low | high).all():
        i = int(np.argmin(low | high))
        raise ArgumentError(f'unknown {i} has no finite bound: Lemke\'s method needs one; take method="newton"')
    sign, base = np.where(low, 1.0, -1.0), np.where(low, problem.lo, problem.hi)
    M, q = sign[:, None] * problem.dense * sign, sign * (problem.dense @ base + problem.q)
    upper = np.flatnonzero(low & high)
    E = np.eye(problem.n)[:, upper]
    corner = np.zeros((len(upper), len(upper)))
    return _OneSided(
        np.block([[M, E], [-E.T, corner]]),
        np.concatenate([q, (problem.hi - problem.lo)[upper]]),
        sign,
        base,
        upper,
    )


def _from_basis(
    one_sided: _OneSided, basic: NDArray[np.bool_], settings: LcpSettings
) -> tuple[LcpStatus, Vector, int] | None:
    """The path of the problem after a principal pivot on the basic unknowns; None where the block is singular."""
    M, q = one_sided.M, one_sided.q
    if not basic.any():
        return None
    try:
        inverse = np.linalg.inv(M[np.ix_(basic, basic)])
    except np.linalg.LinAlgError:
        return None
    across, down, rest = M[np.ix_(basic, ~basic)], M[np.ix_(~basic, basic)], M[np.ix_(~basic, ~basic)]
    pivoted, right = np.empty_like(M), np.empty_like(q)
    pivoted[np.ix_(basic, basic)] = inverse
    pivoted[np.ix_(basic, ~basic)] = -inverse @ across
    pivoted[np.ix_(~basic, basic)] = down @ inverse
    pivoted[np.ix_(~basic, ~basic)] = rest - down @ inverse @ across
    right[basic], right[~basic] = -inverse @ q[basic], q[~basic] - down @ inverse @ q[basic]
    if not np.isfinite(pivoted).all():
        return None
    status, x, pivots = _path(pivoted, right, settings)
    y = pivoted @ x + right
    z = np.where(basic, y, x)
    return status, _polished(M, q, z, settings), pivots


def _path(M: Vector, q: Vector, settings: LcpSettings) -> tuple[LcpStatus, Vector, int]:
    n = len(q)
    limit = settings.pivots or 50 + 20 * n
    outcome, pivots, basis, T, entering = kernels.lemke(np.ascontiguousarray(M), q, limit, settings.pivot)
    z = _values(basis, T[:, -1], n)
    match outcome:
        case kernels.SOLVED:
            return LcpStatus.SOLVED, _polished(M, q, z, settings), pivots
        case kernels.RAY:
            ray = _values(basis, -T[:, entering], n)
            if n <= entering < 2 * n:
                ray[entering - n] = 1.0
            proven = _forbids_feasibility(M, q, ray, settings.tolerance)
            return (LcpStatus.NO_SOLUTION if proven else LcpStatus.RAY), z, pivots
        case _:
            return LcpStatus.ITERATION_LIMIT, z, pivots


def _values(basis: NDArray[np.int64], column: Vector, n: int) -> Vector:
    """Values of z where the basic unknowns have the values of a column."""
    z = np.zeros(n)
    among = (basis >= n) & (basis < 2 * n)
    z[basis[among] - n] = column[among]
    return z


def _forbids_feasibility(M: Vector, q: Vector, ray: Vector, tolerance: float) -> bool:
    """Whether the ray, cut to ``y >= 0``, has ``M'y <= 0`` and ``q'y < 0``: then ``M z + q >= 0`` has no solution."""
    y = np.maximum(ray, 0.0)
    size = y.max(initial=0.0)
    return bool(size > 0 and (M.T @ y).max() <= tolerance * size and q @ y < -tolerance * size)


def _polished(M: Vector, q: Vector, z: Vector, settings: LcpSettings) -> Vector:
    """The positive unknowns from their own linear system, free of the rounding of the pivots, if that is no worse."""
    free = z > settings.pivot
    try:
        exact = np.zeros_like(z)
        exact[free] = np.linalg.solve(M[np.ix_(free, free)], -q[free])
    except np.linalg.LinAlgError:
        return z
    return exact if _natural(M, q, exact) <= _natural(M, q, z) else z


def _natural(M: Vector, q: Vector, z: Vector) -> float:
    size = float(np.abs(np.minimum(z, M @ z + q)).max(initial=0.0))
    return size if np.isfinite(size) else float("inf")
