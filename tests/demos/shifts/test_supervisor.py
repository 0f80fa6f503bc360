"""Decisions of the supervisor, one by one."""

import pytest

from hysdel_py.demos.shifts.supervisor import Supervisor
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.errors import ArgumentError

BOSS = Supervisor()


def test_stays_where_the_engine_is_well():
    decision = BOSS.decide(2, 40.0, 0.5, 500.0, 5.0)
    assert (decision.gear, decision.shift, decision.reason) == (2, None, "")


def test_pedal_scales_the_torque():
    half, full = (BOSS.decide(2, 40.0, pedal, 300.0, 5.0).torque for pedal in (0.2, 0.4))
    assert full == pytest.approx(2 * half)


def test_upshift_when_the_engine_is_fast():
    decision = BOSS.decide(1, 38.0, 0.5, 700.0, 5.0)
    assert decision.gear == 2
    assert decision.shift.gears == (1, 2)
    assert decision.shift.torques[0] == 700.0
    assert decision.shift.torques[1] == decision.torque <= 0.95 * 950
    assert "above 385 rad/s" in decision.reason


def test_downshift_when_the_engine_is_slow():
    decision = BOSS.decide(3, 25.0, 0.15, 250.0, 5.0)
    assert decision.shift.gears == (3, 2)
    assert decision.shift.release.brake_force == 0.01, "a downshift leaves the brake off"


def test_rests_between_shifts():
    decision = BOSS.decide(1, 38.0, 0.5, 700.0, 0.3)
    assert decision.shift is None
    assert "1 s after a shift at most" in decision.reason


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((1, 38.0, 0.05, 60.0, 5.0), "150 Nm are needed to move the engine"),
    ],
)
def test_refuses_with_a_reason(arguments, words):
    decision = BOSS.decide(*arguments)
    assert decision.shift is None
    assert decision.gear == arguments[0]
    assert words in decision.reason


def test_refuses_what_a_weak_brake_cannot_carry():
    weak = Supervisor(Transmission(mu=0.1))
    decision = weak.decide(1, 38.0, 0.7, 700.0, 5.0)
    assert decision.shift is None
    assert "at most with the clutch open" in decision.reason


def test_kick_down_begins_with_what_the_engine_alone_carries():
    decision = BOSS.decide(3, 40.0, 1.0, 400.0, 5.0)
    assert decision.shift.gears == (3, 2)
    assert decision.reason == "kick-down"
    assert decision.torque < 3.73 * 130
    assert decision.torque < BOSS.decide(2, 40.0, 1.0, 400.0, 5.0).torque


def test_wrong_arguments():
    with pytest.raises(ArgumentError, match=r"pedal is 1.5: a number from 0 to 1 was expected"):
        BOSS.decide(1, 20.0, 1.5, 100.0, 5.0)
    with pytest.raises(ArgumentError, match="gear is 4: one of 1, 2, 3 was expected"):
        BOSS.decide(4, 20.0, 0.5, 100.0, 5.0)
