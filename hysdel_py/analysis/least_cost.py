"""The least value of a sum of squares over mixed-integer rows, from below.

Each square is bounded from below by tangents, which are added where the last point lies (J. E. Kelley, "The
cutting-plane method for solving convex programs", Journal of SIAM 8, 1960). The bound of each program is one of the
sum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.milp import Answer, Milp, Status

__all__ = ["Least", "Squares", "least_value"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

MOST_CUTS = 60
"""So many programs at most; the bound of the last one counts."""
PRECISION = 1e-4
"""Relative distance between bound and value at which the search ends."""
_NEGLIGIBLE = 1e-12  # eigenvalues of a weight below this, relative to the greatest, are rounding


@dataclass(frozen=True, eq=False, slots=True)
class Squares:
    """``(w - r)' Q (w - r)`` of some signals.

    Attributes
    ----------
    signals : tuple of (vector, name)
    Q : array of shape (n, n)
    r : array of shape (n,)
    """

    signals: tuple[tuple[str, str], ...]
    Q: Matrix
    r: Vector

    def factors(self) -> Matrix:
        """Rows q with ``Q = sum of q q'``."""
        values, vectors = np.linalg.eigh(self.Q)
        kept = values > _NEGLIGIBLE * max(float(values.max(initial=0.0)), np.finfo(float).tiny)
        return np.asarray((vectors[:, kept] * np.sqrt(values[kept])).T)

    def at(self, w: Vector) -> float:
        """The value for given signals."""
        return float((w - self.r) @ self.Q @ (w - self.r))


@dataclass(frozen=True, eq=False, slots=True)
class Least:
    """No point has a lesser value than `bound`, infinite where there is no point; `w` is where it is nearly so."""

    bound: float
    w: Vector


def least_value(problem: Milp, sums: Sequence[tuple[Squares, Sequence[int]]], clock: Clock) -> Least:
    """Bound a sum of squares from below.

    Parameters
    ----------
    problem : Milp
        Is left as it is.
    sums : sequence of (Squares, places)
        Each with the variables that its signals are.
    clock : Clock
    """
    work = problem.copy()
    roots = [root for squares, places in sums for root in _roots(work, squares, places)]
    objective = {t: 1.0 for _, t in roots}
    bound, point = 0.0, np.zeros(0)
    for _ in range(MOST_CUTS):
        answer = work.search(objective, seconds=clock.allowance())
        if answer.status is Status.NONE:
            return Least(inf, np.zeros(0))
        lower = _proven(answer)
        bound = max(bound, lower)
        if answer.status is Status.UNKNOWN:
            break
        fine = work.refine(answer.w, objective, seconds=clock.left)
        if fine.status is Status.NONE:  # a point up to the tolerance only, with these Booleans
            work.forbid(answer.w)
            continue
        point = answer.w if fine.status is Status.UNKNOWN else fine.w
        value = float(sum(point[s] ** 2 for s, _ in roots))
        if value - lower <= PRECISION * max(1.0, value):
            break
        _cut(work, roots, point)
    return Least(bound, point)


def _proven(answer: Answer) -> float:
    """The bound of a search; the solver states none for a linear program, whose value is its own."""
    return answer.value if answer.is_optimal and not isfinite(answer.bound) else answer.bound


def _roots(work: Milp, squares: Squares, places: Sequence[int]) -> list[tuple[int, int]]:
    """For each square the variable that is squared, and one that is not below its square."""
    found = []
    for q in squares.factors():
        s, t = work.real(), work.real(0.0)
        terms: dict[int, float] = {s: -1.0}
        for place, coefficient in zip(places, q, strict=True):
            terms[place] = terms.get(place, 0.0) + float(coefficient)
        side = float(q @ squares.r)
        work.row(terms, side, side)
        found.append((s, t))
    return found


def _cut(work: Milp, roots: Sequence[tuple[int, int]], point: Vector) -> None:
    for s, t in roots:
        touch = float(point[s])
        if point[t] < touch**2:
            work.row({t: 1.0, s: -2.0 * touch}, low=-(touch**2))
