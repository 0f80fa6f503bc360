"""Damped Newton method on the function of Fischer and Burmeister, ``a + b - sqrt(a^2 + b^2)``.

Its zeros are the complementary pairs. Bounds on both sides are nested as in S. C. Billups, "Algorithms for
complementarity problems and generalized equations", 1995. The Levenberg-Marquardt term keeps
steps finite at singular points.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.lcp.problem import Lcp, LcpSettings, LcpStatus

__all__ = ["damped_newton"]

Vector = NDArray[np.float64]

SUFFICIENT = 1e-4  # share of the predicted decrease that a step must bring
SHORTEST = 1e-12


def damped_newton(problem: Lcp, z: Vector, settings: LcpSettings) -> tuple[LcpStatus, Vector, int]:
    """Decrease half the squared norm of the function; returns status, point and steps."""
    M = problem.dense
    for count in range(settings.newton_steps):
        value, J = _function(problem, M, z)
        if np.abs(value).max(initial=0.0) <= 0.1 * settings.tolerance:
            return LcpStatus.SOLVED, z, count
        after = _shortened(problem, M, z, value, J)
        if after is None:
            return LcpStatus.ITERATION_LIMIT, z, count
        z = after
    return LcpStatus.ITERATION_LIMIT, z, settings.newton_steps


def _shortened(problem: Lcp, M: Vector, z: Vector, value: Vector, J: Vector) -> Vector | None:
    merit, gradient = 0.5 * float(value @ value), J.T @ value
    damping = min(1e-8, merit) * np.eye(len(z))
    try:
        step = np.linalg.solve(J.T @ J + damping, -gradient) if _is_poor(J) else np.linalg.solve(J, -value)
    except np.linalg.LinAlgError:
        step = -gradient
    slope = float(gradient @ step)
    length = 1.0
    while length >= SHORTEST:
        after = z + length * step
        trial, _ = _function(problem, M, after)
        if 0.5 * float(trial @ trial) <= merit + SUFFICIENT * length * slope:
            return after
        length *= 0.5
    return None


def _is_poor(J: Vector) -> bool:
    return bool(np.linalg.cond(J) > 1e10)


def _function(problem: Lcp, M: Vector, z: Vector) -> tuple[Vector, Vector]:
    """Values and a generalised Jacobian."""
    w, identity = M @ z + problem.q, np.eye(len(z))
    inner, d_inner = _upper(problem.hi - z, w, M, identity)
    low = np.isfinite(problem.lo)
    value, da, db = _pair(np.where(low, z - problem.lo, 0.0), inner)
    value, da, db = np.where(low, value, inner), np.where(low, da, 0.0), np.where(low, db, 1.0)
    return value, da[:, None] * identity + db[:, None] * d_inner


def _upper(room: Vector, w: Vector, M: Vector, identity: Vector) -> tuple[Vector, Vector]:
    """What takes the place of w where there is an upper bound: minus the function at (room, -w)."""
    high = np.isfinite(room)
    value, da, db = _pair(np.where(high, room, 0.0), -w)
    inner = np.where(high, -value, w)
    return inner, np.where(high, da, 0.0)[:, None] * identity + np.where(high, db, 1.0)[:, None] * M


def _pair(a: Vector, b: Vector) -> tuple[Vector, Vector, Vector]:
    """Value and derivatives; at the origin those of the direction (1, 1)."""
    size = np.hypot(a, b)
    safe = np.where(size > 0, size, 1.0)
    da, db = 1.0 - np.where(size > 0, a / safe, np.sqrt(0.5)), 1.0 - np.where(size > 0, b / safe, np.sqrt(0.5))
    small_sum = 2.0 * a * b / np.where(a + b + size > 0, a + b + size, 1.0)
    return np.where(a + b > 0, small_sum, a + b - size), da, db
