"""Limits of one plan: a brake that closes in time, an engine below its curve, forces that the actuators can give."""

import numpy as np
import pytest

from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.demos.shifts.cases import HORIZON, SHIFTS
from hysdel_py.demos.shifts.controllers import BRAKE_RULE, PartController, shift_controller
from hysdel_py.demos.shifts.margins import Margins, releasable
from hysdel_py.demos.shifts.methods import Method, first_state
from hysdel_py.demos.shifts.response import slipping
from hysdel_py.demos.shifts.sensors import NOISE, Sensors
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit

DATA = Transmission()
SHIFT = SHIFTS["upshift-23"]
SAME = np.ones(2)


def margins(part=2, noise=None):
    return Margins(SHIFT, part, DATA, BRAKE_RULE, noise or {})


def state(wheel, brake=0.0, engine=100.0, secondary=280.0, clutch=50.0):
    """A state with this flywheel speed."""
    speed = secondary / DATA.r_gn - wheel / DATA.z
    return np.array([engine, brake, clutch, 0.1, speed, secondary, secondary * DATA.r_d])


@pytest.mark.parametrize("coasting", [-90.0, 0.0, 150.0])
@pytest.mark.parametrize("rate", [300.0, 490.0])
@pytest.mark.parametrize("room", [1.0, 30.0, 200.0])
def test_force_is_off_just_where_the_room_ends(room, rate, coasting):
    """Fine steps of a brake that is released while the flywheel gains speed."""
    braked, step, travelled = 12.5, 1e-5, 0.0
    force = float(releasable(np.array(room), rate, coasting, braked))
    while force > 0.0:
        travelled += step * (coasting + braked * (force - step * rate / 2))
        force -= step * rate
    assert travelled == pytest.approx(room, abs=0.02)


def test_flywheel_gains_what_the_plant_gains_when_the_torque_is_kept():
    """The balance of torques against the linear model with the engine torque that keeps the secondary shaft at rest."""
    A = slipping(DATA, SHIFT.gears[1])[0]
    x = state(-150.0, brake=90.0)
    coasting, braked = margins()._accelerations(x, 1.0)
    x[2] = margins()._clutch_meanwhile(x, 1.0)
    x[0] -= (A[5] @ x) / A[5, 0]
    wheel = DATA.z * (A[5] @ x / DATA.r_gn - A[4] @ x)
    assert coasting + braked * 90.0 == pytest.approx(1.1 * wheel, rel=0.02)


def test_clutch_meanwhile_is_a_mean_of_its_ramp():
    weak, strong = state(-150.0, brake=20.0), state(-150.0, brake=150.0)
    for x in (weak, strong):
        t = np.linspace(0.0, x[1] / 490.0, 10001)
        ramp = np.minimum(x[2] + 792.0 * t, 198.0)
        assert margins()._clutch_meanwhile(x, 1.0) == pytest.approx(ramp.mean(), rel=1e-3)


def test_part_one_leads_the_flywheel_no_nearer_than_the_brake_allows():
    """Where part 1 says that the force can just be released, part 2 just allows it."""
    first, second = state(-200.0, brake=110.0), margins()
    first[2] = 0.0
    nearest = margins(part=1).nearest(first, 0.9)
    there = state(nearest, brake=110.0)
    there[2] = 0.0
    force = second.limits(there, np.array([1.0, 0.9]))["Fnb"][1][0]
    assert nearest < -100.0
    assert force == pytest.approx(110.0, rel=1e-6)
    assert margins(part=1).nearest(first, 0.8) < nearest, "a weak brake begins earlier"


def test_brake_closes_with_the_flywheel():
    wheels = (-700.0, -60.0, -20.0, BRAKE_RULE, 5.0)
    most = [margins().limits(state(wheel, clutch=150.0), SAME)["Fnb"][1][1] for wheel in wheels]
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
