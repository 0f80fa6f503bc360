"""The engagement of section 9.1: reference numbers, behaviour, and the exact step of the clutch."""

import numpy as np
import pytest

from hysdel_py.demos.dry_clutch import DryClutch
from hysdel_py.demos.dynamic_programming import START, engage_by_dp, engagement_problem, judged_engagement

KNOWN = np.array([40.0, 80, 120, 160, 180, 160, 120, *[100] * 13])[:, None]
"""The optimal clutch torque for these assumptions."""


def run_of(clutch, inputs, start=START):
    x = [np.array(start)]
    for u in inputs:
        x.append(clutch(x[-1][None], u[None])[0])
    return np.array(x)


@pytest.fixture(scope="module")
def demo():
    return engage_by_dp(grid=1.0)


def test_the_optimum_is_found_backward_and_forward(demo):
    assert demo.engaged
    np.testing.assert_array_equal(demo.backward.trajectory.u, KNOWN)
    np.testing.assert_array_equal(demo.forward.plan.trajectory.u, KNOWN)
    assert demo.forward.plan.planned == pytest.approx(demo.forward.plan.cost, rel=1e-12)
    assert demo.backward.planned == pytest.approx(demo.backward.cost, rel=3e-4)


def test_the_behaviour_is_that_of_the_document(demo):
    """The slip falls from the start, the engine is kept at 80 rad/s exactly, the lock-up is gentle."""
    x = demo.backward.trajectory.x
    slip, f = x[:, 0] - x[:, 1], demo.figures()
    locked = round(f["lock_time"] / 0.05)
    assert (np.diff(slip[2 : locked + 1]) < 0).all()
    assert f["least_engine_speed"] == pytest.approx(80, abs=1e-9)
    np.testing.assert_allclose(x[7:locked, 0], 80)
    assert f["lock_acceleration"] < 65
    assert f["end_slip"] < 1e-6


def test_costs_of_the_reference(demo):
    """345000 and 348234 of an independent implementation, within the thousandth that details of the cost make."""
    f = demo.figures()
    assert f["cost"] == pytest.approx(344902, rel=1e-4)
    assert f["slip"] == pytest.approx(344006, rel=1e-4)
    assert f["increments"] == pytest.approx(780)
    assert f["lock_up"] == pytest.approx(116, rel=0.06)


def test_the_implicit_step_gives_the_planned_cost_of_the_reference():
    problem = engagement_problem(scheme="implicit")
    plan = problem.backward().plan(START, [0.0])
    assert plan.planned == pytest.approx(348234, rel=1e-4)
    np.testing.assert_array_equal(plan.trajectory.u, KNOWN)
    document = problem.forward(START, last_input=[0.0], snap=True, remember_input=False).plan
    assert document.planned == pytest.approx(348290, rel=2e-3)
    assert document.cost == pytest.approx(plan.cost, rel=3e-3)


def test_two_inputs_cost_less_than_one():
    problem = engagement_problem(5.0, 20.0, engine_torques=4)
    two = problem.forward(START, last_input=[0.0, 100.0], remember_input=False).plan
    assert two.cost < 0.6 * 344902
    assert set(two.trajectory.u[:, 1]) <= {0.0, 140 / 3, 280 / 3, 140.0}


def test_the_table_is_a_feedback(demo):
    """From a disturbed state in the middle of the run the table still engages the clutch."""
    clutch, table = DryClutch(), demo.table
    x, last = demo.backward.trajectory.x[6] + [1.3, -2.1], KNOWN[5]
    for k in range(6, 20):
        last = table(x, k, last)
        x = clutch(x[None], last[None])[0]
        assert x[0] > 80 - 1e-9
    assert abs(x[0] - x[1]) < 1e-6


def test_the_exact_step_is_the_limit_of_small_implicit_ones():
    rng = np.random.default_rng(0)
    x = rng.uniform(60, 150, (200, 2))
    x[:100, 0] = x[:100, 1] + rng.uniform(-3, 3, 100)
    x[:20, 0] = x[:20, 1]
    u = np.stack([rng.uniform(0, 180, 200), rng.uniform(0, 150, 200)], axis=1)
    small = DryClutch(scheme="implicit", sample_time=0.05 / 2000)
    errors = []
    for steps in (1000, 2000):
        after, small = x, DryClutch(scheme="implicit", sample_time=0.05 / steps)
        for _ in range(steps):
            after = small(after, u)
        errors.append(np.abs(after - DryClutch()(x, u)).max())
    assert errors[1] < 0.01
    assert errors[1] < 0.6 * errors[0]


def test_lock_up_and_break_away_within_a_step():
    """Lock-up without load after dw J1 J2 / ((J1 + J2) T) at the common speed; break-away where the torque suffices."""
    free = DryClutch(engine_torque=0.0, drag=1e-9, sample_time=0.4)
    after = free(np.array([[120.0, 20.0]]), np.array([[50.0]]))
    np.testing.assert_allclose(after, [[40.0, 40.0]], atol=1e-4)
    before = DryClutch(engine_torque=0.0, drag=1e-9, sample_time=0.31)(np.array([[120.0, 20.0]]), np.array([[50.0]]))
    assert before[0, 0] - before[0, 1] == pytest.approx(0.01 * 50 * (1 / 0.2 + 1 / 0.8), abs=1e-4)
    clutch = DryClutch()
    held = clutch.stick_torque(np.array([80.0]), 100.0)
    slips = clutch(np.array([[80.0, 80.0]]), np.array([held - 1.0]))
    sticks = clutch(np.array([[80.0, 80.0]]), np.array([held + 20.0]))
    assert slips[0, 0] > slips[0, 1]
    assert sticks[0, 0] == sticks[0, 1]


def test_the_parts_of_the_cost_add_up():
    f = judged_engagement(run_of(DryClutch(), KNOWN), KNOWN)
    assert f["cost"] == f["slip"] + f["increments"] + f["lock_up"]
