"""Normal forces that change: below zero a contact is open, and a function of time may come at any time."""

from __future__ import annotations

import pytest

import hysdel_py as hys

VARIABLE = (hys.EventDriven(), hys.VariableStepMoreau(), hys.Smoothing(steepness=1e4))
EVERY = (*VARIABLE, hys.Exact(), hys.Moreau(), hys.Karnopp(), hys.SwitchModel(), hys.WaitState())


def pair(force):
    return hys.Drivetrain(hys.Inertia("a", 1.0), hys.Inertia("b", 1.0), hys.Clutch("c", "a", "b", force))


@pytest.mark.parametrize("scheme", EVERY, ids=lambda scheme: type(scheme).__name__)
def test_a_force_that_rises_from_below_zero_leaves_the_contact_open_until_zero(scheme):
    line, start = pair([(0, -10), (1, 10)]), {"a": 10, "b": 0}
    assert line.simulate(start, 0.5, scheme)["a"][-1] == pytest.approx(10.0, abs=1e-9)
    assert line.simulate(start, 1.0, scheme)["a"][-1] == pytest.approx(10.0 - 20 * 0.5**2 / 2, abs=1e-3)


@pytest.mark.parametrize("scheme", VARIABLE, ids=lambda scheme: type(scheme).__name__)
def test_a_pulse_between_the_places_that_are_looked_at_is_felt(scheme):
    line = pair(lambda t: 50.0 if 0.6 < t < 0.65 else 0.0)
    run = line.simulate({"a": 10, "b": 0}, 1.0, scheme)
    assert run["a"][-1] == pytest.approx(10.0 - 50 * 0.05, abs=2e-2)
