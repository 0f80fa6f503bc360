"""Limits of one plan: a brake that closes in time, an engine below its curve, forces that the actuators can give."""

import numpy as np
import pytest

from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.demos.shifts.cases import HORIZON, SHIFTS
from hysdel_py.demos.shifts.controllers import BRAKE_RULE, PartController, shift_controller
from hysdel_py.demos.shifts.margins import BRAKED, COASTING, Margins, releasable
from hysdel_py.demos.shifts.methods import Method, first_state
from hysdel_py.demos.shifts.sensors import NOISE, Sensors
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit

DATA = Transmission()
SHIFT = SHIFTS["upshift-23"]
SAME = np.ones(2)


def margins(part=2, noise=None):
    return Margins(SHIFT, part, DATA, BRAKE_RULE, noise or {})


def state(wheel, brake=0.0, engine=100.0, secondary=280.0):
    """A state with this flywheel speed."""
    speed = secondary / DATA.r_gn - wheel / DATA.z
    return np.array([engine, brake, 50.0, 0.1, speed, secondary, secondary * DATA.r_d])


@pytest.mark.parametrize("rate", [300.0, 490.0])
@pytest.mark.parametrize("room", [0.0, 1.0, 30.0, 200.0])
def test_force_is_off_just_where_the_room_ends(room, rate):
    """Fine steps of a brake that is released while the flywheel gains speed."""
    force, travelled, step = float(releasable(np.array(room), rate)), 0.0, 1e-5
    while force > 0.0:
        travelled += step * (COASTING + BRAKED * (force - step * rate / 2))
        force -= step * rate
    assert travelled == pytest.approx(room, abs=0.01)


def test_brake_closes_with_the_flywheel():
    most = [margins().limits(state(wheel), SAME)["Fnb"][1][1] for wheel in (-300.0, -60.0, -20.0, BRAKE_RULE, 5.0)]
    assert most[0] == 0.99 * SHIFT.force, "far from the reversal nothing changes"
    assert np.all(np.diff(most) <= 0)
    assert most[2] > 0.0
    assert most[3:] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_weak_or_noisy_plants_close_earlier():
    seen = state(-60.0)
    usual = margins().limits(seen, SAME)["Fnb"][1][1]
    assert margins().limits(seen, np.array([1.0, 0.8]))["Fnb"][1][1] < usual
    assert margins(noise=NOISE).limits(seen, SAME)["Fnb"][1][1] < usual


def test_no_limit_ends_below_what_the_actuators_reach():
    high = margins(noise=NOISE).limits(state(-10.0, brake=80.0, engine=140.0), SAME)
    steps = 0.01 * np.arange(HORIZON + 1)
    assert np.all(high["Fnb"][1] >= 80.0 - 495.0 * steps)
    assert np.all(high["Te"][1] >= 140.0 - 396.0 * steps)


def test_limits_follow_the_last_plan():
    """A plan in which the flywheel came nearer closes the brake at later steps."""
    mpc = shift_controller(SHIFT, 2, DATA)
    seen = state(-60.0, brake=40.0, engine=80.0)
    kept = margins()
    kept.remember(mpc.solve(seen, {"torque": 600.0}))
    most = kept.limits(seen, SAME)["Fnb"][1]
    assert most[-1] < most[0]
    kept.remember(Move(MoveStatus.INFEASIBLE, ""))
    assert np.ptp(kept.limits(seen, SAME)["Fnb"][1]) == 0.0


def test_engine_stays_below_its_curve_by_the_noise():
    seen = state(-60.0, engine=50.0, secondary=250.0)
    high = margins(noise=NOISE).limits(seen, SAME)["Te"][1]
    assert high == pytest.approx(engine_limit(seen[4]) - NOISE["Te"])
    assert "Te" not in margins().limits(seen, SAME)


def test_forces_end_where_the_actuators_do():
    clutch = margins(part=1).limits(state(-200.0), np.array([0.8, 0.9]))
    assert clutch["Fnc"][1] == pytest.approx(0.8 * 0.99 * SHIFT.release.clutch_force)
    assert clutch["Fnb"][1] == pytest.approx(0.9 * 0.99 * SHIFT.force)


def part_two() -> PartController:
    return Method(SHIFT, DATA, "hybrid", first_state(SHIFT, DATA), Sensors(), observed=False).controller(2)


@pytest.mark.parametrize("wheel", [-12.0, -6.0])
def test_brake_that_is_late_is_released_within_a_plan(wheel):
    """The rule leaves no plan here; the plan without it knows the torque of the brake."""
    seen = state(wheel, brake=60.0, engine=80.0)
    move = part_two().solve(seen, 20)
    assert move.status is MoveStatus.FALLBACK
    assert move.fallback == "late brake"
    assert move.u[1] == -495.0
    assert move.predicted["Fnb"][1] == pytest.approx(60.0, abs=5.0)
