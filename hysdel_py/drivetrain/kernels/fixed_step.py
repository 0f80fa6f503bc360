"""Explicit Runge-Kutta methods with fixed step, over a rule for the contact torques."""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.drivetrain.kernels.contact_rules import HELD, contact_torques
from hysdel_py.drivetrain.kernels.delassus import pushed, respond
from hysdel_py.drivetrain.kernels.forces import (
    drag_force,
    sliding_limits,
    source_force,
    spring_force,
    sticking_limits,
    twist_rates,
)
from hysdel_py.drivetrain.kernels.mode_iteration import update_modes
from hysdel_py.drivetrain.kernels.rows import times

__all__ = ["run"]


@compiled
def run(plant, inputs, method, dt, rule, options, u, e, mode, out):
    """As many steps as `inputs` has rows, less one.

    Parameters
    ----------
    inputs : Inputs
        Arrays of shape (N + 1, nodes, size): at the times of the method inside each step.
    method : (a, b, node)
        Runge-Kutta coefficients of shapes (s, s) and (s,), and the node of each stage.
    rule, options
        See :func:`contact_torques`.
    mode : array of shape (nc,)
        First modes; overwritten.
    out : Record
        Row k is at the beginning of step k.
    """
    a, b, node = method
    steps = len(inputs.force) - 1
    count = len(mode)
    slide, stick = (np.zeros(count), np.zeros(count)), (np.zeros(count), np.zeros(count))
    P = np.zeros(count)
    rates = np.zeros((len(b), len(u) + len(e) + 3))
    for k in range(steps + 1):
        if rule == HELD:
            update_modes(plant, inputs, k, u, e, mode, options[0], k == 0)
        for s in range(len(b)):
            y, twist = u.copy(), e.copy()
            for r in range(s):
                y += dt * a[s, r] * rates[r, : len(u)]
                twist += dt * a[s, r] * rates[r, len(u) : len(u) + len(e)]
            stage(plant, inputs, k, node[s], y, twist, rule, options, mode, slide, stick, P, rates[s])
            if s == 0:
                write(out, k, u, e, P, slide, stick, mode)
            if k == steps:
                break
        if k < steps:
            change = dt * (b @ rates)
            u = u + change[: len(u)]
            e = e + change[len(u) : len(u) + len(e)]
            out.works[k + 1] = out.works[k] + change[len(u) + len(e) :]


@compiled
def stage(plant, inputs, k, node, u, e, rule, options, mode, slide, stick, P, rate):
    """Derivatives of speeds, twists and works at one stage; P, the limits and `rate` are overwritten."""
    n, m = len(u), len(e)
    pressure = inputs.pressure[k, node]
    sources = source_force(plant, inputs.force[k, node], inputs.throttle[k, node], u)
    losses = times(plant.damping, u) + drag_force(plant, u)
    h = sources - losses
    spring_force(plant, e, h)
    slip = times(plant.mass.W, u) + inputs.slip[k, node]
    sliding_limits(plant, pressure, slip, slide[0], slide[1])
    sticking_limits(plant, pressure, stick[0], stick[1])
    acceleration = respond(plant.mass, h)
    free = times(plant.mass.W, acceleration) + inputs.slip_rate[k, node]
    contact_torques(plant.mass, free, slip, slide, stick, rule, options, mode, P)
    rate[:n] = acceleration + pushed(plant.mass, P)
    rate[n : n + m] = twist_rates(plant, inputs.twist[k, node], u)
    rate[n + m] = np.dot(sources, u) - np.dot(P, inputs.slip[k, node])
    for i in range(m):
        rate[n + m] += plant.k[i] * e[i] * inputs.twist[k, node, i]
    rate[n + m + 1] = -np.dot(losses, u)
    rate[n + m + 2] = np.dot(P, slip)


@compiled
def write(out, k, u, e, P, slide, stick, mode):
    """Write down the state and the contacts before a step."""
    out.speeds[k], out.twists[k], out.torques[k], out.modes[k] = u, e, P, mode
    for i in range(len(P)):
        limits = stick if mode[i] == 0 else slide
        out.lower[k, i], out.upper[k, i] = limits[0][i], limits[1][i]
