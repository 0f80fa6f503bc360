"""Which rows of ``A w <= b`` are needed.

Rays that start at inner points and run along the normals of the rows leave the set through a row that is needed; what
no ray finds is decided by one linear program each.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.small_programs import are_small, needed_among
from hysdel_py.geometry.solver import LpSolver

__all__ = ["irredundant_rows"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_CLEARLY_FIRST = 1e-6
"""A ray proves a row only if it meets all others later by this much, relative to its length."""


def irredundant_rows(A: Matrix, b: Vector, inside: Matrix, solver: LpSolver) -> tuple[int, ...]:
    """Rows without which the set would be larger, in their order; of equal rows the first.

    Parameters
    ----------
    A : array of shape (m, n)
    b : array of shape (m,)
    inside : array of shape (k, n)
        Inner points, as many as are known; there may be none.
    solver : LpSolver
    """
    precision = solver.precision
    if are_small(*A.shape):
        found = needed_among(
            A, b, inside, parallel=precision.parallel, margin=precision.redundant, tolerance=precision.lp
        )
        if found is not None:
            solver.solved += found[1]
            return found[0]
    lengths = np.asarray(np.linalg.norm(A, axis=1))
    keep = _distinct_rows(A, b, lengths, precision.parallel)
    if not keep:
        return ()
    G, h = A[keep] / lengths[keep, None], b[keep] / lengths[keep]
    needed = {keep[i] for point in inside for i in _met_first(G, h, point)}
    for row in [r for r in keep if r not in needed]:
        others = [r for r in keep if r != row]
        if _exceeds(A, b, row, others, solver):
            needed.add(row)
        else:
            keep = others
    return tuple(sorted(needed))


def _distinct_rows(A: Matrix, b: Vector, lengths: Vector, parallel: float) -> list[int]:
    """Rows that matter at all: of parallel rows the tightest, the first of equal ones."""
    digits = round(-np.log10(parallel))
    best: dict[tuple[float, ...], int] = {}
    for row in range(len(b)):
        if lengths[row] == 0 or not np.isfinite(b[row]):
            continue
        key = tuple(np.round(A[row] / lengths[row], digits) + 0.0)
        rival = best.get(key)
        side = b[row] / lengths[row]
        if rival is None or side < b[rival] / lengths[rival] - 1e-15 * abs(side):
            best[key] = row
    return sorted(best.values())


def _met_first(G: Matrix, h: Vector, centre: Vector) -> set[int]:
    """Rows that a ray from the centre along some row's normal meets first, and no other row nearly as soon."""
    speed, distance = G @ G.T, h - G @ centre
    if len(h) == 1:
        return {0}
    if np.any(distance <= 0):
        return set()
    with np.errstate(divide="ignore"):
        times = np.where(speed > 0, distance[:, None] / np.where(speed > 0, speed, 1.0), np.inf)
    first = np.argmin(times, axis=0)
    soonest = np.partition(times, 1, axis=0)
    clear = soonest[1] > soonest[0] * (1.0 + _CLEARLY_FIRST)
    return set(first[clear].tolist())


def _exceeds(A: Matrix, b: Vector, row: int, others: list[int], solver: LpSolver) -> bool:
    """Whether a row cuts something off that the others allow."""
    length = float(np.linalg.norm(A[row]))
    moved = np.append(b[others], b[row] + length)  # the row itself moved outwards keeps the program bounded
    free = np.full(A.shape[1], np.inf)
    answer = solver.maximise(A[row], np.vstack([A[others], A[row]]), moved, -free, free)
    return not answer.is_optimal or answer.value > b[row] + solver.precision.redundant * length
