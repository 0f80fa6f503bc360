"""Semi-smooth Newton method: guess which unknowns are at a bound, solve for the others, guess again.

In this form it is the primal-dual active-set method (M. Hintermueller, K. Ito and K. Kunisch, SIAM Journal on
Optimization 13, 2002). It takes a handful of steps whatever the size, but may cycle where solutions are degenerate.
Then a method that cannot cycle takes over: projected Newton with a line search on the quadratic program
(D. P. Bertsekas, SIAM Journal on Control and Optimization 20, 1982) for a symmetric positive semidefinite M, damped
Newton on the function of Fischer and Burmeister for any other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.lcp.blocks import Blocks
from hysdel_py.optimize.lcp.fischer import damped_newton
from hysdel_py.optimize.lcp.problem import Lcp, LcpSettings, LcpStatus, States, states_of

__all__ = ["newton"]

Vector = NDArray[np.float64]

SHIFT = 1e-9
"""Proximal term that makes singular blocks regular; the steps are repeated until the residual is small all the same."""
SUFFICIENT = 1e-4  # share of the predicted decrease that a step must bring
SHORTEST = 1e-10


def newton(problem: Lcp, guess: Vector, settings: LcpSettings) -> tuple[LcpStatus, Vector, int]:
    """Solve a scaled problem.

    Returns
    -------
    status : LcpStatus
        SOLVED, ITERATION_LIMIT, or SINGULAR where no step could be computed.
    z : array of shape (n,)
    steps : int
    """
    blocks = Blocks(problem, SHIFT)
    status, z, steps = _active_sets(problem, blocks, guess, settings)
    if status is LcpStatus.SOLVED:
        return status, z, steps
    start = np.clip(guess, problem.lo, problem.hi)
    if problem.is_symmetric:
        status, z, more = _projected(problem, blocks, start, settings)
    else:
        status, z, more = damped_newton(problem, start, settings)
    return status, z, steps + more


def natural_residual(problem: Lcp, z: Vector, w: Vector) -> float:
    """Largest entry of ``z - median(lo, z - w, hi)``."""
    return float(np.abs(z - np.clip(z - w, problem.lo, problem.hi)).max(initial=0.0))


def _active_sets(problem: Lcp, blocks: Blocks, guess: Vector, settings: LcpSettings) -> tuple[LcpStatus, Vector, int]:
    z = guess.copy()
    seen: set[bytes] = set()
    for step in range(1, settings.newton_steps + 1):
        w = problem.M @ z + problem.q
        mode = states_of(problem, z, w)
        if mode.tobytes() in seen:
            return LcpStatus.SINGULAR, z, step
        seen.add(mode.tobytes())
        after = _solved_mode(problem, blocks, z, w, mode)
        if after is None:
            return LcpStatus.SINGULAR, z, step
        z = after
        if natural_residual(problem, z, problem.M @ z + problem.q) <= 0.1 * settings.tolerance:
            return LcpStatus.SOLVED, z, step
    return LcpStatus.ITERATION_LIMIT, z, settings.newton_steps


def _solved_mode(problem: Lcp, blocks: Blocks, z: Vector, w: Vector, mode: States) -> Vector | None:
    """The point with the bounds of a mode and no w elsewhere; a step from z, so that a shift vanishes in the limit."""
    step = np.where(mode < 0, problem.lo - z, np.where(mode > 0, problem.hi - z, 0.0))
    free = mode == 0
    part = blocks.solve(free, -(w + problem.M @ step)[free])
    if part is None:
        return None
    step[free] = part
    return np.where(mode < 0, problem.lo, np.where(mode > 0, problem.hi, z + step))


def _projected(problem: Lcp, blocks: Blocks, z: Vector, settings: LcpSettings) -> tuple[LcpStatus, Vector, int]:
    """Newton steps on ``1/2 z'M z + q'z`` over the bounds, each cut to the bounds and shortened until it pays."""
    for count in range(settings.newton_steps):
        w = problem.M @ z + problem.q
        error = natural_residual(problem, z, w)
        if error <= 0.1 * settings.tolerance:
            return LcpStatus.SOLVED, z, count
        near = min(error, 1e-3)
        held = ((z <= problem.lo + near) & (w > 0)) | ((z >= problem.hi - near) & (w < 0))
        part = blocks.solve(~held, -w[~held])
        if part is None:
            return LcpStatus.SINGULAR, z, count
        direction = -w.copy()
        direction[~held] = part
        after = _line_search(problem, z, w, direction, ~held)
        if after is None:
            return LcpStatus.ITERATION_LIMIT, z, count
        z = after
    return LcpStatus.ITERATION_LIMIT, z, settings.newton_steps


def _line_search(problem: Lcp, z: Vector, w: Vector, direction: Vector, free: NDArray[np.bool_]) -> Vector | None:
    length = 1.0
    while length >= SHORTEST:
        after = np.clip(z + length * direction, problem.lo, problem.hi)
        step = after - z
        promised = -length * float(w[free] @ direction[free]) - float(w[~free] @ step[~free])
        if float(step @ (w + 0.5 * (problem.M @ step))) <= -SUFFICIENT * promised:
            return after
        length *= 0.5
    return None
