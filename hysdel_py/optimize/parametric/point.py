"""The canonical problem at one value of the parameters."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.nearest import FOUND, NONE, nearest
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Point", "PointStatus", "solve_at"]

Vector = NDArray[np.float64]

_ROUNDS, _STRIDE, _FAR, _STILL, _SMALL = 400, 10.0, 1e9, 1e-10, 1e-12
"""Most proximal steps; length of a free one; where a solution is unbounded; when it stands still; what is no slope."""

_GROWTH, _GREATEST = 1.5, 1e3
"""Square root of the factor between two steps, and of the greatest factor in all."""


class PointStatus(Enum):
    """What is known about the problem at one theta."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    UNCLEAR = "numerical trouble"


_STATUS = {FOUND: PointStatus.OPTIMAL, NONE: PointStatus.INFEASIBLE}


@dataclass(frozen=True, eq=False, slots=True)
class Point:
    """Answer at one theta.

    Attributes
    ----------
    status : PointStatus
    v : array of shape (n,)
    active : tuple of int
        Rows of the canonical problem, ascending; if there is no solution, those that contradict each other.
    ray : array of shape (p + 1,)
        If there is no solution: an affine function of (1, s) that must not be negative for there to be one.
    """

    status: PointStatus
    v: Vector
    active: tuple[int, ...]
    ray: Vector


@dataclass(frozen=True, eq=False, slots=True)
class _Answer:
    """What proximal steps end with; multipliers belong to rows as given."""

    status: PointStatus
    v: Vector
    active: NDArray[np.int64]
    multipliers: Vector


def solve_at(form: Canonical, s: Vector, settings: MpQpSettings) -> Point:
    """Solve the canonical problem at scaled parameters, with ties broken by a small perturbation of the sides.

    Without curvature in all directions the proximal point method is used (R. Rockafellar, "Monotone operators and the
    proximal point algorithm", SIAM Journal on Control and Optimization 14, 1976); each step is a nearest-point problem.
    Of several solutions the one that the cost of ties prefers is taken.
    """
    sides = form.b @ np.concatenate([[1.0], s, [settings.tie]])
    if form.free:
        answer = _proximal_steps(form.M, sides, form.c[:, :-1] @ np.concatenate([[1.0], s]), settings)
    else:
        answer = _nearest(form.M, sides, settings)
    active: list[int] = answer.active.tolist()
    if answer.status is PointStatus.OPTIMAL and form.free:
        active = _corner(form, answer, sides, settings)
    ray = answer.multipliers @ form.b[answer.active, : form.p + 1]
    return Point(answer.status, answer.v, tuple(sorted(active)), np.asarray(ray))


def _nearest(M: NDArray[np.float64], sides: Vector, settings: MpQpSettings) -> _Answer:
    """Without v2 the point nearest to zero is the answer."""
    v0 = np.zeros(M.shape[1])
    status, v, active, multipliers = nearest(M.copy(), sides, v0, settings.violation, settings.angle)
    return _Answer(_STATUS.get(status, PointStatus.UNCLEAR), v, active, multipliers)


def _proximal_steps(M: NDArray[np.float64], sides: Vector, slope: Vector, settings: MpQpSettings) -> _Answer:
    """Steps ``min 1/2|v1|^2 + c'v2 + |v2 - v2_k|^2 / (2 t)`` for the last variables, with v2 in units of sqrt(t).

    Steps grow, so that a variable whose cost is small beside the others moves as well.
    """
    n, curved = M.shape[1], M.shape[1] - len(slope)
    fixed = np.concatenate([np.zeros(curved), np.ones(len(slope))])
    cost = np.concatenate([np.zeros(curved), slope])
    first = np.sqrt(_STRIDE / max(float(np.linalg.norm(slope)), _SMALL))
    v = np.zeros(n)
    for number in range(_ROUNDS):
        unit = np.where(fixed > 0, first * min(_GROWTH**number, _GREATEST), 1.0)
        scaled = M * unit
        length = np.sqrt((scaled * scaled).sum(axis=1))
        start = fixed * v / unit - cost * unit
        status, x, active, multipliers = nearest(
            scaled / length[:, None], sides / length, start, settings.violation, settings.angle
        )
        moved = np.abs(fixed * (x - v / unit)).max(initial=0.0)
        v = x * unit
        if status != FOUND or moved <= _STILL * (1.0 + np.abs(fixed * x).max(initial=0.0)):
            known = _STATUS.get(status, PointStatus.UNCLEAR)
            return _Answer(known, v, active, multipliers / length[active])
        if np.abs(x).max() > _FAR:
            break
    kind = PointStatus.UNBOUNDED if np.abs(v / unit).max() > _FAR else PointStatus.UNCLEAR
    return _Answer(kind, v, active[:0], multipliers[:0])


def _corner(form: Canonical, answer: _Answer, sides: Vector, settings: MpQpSettings) -> list[int]:
    """Rows that fix v2 at the solution which the cost of ties prefers."""
    curved = form.n - form.free
    flat = form.M[:, curved:]
    active: list[int] = answer.active.tolist()
    if np.linalg.matrix_rank(flat[active], tol=settings.exchange) == form.free:
        return active
    real = np.linalg.norm(flat, axis=1) > settings.exchange
    rows = np.flatnonzero(real)
    held = [row for row in active if real[row]]
    left = sides - form.M[:, :curved] @ answer.v[:curved]
    M = np.vstack([flat[rows], -flat[held]])
    second = _proximal_steps(M, np.concatenate([left[rows], -left[held]]), form.c[:, -1], settings)
    for place in second.active.tolist():
        row = int(rows[place]) if place < len(rows) else -1
        if row >= 0 and np.linalg.matrix_rank(form.M[[*active, row]], tol=settings.exchange) > len(active):
            active.append(row)
    return active
