"""The canonical problem at one value of the parameters."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.nearest import FOUND, NONE, nearest
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Point", "PointStatus", "solve_at"]

Vector = NDArray[np.float64]

_ROUNDS, _FAR, _STILL, _SMALL = 400, 1e9, 1e-10, 1e-12
"""Most proximal steps; where a solution is unbounded; when it stands still; the least slope that is divided by."""


class PointStatus(Enum):
    """What is known about the problem at one theta."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    UNCLEAR = "numerical trouble"


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


def solve_at(form: Canonical, s: Vector, settings: MpQpSettings, tie: float | None = None) -> Point:
    """Solve the canonical problem at scaled parameters, with ties broken by a small perturbation.

    Without curvature in all directions the proximal point method is used (R. Rockafellar, "Monotone operators and the
    proximal point algorithm", SIAM Journal on Control and Optimization 14, 1976); each step is a nearest-point problem.
    """
    size = settings.tie if tie is None else tie
    weights = np.concatenate([[1.0], s, [size]])
    sides, slope = form.b @ weights, form.c @ weights
    centre = np.zeros(form.n)
    if not form.free:
        return _point(form, nearest(form.M, sides, centre, settings.violation, settings.angle), centre, 1.0)
    return _by_proximal_steps(form, sides, slope, settings)


def _by_proximal_steps(form: Canonical, sides: Vector, slope: Vector, settings: MpQpSettings) -> Point:
    """Steps ``min 1/2|v1|^2 + c'v2 + |v2 - v2_k|^2 / (2 t)``, with v2 measured in units of sqrt(t)."""
    unit = np.ones(form.n)
    unit[form.n - form.free :] = np.sqrt(10.0 / max(float(np.linalg.norm(slope)), _SMALL))
    M = form.M * unit
    length = np.linalg.norm(M, axis=1)
    M, sides = M / length[:, None], sides / length
    push = np.concatenate([np.zeros(form.n - form.free), slope]) * unit
    fixed = np.concatenate([np.zeros(form.n - form.free), np.ones(form.free)])
    at = np.zeros(form.n)
    for _ in range(_ROUNDS):
        answer = nearest(M, sides, fixed * at - push, settings.violation, settings.angle)
        moved = np.abs(fixed * (answer[1] - at)).max()
        at = answer[1]
        if answer[0] != FOUND or moved <= _STILL * (1.0 + np.abs(at).max()):
            return _point(form, answer, at * unit, length)
        if np.abs(at).max() > _FAR:
            return Point(PointStatus.UNBOUNDED, at * unit, (), np.zeros(form.p + 1))
    return Point(PointStatus.UNCLEAR, at * unit, (), np.zeros(form.p + 1))


def _point(form: Canonical, answer: Any, v: Vector, length: Vector | float) -> Point:
    status, x, active, multipliers = answer
    rows = tuple(sorted(int(row) for row in active))
    if status == FOUND:
        return Point(PointStatus.OPTIMAL, x if isinstance(length, float) else v, rows, np.zeros(form.p + 1))
    weights = multipliers / np.broadcast_to(length, form.m)[active]
    ray = weights @ form.b[active, : form.p + 1]
    return Point(PointStatus.INFEASIBLE if status == NONE else PointStatus.UNCLEAR, v, rows, ray)
