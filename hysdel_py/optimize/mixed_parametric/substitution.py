"""A program with its binaries fixed, over the parameters and the few variables that its rows leave free.

A row that became an equality, a pair of big-M rows that has closed or the equation of the next state, defines one of
its variables: the last one that has a fair coefficient. Parameters are never defined; an equality among parameters
alone leaves a set of them without inner points.

All is done in scaled entries ``s`` with ``w = centre + half s``, in which every row has a greatest coefficient of 1 at
the start, so that numbers that are small there are small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.mixed_parametric.problem import MpMiqp
from hysdel_py.optimize.mixed_parametric.scaling import scales
from hysdel_py.optimize.mixed_parametric.settings import MpMiqpSettings
from hysdel_py.optimize.reduction import parallel_groups

__all__ = ["Fate", "Reduced", "reduce_to_free"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]

_SEED = 1994


class Fate(Enum):
    """What fixing binaries made of a program."""

    ALIVE = "alive"
    EMPTY = "no point satisfies its rows"
    FLAT = "its parameters fill no volume"


@dataclass(frozen=True, eq=False, slots=True)
class Reduced:
    """``w = Z (s, 1)`` and the rows ``N s <= h``, with s the scaled parameters and the scaled free variables.

    Attributes
    ----------
    free : array of int
        Entries of w that s stands for; the parameters come first.
    centre, half : arrays of shape (len(free),)
        ``w[free] = centre + half s``.
    Z : array of shape (n, len(free) + 1)
    N, h : arrays of shapes (rows, len(free)), (rows,)
        Without what the ranges of the free entries settle, but with these ranges themselves.
    """

    free: Indices
    centre: Vector
    half: Vector
    Z: Matrix
    N: Matrix
    h: Vector


def reduce_to_free(
    problem: MpMiqp, word: Sequence[int], last: int, settings: MpMiqpSettings
) -> tuple[Fate, Reduced | None]:
    """Put in the binaries and substitute what is defined.

    Parameters
    ----------
    problem : MpMiqp
    word : sequence of int
        Values of the first binaries, at least of those up to the stage `last`.
    last : int
        Rows and variables of later stages are left out.
    settings : MpMiqpSettings
    """
    table = _start(problem, word, last)
    fate = Fate.ALIVE
    while fate is Fate.ALIVE:
        fate = table.merge_parallel_rows(settings)
        equal = table.equalities(settings)
        if not len(equal):
            break
        fate = table.substitute(equal, settings) if fate is Fate.ALIVE else fate
    return (fate, table.reduced(problem)) if fate is Fate.ALIVE else (fate, None)


def _start(problem: MpMiqp, word: Sequence[int], last: int) -> _Table:
    """Rows of the stages up to the last one, scaled, with the binaries put in."""
    centre, half = scales(problem)
    fixed = np.zeros(problem.n, dtype=bool)
    given = problem.binaries[: len(word)]
    fixed[problem.lb == problem.ub] = True
    fixed[given] = True
    constant = np.where(problem.lb == problem.ub, problem.lb, 0.0)
    constant[given] = word
    inside = problem.reach <= last
    rows = np.flatnonzero(abs(problem.A) @ (~inside & ~fixed).astype(float) == 0)
    free = np.flatnonzero(inside & ~fixed)
    A = problem.A[rows]
    offset = A @ constant + A[:, free] @ centre[free]
    M = (A[:, free] @ np.diag(half[free])).reshape(len(rows), len(free))
    low, high = problem.l[rows] - offset, problem.u[rows] - offset
    size = np.maximum(np.abs(M).max(axis=1, initial=0.0), np.finfo(float).tiny)
    empty = np.abs(M).max(axis=1, initial=0.0) == 0
    size[empty] = 1.0
    eye = np.eye(len(free))
    Z = np.zeros((problem.n, len(free) + 1))
    Z[free, np.arange(len(free))] = half[free]
    Z[:, -1] = np.where(fixed, constant, 0.0)
    Z[free, -1] = centre[free]
    return _Table(
        free=free,
        parameters=int(np.sum(free < problem.parameters)),
        M=np.vstack([M / size[:, None], eye]),
        low=np.concatenate([low / size, (problem.lb[free] - centre[free]) / half[free]]),
        high=np.concatenate([high / size, (problem.ub[free] - centre[free]) / half[free]]),
        Z=Z,
        remaining=np.ones(len(free), dtype=bool),
        centre=centre,
        half=half,
    )


@dataclass(slots=True)
class _Table:
    """Rows ``low <= M s <= high`` and ``w = Z (s, 1)`` as entries of s are substituted."""

    free: Indices
    parameters: int
    M: Matrix
    low: Vector
    high: Vector
    Z: Matrix
    remaining: NDArray[np.bool_]
    centre: Vector
    half: Vector

    def merge_parallel_rows(self, settings: MpMiqpSettings) -> Fate:
        """One row for all parallel ones; rows without coefficients must hold."""
        size = np.abs(self.M).max(axis=1, initial=0.0)
        says = size > settings.zero
        if np.any(self.low[~says] > settings.meet) or np.any(self.high[~says] < -settings.meet):
            return Fate.EMPTY
        M = self.M[says] / size[says, None]
        low, high = self.low[says] / size[says], self.high[says] / size[says]
        random = np.random.default_rng(_SEED).uniform(1.0, 2.0, (M.shape[1], 3))
        group, one = parallel_groups(M @ random) if len(M) else (np.zeros(0, dtype=np.intp),) * 2
        scale = (M @ random)[:, 0] / (M @ random)[one[group], 0] if len(M) else np.zeros(0)
        first, second = low / scale, high / scale
        turned = scale < 0
        first[turned], second[turned] = second[turned], first[turned]
        self.M = M[one]
        self.low, self.high = np.full(len(one), -np.inf), np.full(len(one), np.inf)
        np.maximum.at(self.low, group, first)
        np.minimum.at(self.high, group, second)
        return Fate.EMPTY if np.any(self.low > self.high + settings.meet) else Fate.ALIVE

    def equalities(self, settings: MpMiqpSettings) -> Indices:
        """Rows whose sides meet."""
        return np.flatnonzero(self.high - self.low <= settings.meet)

    def substitute(self, equal: Indices, settings: MpMiqpSettings) -> Fate:
        """Let each equality define a variable, and drop the equalities."""
        for row in equal.tolist():
            coefficients, value = self.M[row].copy(), (self.low[row] + self.high[row]) / 2
            coefficients[np.abs(coefficients) <= settings.zero] = 0.0
            if not coefficients.any():
                if abs(value) > settings.meet:
                    return Fate.EMPTY
                continue
            pivot = self._pivot(coefficients, settings)
            if pivot is None:
                return Fate.FLAT
            self._eliminate(pivot, coefficients, value)
        keep = np.ones(len(self.M), dtype=bool)
        keep[equal] = False
        self.M, self.low, self.high = self.M[keep], self.low[keep], self.high[keep]
        return Fate.ALIVE

    def _pivot(self, coefficients: Vector, settings: MpMiqpSettings) -> int | None:
        """The last variable with a fair coefficient, the one with the greatest where none is fair."""
        own = np.abs(coefficients[self.parameters :])
        if not own.any():
            return None
        fair = np.flatnonzero(own >= settings.pivot * np.abs(coefficients).max())
        return self.parameters + int(fair[-1] if len(fair) else np.argmax(own))

    def _eliminate(self, pivot: int, coefficients: Vector, value: float) -> None:
        rate = coefficients / coefficients[pivot]
        offset = value / coefficients[pivot]
        share = self.M[:, pivot].copy()
        used = np.flatnonzero(share)
        self.M[used] -= np.outer(share[used], rate)
        self.M[used, pivot] = 0.0
        self.low[used] -= share[used] * offset
        self.high[used] -= share[used] * offset
        share = self.Z[:, pivot].copy()
        used = np.flatnonzero(share)
        self.Z[used, :-1] -= np.outer(share[used], rate)
        self.Z[used, -1] += share[used] * offset
        self.Z[used, pivot] = 0.0
        self.remaining[pivot] = False

    def reduced(self, problem: MpMiqp) -> Reduced:
        """What is left; rows that the ranges of the free entries settle are dropped."""
        kept = np.flatnonzero(self.remaining)
        M = self.M[:, kept]
        N, h = np.vstack([M, -M]), np.concatenate([self.high, -self.low])
        at = self.free[kept]
        ends = ((side[at] - self.centre[at]) / self.half[at] for side in (problem.lb, problem.ub))
        reach = _greatest(N, *ends)
        single = (np.abs(N) > 0).sum(axis=1) == 1
        needed = np.isfinite(h) & (single | (reach > h))
        Z = np.column_stack([self.Z[:, kept], self.Z[:, -1]])
        length = np.linalg.norm(N[needed], axis=1)
        return Reduced(at, self.centre[at], self.half[at], Z, N[needed] / length[:, None], h[needed] / length)


def _greatest(N: Matrix, low: Vector, high: Vector) -> Vector:
    """Greatest value of each row over a box."""
    with np.errstate(invalid="ignore"):
        ends = np.maximum(np.where(N == 0, 0.0, N * low), np.where(N == 0, 0.0, N * high))
    return np.asarray(ends.sum(axis=1))
