"""Friction that falls with the slip keeps the second order of time-stepping."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hysdel_py as hys

LAW = hys.Stribeck(1.0, 0.5, 2.0)


def slide(until):
    """Speed of an inertia that a brake slows down, by an integration that knows no drivetrains."""
    answer = solve_ivp(
        lambda _, w: -10 * (0.5 + 0.5 * np.exp(-np.abs(w) / 2)),
        (0, until),
        [8.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-12,
    )
    return float(answer.y[0, -1])


@pytest.mark.parametrize(
    "scheme",
    [
        lambda dt: hys.Moreau(dt=dt),
        lambda dt: hys.Moreau(dt=dt, theta=None),
        lambda dt: hys.AugmentedLagrangian(dt=dt),
        lambda dt: hys.Moreau(dt=dt, solver="newton", decomposition="boxed"),
    ],
    ids=["theta", "Moreau", "augmented Lagrangian", "explicit LCP"],
)
def test_falling_friction_keeps_the_second_order(scheme):
    line = hys.Drivetrain(hys.Inertia("m", 1.0), hys.Brake("brake", "m", 10, LAW))
    errors = [abs(line.simulate({"m": 8}, 0.8, scheme(dt))["m"][-1] - slide(0.8)) for dt in (2e-2, 1e-2, 5e-3)]
    assert errors[-1] < 1e-5
    assert errors[0] / errors[1] > 3.0
    assert errors[1] / errors[2] > 3.5  # first order would halve them
