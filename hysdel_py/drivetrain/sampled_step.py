"""One step of a linear drivetrain as affine forms, and its modes with the conditions under which they hold."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.schemes.options import Karnopp, Moreau
from hysdel_py.drivetrain.schemes.time_stepping import effective_inverse, weights_of

__all__ = ["Branch", "Sampled", "branches_of", "euler_step", "karnopp_branches", "moreau_step"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Sampled:
    """One step as affine forms: rows over (speeds, twists, signals, 1).

    ``slip`` is the slip (or its acceleration) without friction, ``lo`` and ``hi`` limit the impulses (or torques) P;
    ``speeds + A W P`` and ``twists + C P`` are the next state.
    """

    speeds: Matrix
    twists: Matrix
    slip: Matrix
    lo: Matrix
    hi: Matrix
    G: Matrix
    speed_gain: Matrix
    twist_gain: Matrix
    now: Matrix
    per_torque: float


def _forms(equations: Equations) -> tuple[Matrix, Matrix, Matrix, int]:
    """Rows of speeds, twists and signals themselves, and their number."""
    n, m, ns = len(equations.M), len(equations.k), len(equations.signals)
    every = np.eye(n + m + ns + 1)
    return every[:n], every[n : n + m], every[n + m : -1], n + m + ns + 1


def moreau_step(equations: Equations, scheme: Moreau) -> Sampled:
    """One step of Moreau's scheme or of the theta scheme."""
    u, e, s, _ = _forms(equations)
    plant, dt = equations.plant, float(scheme.dt)
    A, weight = effective_inverse(plant, scheme.theta, dt), weights_of(scheme.theta)[0]
    force = equations.gains.force @ s - plant.D @ u
    force -= plant.B @ (plant.k[:, None] * (e + weight * dt * plant.B.T @ u))
    speeds = u + dt * A @ force
    pressure = np.array([law.parameters[0] for law in equations.laws])[:, None] * (equations.gains.pressure @ s)
    gain = A @ plant.W
    return Sampled(
        speeds, e + dt * plant.B.T @ ((1 - weight) * u + weight * speeds), plant.W.T @ speeds,
        dt * plant.side[:, :1] * pressure, dt * plant.side[:, 1:] * pressure, plant.W.T @ gain, gain,
        dt * weight * plant.B.T @ gain, plant.W.T @ u, dt,
    )  # fmt: skip


def euler_step(equations: Equations, scheme: Karnopp) -> Sampled:
    """One Euler step with torques."""
    u, e, s, _ = _forms(equations)
    plant, dt = equations.plant, float(scheme.dt)
    h = equations.gains.force @ s - plant.D @ u - plant.B @ (plant.k[:, None] * e)
    pressure = np.array([law.parameters[0] for law in equations.laws])[:, None] * (equations.gains.pressure @ s)
    return Sampled(
        u + dt * plant.Minv @ h, e + dt * plant.B.T @ u, plant.W.T @ plant.Minv @ h, plant.side[:, :1] * pressure,
        plant.side[:, 1:] * pressure, plant.G, dt * plant.Minv @ plant.W, np.zeros((len(e), len(equations.laws))),
        plant.W.T @ u, 1.0,
    )  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True)
class Branch:
    """A mode: its word, the forms that are not positive where it holds, and the impulses there."""

    word: str
    conditions: tuple[Matrix, ...]
    P: Matrix


def branches_of(step: Sampled) -> list[Branch]:
    """All modes, that in which everything sticks last."""
    return [_branch(step, "".join(word)) for word in product("pns", repeat=len(step.G))]


def _branch(step: Sampled, word: str) -> Branch:
    """One mode: p slips with positive slip, n with negative, s sticks."""
    limits = zip(word, step.lo, step.hi, strict=True)
    rows = [{"p": lo, "n": hi}.get(letter, 0.0 * lo) for letter, lo, hi in limits]
    P = np.array(rows).reshape(step.slip.shape)
    index = [i for i, letter in enumerate(word) if letter == "s"]
    if index:
        slip = (step.slip + step.G @ P)[index]
        P[index] = -np.linalg.lstsq(step.G[np.ix_(index, index)], slip, rcond=1e-12)[0]
    slip = step.slip + step.G @ P
    conditions = []
    for i, letter in enumerate(word):
        match letter:
            case "p":
                conditions.append(-slip[i])
            case "n":
                conditions.append(slip[i])
            case _:
                conditions += [step.lo[i] - P[i], P[i] - step.hi[i]]
    return Branch(word, tuple(conditions), P)


def karnopp_branches(step: Sampled, band: float) -> list[Branch]:
    """Outside the band by the sign of the slip, inside it by the torque that keeps the slip, cut to its limits."""
    if not len(step.G):
        return branches_of(step)
    now, lo, hi = step.now, step.lo, step.hi
    width = np.zeros(step.slip.shape[1])
    width[-1] = band
    stick = -step.slip / step.G[0, 0]
    above, below = now[0] - width, -now[0] - width
    return [
        Branch("s", (above, below, lo[0] - stick[0], stick[0] - hi[0]), stick),
        Branch("low", (above, below, stick[0] - lo[0]), lo),
        Branch("high", (above, below, hi[0] - stick[0]), hi),
        Branch("p", (-now[0],), lo),
        Branch("n", (), hi),
    ]
