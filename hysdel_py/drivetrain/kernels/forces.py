"""Generalised forces and limits of contact torques at one state."""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.drivetrain.kernels.rows import add_transposed, times

__all__ = [
    "drag_force", "free_force", "sliding_limits", "source_force", "spring_force", "sticking_limits", "twist_rates",
]  # fmt: skip


@compiled
def source_force(plant, force, throttle, u):
    """Generalised force of the sources: given torques and engine maps."""
    total = force.copy()
    for i in range(len(plant.map_sizes)):
        speed = 0.0
        for j in range(len(u)):
            speed += plant.map_directions[j, i] * u[j]
        torque = map_torque(plant, i, throttle[i], speed)
        for j in range(len(u)):
            total[j] += plant.map_directions[j, i] * torque
    return total


@compiled
def drag_force(plant, u):
    """Generalised force of the drag against the motion."""
    total = np.zeros(len(u))
    for i in range(len(plant.drag)):
        speed = 0.0
        for j in range(len(u)):
            speed += plant.drag_directions[j, i] * u[j]
        for j in range(len(u)):
            total[j] += plant.drag_directions[j, i] * plant.drag[i] * speed * abs(speed)
    return total


@compiled
def spring_force(plant, e, total):
    """Subtract the forces of the springs from `total`."""
    add_transposed(plant.springs, -plant.k * e, total)


@compiled
def free_force(plant, force, throttle, u, e):
    """All forces but friction at given speeds and twists."""
    total = source_force(plant, force, throttle, u) - times(plant.damping, u) - drag_force(plant, u)
    spring_force(plant, e, total)
    return total


@compiled
def twist_rates(plant, given, u):
    """Derivatives of the twists."""
    return given + times(plant.springs, u)


@compiled
def map_torque(plant, i, throttle, speed):
    """Torque of engine map i, bilinear inside and constant outside."""
    rows, columns = plant.map_sizes[i, 0], plant.map_sizes[i, 1]
    a, p = bracket(plant.map_throttle[i, :rows], throttle)
    b, q = bracket(plant.map_speed[i, :columns], speed)
    table = plant.map_torque[i]
    low = (1.0 - q) * table[a, b] + q * table[a, b + 1]
    high = (1.0 - q) * table[a + 1, b] + q * table[a + 1, b + 1]
    return (1.0 - p) * low + p * high


@compiled
def bracket(axis, x):
    """Index of the interval of x on an axis, and its share of that interval in [0, 1]."""
    k = int(np.searchsorted(axis, x)) - 1
    k = min(max(k, 0), len(axis) - 2)
    share = (x - axis[k]) / (axis[k + 1] - axis[k])
    return k, min(max(share, 0.0), 1.0)


@compiled
def coefficient(law, speed):
    """Friction coefficient of a sliding contact."""
    if law[2] == 0.0:
        return law[1]
    return law[1] + (law[0] - law[1]) * np.exp(-((abs(speed) / law[2]) ** law[3]))


@compiled
def sliding_limits(plant, pressure, slip, lo, hi):
    """Limits of lambda for sliding contacts; lo and hi are overwritten."""
    for i in range(len(lo)):
        capacity = coefficient(plant.laws[i], slip[i]) * pressure[i]
        lo[i] = plant.side[i, 0] * capacity
        hi[i] = plant.side[i, 1] * capacity


@compiled
def sticking_limits(plant, pressure, lo, hi):
    """Limits of lambda for sticking contacts; lo and hi are overwritten."""
    for i in range(len(lo)):
        lo[i] = plant.side[i, 0] * plant.laws[i, 0] * pressure[i]
        hi[i] = plant.side[i, 1] * plant.laws[i, 0] * pressure[i]
