"""Enumeration of modes: each unknown at its lower bound, in between, or at its upper bound.

The mode of a guess is tried first; from one time step to the next it is mostly still right, and then one linear
system is solved. The others follow by the number of unknowns in which they differ from it. All modes without a solution
is a proof that there is none, since singular modes are settled by a linear program.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.lp import LpStatus, maximise
from hysdel_py.optimize.lcp.problem import Lcp, LcpSettings, LcpStatus, States, states_of

__all__ = ["enumerate_modes", "mode_count", "solution_of"]

Vector = NDArray[np.float64]


def mode_count(problem: Lcp) -> int:
    """Number of modes, a Python integer of any size."""
    sides = 1 + np.isfinite(problem.lo).astype(int) + np.isfinite(problem.hi)
    count = 1
    for choices in sides.tolist():
        count *= choices
    return count


def enumerate_modes(problem: Lcp, guess: Vector, settings: LcpSettings) -> tuple[LcpStatus, Vector, int]:
    """Try modes of a scaled problem.

    Returns
    -------
    status : LcpStatus
        SOLVED, NO_SOLUTION (proven), SINGULAR (a singular mode was left open) or ITERATION_LIMIT.
    z : array of shape (n,)
    tried : int
    """
    first = states_of(problem, guess, problem.M @ guess + problem.q)
    unclear, tried = False, 0
    for mode in _by_distance(problem, first):
        if tried == settings.modes:
            return LcpStatus.ITERATION_LIMIT, guess, tried
        tried += 1
        z, regular = solution_of(problem, mode, settings)
        if z is not None:
            return LcpStatus.SOLVED, z, tried
        unclear |= not regular
    return (LcpStatus.SINGULAR if unclear else LcpStatus.NO_SOLUTION), guess, tried


def _by_distance(problem: Lcp, first: States) -> Iterator[States]:
    others = [
        [side for side, there in ((-1, low), (0, True), (1, high)) if there and side != mode]
        for mode, low, high in zip(first, np.isfinite(problem.lo), np.isfinite(problem.hi), strict=True)
    ]
    for distance in range(problem.n + 1):
        for places in combinations(range(problem.n), distance):
            for sides in product(*(others[place] for place in places)):
                mode = first.copy()
                mode[list(places)] = sides
                yield mode


def solution_of(problem: Lcp, mode: States, settings: LcpSettings) -> tuple[Vector | None, bool]:
    """The solution with a given mode, or None; False if nothing could be said.

    A mode whose block is singular has a solution where its linear inequalities have one.
    """
    M, free = problem.dense, mode == 0
    z = np.where(mode < 0, problem.lo, np.where(mode > 0, problem.hi, 0.0))
    right = -(problem.q + M @ z)[free]
    block = M[np.ix_(free, free)]
    if _is_regular(block, settings.singular):
        z[free] = np.linalg.solve(block, right)
        return (z if _fits(problem, z, mode, settings.tolerance) else None), True
    return _of_singular_mode(problem, z, mode, settings)


def _is_regular(block: Vector, least: float) -> bool:
    if not len(block):
        return True
    values = np.linalg.svd(block, compute_uv=False)
    return bool(values[-1] > least * max(1.0, values[0]))


def _fits(problem: Lcp, z: Vector, mode: States, tolerance: float) -> bool:
    inside = (z >= problem.lo - tolerance) & (z <= problem.hi + tolerance)
    w = problem.dense @ z + problem.q
    signs = np.where(mode < 0, w >= -tolerance, np.where(mode > 0, w <= tolerance, np.abs(w) <= tolerance))
    return bool(np.all(inside & signs))


def _of_singular_mode(problem: Lcp, fixed: Vector, mode: States, settings: LcpSettings) -> tuple[Vector | None, bool]:
    """A linear program over the free unknowns: equal rows for them, one-sided rows for the others."""
    free = mode == 0
    w0, columns = problem.dense @ fixed + problem.q, problem.dense[:, free]
    upper = np.flatnonzero(mode >= 0)
    lower = np.flatnonzero(mode <= 0)
    A = np.vstack([columns[upper], -columns[lower]])
    b = np.concatenate([-w0[upper], w0[lower]])
    answer = maximise(np.zeros(int(free.sum())), A, b, problem.lo[free], problem.hi[free])
    if answer.status is LpStatus.INFEASIBLE:
        return None, True
    z = fixed.copy()
    z[free] = answer.w
    settled = answer.is_optimal and _fits(problem, z, mode, settings.tolerance)
    return (z, True) if settled else (None, False)
