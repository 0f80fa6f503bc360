"""Linear programs of part 1: their dynamics, their values, and what the plant makes of their inputs."""

from dataclasses import replace

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model
from hysdel_py.demos.shifts.methods import first_state
from hysdel_py.demos.shifts.plant import FINE, ShiftPlant
from hysdel_py.demos.shifts.release_program import greatest_held, least_deviation
from hysdel_py.demos.shifts.response import slipping
from hysdel_py.demos.shifts.traction import sustained
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit
from hysdel_py.errors import ArgumentError

DATA = Transmission()
FIRST = SHIFTS["upshift-12"]


@pytest.fixture(scope="module")
def plan():
    return least_deviation(FIRST, DATA, first_state(FIRST, DATA), FIRST.guard.open_by)


def test_dynamics_are_those_of_the_shipped_model():
    A, B, torque = slipping(DATA, 2)
    x, u = np.array([100.0, 40.0, 60.0, 0.1, 560.0, 280.0, 75.0]), np.array([100.0, 200.0, -100.0])
    ts = 1e-6
    euler = hys.load("bist_part1", ts=ts).dha.step(x, u)[0]
    assert x + ts * (A @ x + B @ u) == pytest.approx(euler, abs=1e-9)
    assert torque @ x == pytest.approx(DATA.k * 0.1 + DATA.d * (DATA.r_d * 280.0 - 75.0))


def test_plan_is_proven_the_best(plan):
    assert plan.proven == pytest.approx(plan.deviation, abs=1e-6)
    assert 0.001 < plan.deviation < 0.02, "the shift can be done within 2 % with the slip of its guard"


def test_shift_of_the_document_can_be_done_within_one_percent():
    loose = replace(FIRST, guard=replace(FIRST.guard, slip=0.0))
    assert least_deviation(loose, DATA, first_state(loose, DATA), FIRST.guard.open_by).proven < 0.01


def test_plan_keeps_its_limits(plan):
    slip = plan.x[:, 4] - plan.x[:, 5] / DATA.gears[1]
    assert slip[:47].min() > -1e-6
    assert plan.x[48:, 2].max() <= 0.01 + 1e-6
    assert all(x[0] <= engine_limit(x[4]) + 1e-6 for x in plan.x)
    assert plan.u.min() >= -500 - 1e-6
    assert plan.u.max() <= 800 + 1e-6


def test_plant_follows_the_plan(plan):
    one = ShiftPlant(part_model(FIRST, 1, DATA), DATA, 1)
    x = first_state(FIRST, DATA)
    for k in range(30):
        x = one.step(x, plan.u[k])
    assert x[4:] == pytest.approx(plan.x[30, 4:], abs=1.0)
    assert np.vstack(one.fine)[:, FINE.index("slip")].min() > -0.5


def test_slower_fall_leaves_no_good_plan():
    slow = replace(FIRST, fall=0.5, guard=None)
    assert least_deviation(slow, DATA, first_state(FIRST, DATA), 0.45).proven > 0.1


def test_greatest_held_torque_agrees_with_the_closed_form():
    assert greatest_held(DATA, 2, 40.0, 0.1) == pytest.approx(sustained(DATA, 2, 40.0), rel=2e-3)
    held = greatest_held(DATA, 1, 40.0, 0.1)
    assert held == pytest.approx(sustained(DATA, 1, 40.0), rel=2e-3)
    assert held < 1600


def test_no_plan_is_an_error():
    with pytest.raises(ArgumentError, match="no inputs open the clutch of shift upshift-12"):
        least_deviation(FIRST, DATA, first_state(FIRST, DATA), 0.05)
