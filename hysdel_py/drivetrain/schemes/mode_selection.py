"""Which contacts stick and which slip after an event: one LCP on acceleration level over all contacts at zero slip."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.decomposition import ContactSolver
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant
from hysdel_py.drivetrain.kernels.box import free_step
from hysdel_py.drivetrain.kernels.delassus import pushed, respond, slips
from hysdel_py.drivetrain.kernels.forces import free_force, sliding_limits, sticking_limits
from hysdel_py.drivetrain.kernels.time_stepping import NEGATIVE, OPEN, POSITIVE, STICK

__all__ = ["project", "select_modes"]

Matrix = NDArray[np.float64]
Modes = NDArray[np.int64]

ZERO_SLIP = 1e-9
"""A slip below this share of the speeds it is the difference of counts as zero at an event."""

BROKEN = 1e-7
"""The limit of a contact that has just let go is lowered by this share, so that it slips at once."""


def select_modes(
    plant: Plant,
    inputs: Inputs,
    u: Matrix,
    e: Matrix,
    modes: Modes,
    is_open: NDArray[np.bool_],
    broken: Mapping[int, int],
    solver: ContactSolver,
) -> tuple[Matrix, Modes]:
    """Speeds with the slips of sticking contacts set to zero, and modes after an event.

    Parameters
    ----------
    inputs : Inputs
        Just behind the event.
    modes : array of shape (nc,)
        Before the event.
    is_open : array of shape (nc,)
    broken : mapping
        Contacts that have reached a limit while sticking, with the mode into which they go.
    solver : ContactSolver
    """
    slip = u @ plant.W + inputs.slip
    scale = ZERO_SLIP * np.maximum(1.0, np.abs(u) @ np.abs(plant.W) + np.abs(inputs.slip))
    at_zero = ~is_open & ((modes == STICK) | (np.abs(slip) <= scale))
    found = np.where(is_open, OPEN, np.where(slip > 0, POSITIVE, NEGATIVE)).astype(np.int64)
    found[at_zero] = STICK
    u = project(plant, slip, u, np.flatnonzero(at_zero))
    free = respond(plant.mass, free_force(plant, inputs.force, inputs.throttle, u, e)) @ plant.W + inputs.slip_rate
    candidates = np.flatnonzero(at_zero)
    for _ in range(len(candidates) + 1):
        candidates = np.flatnonzero(at_zero & (found == STICK))
        slipping = _slipping(plant, inputs, free, slip, found, candidates, broken, solver)
        for contact, mode in slipping.items():
            found[contact] = mode
        if not any(plant.laws[i, 0] > plant.laws[i, 1] for i in slipping):
            break  # sliding torques equal those of the LCP: its answer stands
    return u, found


def project(plant: Plant, slip: Matrix, u: Matrix, index: NDArray[np.int64]) -> Matrix:
    """Speeds after impulses that bring the slips of some contacts to zero."""
    if len(index) == 0:
        return u
    impulses = np.zeros(len(slip))
    impulses[index] = free_step(plant.mass, slip, impulses, index)
    projected: Matrix = u + pushed(plant.mass, impulses)
    return projected


def _slipping(
    plant: Plant,
    inputs: Inputs,
    free: Matrix,
    slip: Matrix,
    modes: Modes,
    candidates: NDArray[np.int64],
    broken: Mapping[int, int],
    solver: ContactSolver,
) -> dict[int, int]:
    """Candidates that slip, with their direction; `modes` tells which of the others slide and how."""
    if len(candidates) == 0:
        return {}
    lo, hi = _limits(plant, inputs, broken)
    torque = _sliding_torques(plant, inputs, slip, modes)
    a = slips(plant.mass, free, torque)[candidates]
    G = np.ascontiguousarray(plant.G[np.ix_(candidates, candidates)])
    low, high = lo[candidates], hi[candidates]
    P = solver.in_order(G, a, low, high)
    acceleration = a + G @ P
    found = {}
    for k, contact in enumerate(candidates):
        size = high[k] - low[k]
        slack = min(P[k] - low[k], high[k] - P[k])
        if slack * G[k, k] <= abs(acceleration[k]) or (slack <= BROKEN * size and contact in broken):
            found[int(contact)] = POSITIVE if P[k] - low[k] < high[k] - P[k] else NEGATIVE
    return found


def _limits(plant: Plant, inputs: Inputs, broken: Mapping[int, int]) -> tuple[Matrix, Matrix]:
    """Static limits of lambda, a little less on the side on which a contact has let go."""
    lo, hi = np.zeros(len(plant.laws)), np.zeros(len(plant.laws))
    sticking_limits(plant, inputs.pressure, lo, hi)
    size = hi - lo
    for contact, mode in broken.items():
        if mode == POSITIVE:
            lo[contact] += BROKEN * size[contact]
        else:
            hi[contact] -= BROKEN * size[contact]
    return lo, hi


def _sliding_torques(plant: Plant, inputs: Inputs, slip: Matrix, modes: Modes) -> Matrix:
    lo, hi = np.zeros(len(modes)), np.zeros(len(modes))
    sliding_limits(plant, inputs.pressure, slip, lo, hi)
    return np.where(modes == POSITIVE, lo, np.where(modes == NEGATIVE, hi, 0.0))
