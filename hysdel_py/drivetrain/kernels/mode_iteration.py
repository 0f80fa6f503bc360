"""Controllable clutches with the states unengaged, engaged, locked and wait, updated between two steps.

A clutch locks where its slip has come to zero and it can hold the torque. A locked one that cannot hold goes into the
wait state: it slides in the direction in which it gave way, and returns to the locked state where the acceleration
contradicts that direction. Beyond the band it is engaged. All clutches are iterated together until none changes.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.drivetrain.kernels.contact_rules import (
    WAIT_NEGATIVE,
    WAIT_POSITIVE,
    sliding_torque,
    stick_step,
)
from hysdel_py.drivetrain.kernels.delassus import pushed, respond, slips
from hysdel_py.drivetrain.kernels.forces import free_force, sliding_limits, sticking_limits
from hysdel_py.drivetrain.kernels.rows import times
from hysdel_py.drivetrain.kernels.time_stepping import NEGATIVE, OPEN, POSITIVE, STICK

__all__ = ["update_modes"]

ROUNDING = 1e-9
"""A torque may exceed what a contact holds by this share before it lets go."""


@compiled
def update_modes(plant, inputs, k, u, e, mode, band, first):
    """Modes at the beginning of step k; the slips of clutches that lock are set to zero in u."""
    count = len(mode)
    pressure = inputs.pressure[k, 0]
    slip = times(plant.mass.W, u) + inputs.slip[k, 0]
    slide, stick = (np.zeros(count), np.zeros(count)), (np.zeros(count), np.zeros(count))
    sliding_limits(plant, pressure, slip, slide[0], slide[1])
    sticking_limits(plant, pressure, stick[0], stick[1])
    propose(slip, stick, mode, band, first)
    h = free_force(plant, inputs.force[k, 0], inputs.throttle[k, 0], u, e)
    free = times(plant.mass.W, respond(plant.mass, h)) + inputs.slip_rate[k, 0]
    for _ in range(10 * count + 10):
        if not iterate(plant.mass, free, slide, stick, mode):
            break
    index = np.flatnonzero(mode == STICK)
    if len(index) > 0:
        u += pushed(plant.mass, stick_step(plant.mass, slip, np.zeros(count), index))


@compiled
def propose(slip, stick, mode, band, first):
    """What the slips and normal forces say: open, engaged, or a candidate for locking."""
    for i in range(len(mode)):
        before = mode[i]
        if stick[1][i] <= stick[0][i]:
            mode[i] = OPEN
        elif first or before == OPEN:
            mode[i] = STICK if abs(slip[i]) <= band else side(slip[i])
        elif before in (POSITIVE, NEGATIVE):
            if slip[i] * before <= band:
                mode[i] = STICK
        elif before in (WAIT_POSITIVE, WAIT_NEGATIVE) and slip[i] * before > 3.0 * band:
            mode[i] = before // 3 if before > 0 else NEGATIVE


@compiled
def side(slip):
    """Mode of a contact that slides with this slip."""
    return POSITIVE if slip > 0.0 else NEGATIVE


@compiled
def iterate(G, free, slide, stick, mode):
    """Let the contact go that exceeds its limit most, or lock one that waits in vain; whether a mode changed."""
    count = len(mode)
    P = np.zeros(count)
    for i in range(count):
        P[i] = sliding_torque(mode[i], slide[0][i], slide[1][i])
    P += stick_step(G, free, P, np.flatnonzero(mode == STICK))
    acceleration = slips(G, free, P)
    for i in range(count):
        if mode[i] in (WAIT_POSITIVE, WAIT_NEGATIVE) and acceleration[i] * mode[i] < 0.0:
            mode[i] = STICK
            return True
    worst, excess = -1, ROUNDING
    for i in range(count):
        if mode[i] == STICK:
            size = stick[1][i] - stick[0][i]
            over = max(P[i] - stick[1][i], stick[0][i] - P[i]) / size
            if over > excess:
                worst, excess = i, over
    if worst < 0:
        return False
    mode[worst] = WAIT_POSITIVE if P[worst] < stick[0][worst] else WAIT_NEGATIVE
    return True
