"""Time-stepping on velocity level: many steps of Moreau's scheme or of the theta scheme, also with prox iterations.

One step from speeds u and twists e at t to t + dt, all contact torques as impulses P:

    du  = A (dt (f - D u - drag - B k (e + a dt (B'u + e0))) + W P)
    e+  = e + dt (B'(u + b du) + e0)
    gamma+ = W'(u + du) + gamma0 in the normal cone of the torques at P

with A = M^-1, a = b = 1/2 (J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988)
or A = (M + theta dt D + theta^2 dt^2 B k B')^-1, a = b = theta (M. Jean, Comput. Methods Appl. Mech. Eng. 177, 1999).
Forces that are not linear, and the friction of sliding contacts, enter at the speed extrapolated to the middle of the
step.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.drivetrain.kernels.box import solve_box
from hysdel_py.drivetrain.kernels.delassus import pushed, respond, slips
from hysdel_py.drivetrain.kernels.forces import (
    drag_force,
    sliding_limits,
    source_force,
    spring_force,
    sticking_limits,
    twist_rates,
)
from hysdel_py.drivetrain.kernels.prox import solve_prox
from hysdel_py.drivetrain.kernels.rows import times

__all__ = [
    "NEGATIVE", "OPEN", "POSITIVE", "STICK", "advance", "count_work", "free_motion", "limits_of", "may_hold",
    "record", "run",
]  # fmt: skip

NEGATIVE, STICK, POSITIVE, OPEN = -1, 0, 1, 2

AT_LIMIT = 1e-10
"""An impulse this near to a limit, as a share of the range, is at it."""


@compiled
def free_motion(plant, G, weight, dt, force, throttle, twist_rate, u, e, middle):
    """Speeds at the end of the step without friction.

    ``middle`` is the speed at which the forces that are not linear are taken.
    """
    f = source_force(plant, force, throttle, middle) - times(plant.damping, u) - drag_force(plant, middle)
    spring_force(plant, e + weight * dt * twist_rates(plant, twist_rate, u), f)
    return u + respond(G, dt * f)


@compiled
def advance(plant, weight, dt, twist_rate, u, e, u1):
    """Twists at the end of the step."""
    return e + dt * twist_rates(plant, twist_rate, (1.0 - weight) * u + weight * u1)


@compiled
def mode_of(P, lo, hi):
    """Mode of a contact from its impulse."""
    if hi <= lo:
        return OPEN
    margin = AT_LIMIT * (hi - lo)
    if P <= lo + margin:
        return POSITIVE
    if P >= hi - margin:
        return NEGATIVE
    return STICK


@compiled
def limits_of(plant, pressure, slip, mode, dt, lo, hi):
    """Limits of the impulses: static for contacts that stick, else those of the sliding speed."""
    count = len(lo)
    lo_stick, hi_stick = np.empty(count), np.empty(count)
    sliding_limits(plant, pressure, slip, lo, hi)
    sticking_limits(plant, pressure, lo_stick, hi_stick)
    for i in range(count):
        if mode[i] == STICK:
            lo[i], hi[i] = lo_stick[i], hi_stick[i]
        lo[i] *= dt
        hi[i] *= dt


@compiled
def impulses(plant, G, rows, c, pressure, slip, sliding, mode, dt, solver, P, lo, hi):
    """Impulses of one step: P, lo and hi are overwritten.

    Parameters
    ----------
    slip, sliding : arrays of shape (nc,)
        Slips at the beginning of the step, and those at which the friction of sliding contacts is taken.

    Returns
    -------
    int
        Iterations, or -1 where a limit of iterations was reached.
    """
    limits_of(plant, pressure, sliding, mode, dt, lo, hi)
    spent = solve_one(G, rows, c, solver, dt, P, lo, hi)
    if may_hold(plant, G, c, pressure, slip, mode, dt, P, lo, hi):
        more = solve_one(G, rows, c, solver, dt, P, lo, hi)
        spent = spent + more if spent >= 0 and more >= 0 else -1
    return spent


@compiled
def may_hold(plant, G, c, pressure, slip, mode, dt, P, lo, hi):
    """Give contacts whose slip ends or changes its sign in this step their static limits; whether there is one.

    Only contacts that hold more than they transmit while sliding need it: the problem is then solved again.
    """
    again = False
    end = np.zeros(0)
    for i in range(len(c)):
        if plant.laws[i, 0] > plant.laws[i, 1] and mode[i] != STICK:
            if len(end) == 0:
                end = slips(G, c, P)
            if end[i] * slip[i] < 0.0 or (lo[i] < P[i] < hi[i]):
                capacity = plant.laws[i, 0] * pressure[i] * dt
                lo[i], hi[i] = plant.side[i, 0] * capacity, plant.side[i, 1] * capacity
                again = True
    return again


@compiled
def solve_one(G, rows, c, solver, dt, P, lo, hi):
    """One contact problem by the solver that ``solver = (kind, steepness, tolerance, iterations)`` names."""
    if solver[0] == 0.0:
        return solve_box(G, c, lo, hi, P)
    return solve_prox(G, rows, c, lo, hi, P, solver, dt)


@compiled
def run(plant, inputs, G, rows, weights, dt, solver, u, e, mode, out):
    """As many steps as `inputs` has rows.

    Parameters
    ----------
    G : Delassus
        Through the inertia matrix ``A^-1``.
    rows : Rows
        Of G, for the solvers that go through them.
    weights : (float, float)
        a = b, and the weight of the new speed in the damping.
    solver : (kind, steepness, tolerance, iterations)
    mode : array of shape (nc,)
        Modes before the first step; overwritten.
    out : Record
        Row k + 1 is after step k.
    """
    weight = weights[0]
    count = len(mode)
    P, lo, hi = np.zeros(count), np.zeros(count), np.zeros(count)
    before = u.copy()
    out.speeds[0], out.twists[0] = u, e
    slip = times(G.W, u) + inputs.slip[0]
    slip_before = slip
    for k in range(len(inputs.force)):
        middle = 1.5 * u - 0.5 * before
        free = free_motion(plant, G, weight, dt, inputs.force[k], inputs.throttle[k], inputs.twist[k], u, e, middle)
        c = times(G.W, free) + inputs.slip[k]
        sliding = 1.5 * slip - 0.5 * slip_before
        out.effort[k] = impulses(
            plant, G, rows, c, inputs.pressure[k], slip, sliding, mode, dt, solver, P, lo, hi
        )  # fmt: skip
        u1 = free + pushed(G, P)
        e1 = advance(plant, weight, dt, inputs.twist[k], u, e, u1)
        count_work(plant, inputs, k, weights, dt, (u, u1), (e, e1), middle, P, out.works)
        before, u, e = u, u1, e1
        slip_before, slip = slip, times(G.W, u) + inputs.slip[k]
        record(out, k + 1, u, e, P, lo, hi, mode, dt)


@compiled
def record(out, row, u, e, P, lo, hi, mode, dt):
    """Write down the state and the contacts after a step, and find their modes."""
    out.speeds[row], out.twists[row] = u, e
    for i in range(len(P)):
        mode[i] = mode_of(P[i], lo[i], hi[i])
        out.modes[row, i] = mode[i]
        out.torques[row, i] = P[i] / dt
        out.lower[row, i] = lo[i] / dt
        out.upper[row, i] = hi[i] / dt


@compiled
def count_work(plant, inputs, k, weights, dt, speeds, twists, middle, P, works):
    """Work of sources, losses and friction up to the end of step k, with the forces that the step used."""
    u, u1 = speeds
    average = 0.5 * (u + u1)
    damping = times(plant.damping, u + weights[1] * (u1 - u))
    source = dt * np.dot(source_force(plant, inputs.force[k], inputs.throttle[k], middle), average)
    friction = np.dot(P, times(plant.mass.W, average) + inputs.slip[k])
    source -= np.dot(P, inputs.slip[k])
    for i in range(len(plant.k)):
        source += dt * plant.k[i] * 0.5 * (twists[0][i] + twists[1][i]) * inputs.twist[k, i]
    works[k + 1, 0] = works[k, 0] + source
    works[k + 1, 1] = works[k, 1] - dt * np.dot(damping + drag_force(plant, middle), average)
    works[k + 1, 2] = works[k, 2] + friction
