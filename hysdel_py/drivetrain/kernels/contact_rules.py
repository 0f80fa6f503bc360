"""Rules that give the torque of every contact at one state, on acceleration level.

Every rule works on the free slip acceleration ``a = W'M^-1 h + gamma0'`` and on the operator ``G = W'M^-1 W``: with
torques lambda the slips accelerate by ``a + G lambda``.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.drivetrain.kernels.box import free_step, solve_box
from hysdel_py.drivetrain.kernels.time_stepping import NEGATIVE, OPEN, POSITIVE, STICK

__all__ = ["HELD", "KARNOPP", "SMOOTH", "SWITCH", "WAIT_NEGATIVE", "WAIT_POSITIVE", "contact_torques"]

SMOOTH, KARNOPP, SWITCH, HELD = 0, 1, 2, 3

WAIT_POSITIVE, WAIT_NEGATIVE = 3, -3
"""Modes of a clutch that has let go but has not yet left the neighbourhood of zero slip."""


@compiled
def contact_torques(G, a, slip, slide, stick, rule, options, mode, P):
    """Torques lambda by a rule; P and, unless the modes are held, `mode` are overwritten.

    Parameters
    ----------
    slide, stick : (lo, hi)
        Limits of lambda for sliding and for sticking contacts.
    rule : int
    options : (band, rate, steepness)
        Half-width of the stick band [rad/s], rate at which slip is driven to zero in it [1/s], steepness of the smooth
        law [s/rad].
    """
    if rule == SMOOTH:
        smooth_torques(slip, slide, options[2], mode, P)
        return
    if rule != HELD:
        modes_by_band(slip, stick, options[0], mode)
    for i in range(len(P)):
        P[i] = sliding_torque(mode[i], slide[0][i], slide[1][i])
    index = np.flatnonzero(mode == STICK)
    if len(index) == 0:
        return
    P += stick_step(G, a, P, index)
    if rule == KARNOPP:
        clip(P, stick, index)
    if rule == SWITCH:
        switch_torques(G, a, slip, stick, options[1], index, P)


@compiled
def smooth_torques(slip, slide, steepness, mode, P):
    """``lambda`` between its limits by an arc tangent of the slip."""
    for i in range(len(P)):
        lo, hi = slide[0][i], slide[1][i]
        P[i] = 0.5 * (hi + lo) - (hi - lo) / np.pi * np.arctan(steepness * slip[i])
        mode[i] = OPEN if hi <= lo else (POSITIVE if slip[i] > 0.0 else NEGATIVE)


@compiled
def modes_by_band(slip, stick, band, mode):
    """Contacts inside the band are candidates for sticking."""
    for i in range(len(mode)):
        if stick[1][i] <= stick[0][i]:
            mode[i] = OPEN
        elif abs(slip[i]) <= band:
            mode[i] = STICK
        else:
            mode[i] = POSITIVE if slip[i] > 0.0 else NEGATIVE


@compiled
def sliding_torque(mode, lo, hi):
    """Torque of a contact that slides or has let go, zero for the others."""
    if mode in (POSITIVE, WAIT_POSITIVE):
        return lo
    if mode in (NEGATIVE, WAIT_NEGATIVE):
        return hi
    return 0.0


@compiled
def stick_step(G, a, P, index):
    """Change of the torques that gives the contacts in `index` no slip acceleration."""
    change = np.zeros(len(P))
    step = free_step(G, a, P, index)
    for k in range(len(index)):
        change[index[k]] = step[k]
    return change


@compiled
def clip(P, stick, index):
    """Cut the torques of sticking contacts to what they can hold."""
    for k in range(len(index)):
        i = index[k]
        P[i] = min(max(P[i], stick[0][i]), stick[1][i])


@compiled
def switch_torques(G, a, slip, stick, rate, index, P):
    """Choose transition or attractive sliding for all candidates together; sliding ones are driven to zero slip.

    The vector fields on both sides of the switching surfaces decide, whatever the slip inside the band: a contact
    slides along its surface where both push towards it. Their joint sign conditions are those of the box-constrained
    problem on acceleration level.
    """
    lo, hi = P.copy(), P.copy()  # contacts outside the band keep their torques
    for k in range(len(index)):
        i = index[k]
        lo[i], hi[i] = stick[0][i], stick[1][i]
    solve_box(G, a, lo, hi, P)
    if rate > 0.0:
        P += stick_step(G, a + rate * slip, P, np.flatnonzero((P > lo) & (P < hi)))
        clip(P, stick, index)
