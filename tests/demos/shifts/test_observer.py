"""The observer against the plant: it finds the friction, filters noise, and looks ahead over a delay."""

import numpy as np
import pytest

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model
from hysdel_py.demos.shifts.observer import ShiftObserver
from hysdel_py.demos.shifts.plant import Deviation, ShiftPlant
from hysdel_py.demos.shifts.response import slipping
from hysdel_py.demos.shifts.sensors import NOISE, Sensors
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.lti import Lti

DATA = Transmission()
SHIFT = SHIFTS["upshift-23"]


def slipping_run(observer, sensors, deviation, steps=30):
    """The plant with both contacts slipping, seen by an observer: true and estimated states, and what the plant did."""
    plant = ShiftPlant(part_model(SHIFT, 1, DATA), DATA, 2, deviation)
    x = np.array(list((DATA.stationary(2, 600.0, 75.0) | {"we": 560.0, "Fnb": 60.0, "Te": 110.0}).values()))
    u, last, seen = np.zeros(3), np.zeros(3), []
    for k in range(steps):
        seen.append((x, observer.update(sensors.read(x), last)))
        u = np.array([50.0, 100.0, -100.0]) * (1 if k % 4 < 2 else -1)
        x, last = plant.step(x, u), u
    return seen, plant.fine


@pytest.mark.parametrize("friction", [0.8, 1.0, 1.2])
def test_finds_the_friction_of_clutch_and_brake(friction):
    observer = ShiftObserver(DATA, 2, 0.01)
    slipping_run(observer, Sensors(), Deviation(friction=friction))
    assert observer.factors == pytest.approx([friction, friction], abs=0.03)


def test_finds_it_under_noise_and_filters_the_speeds():
    observer, sensors = ShiftObserver(DATA, 2, 0.01), Sensors(NOISE, 3)
    seen, _ = slipping_run(observer, sensors, Deviation(friction=0.8), 60)
    assert observer.factors == pytest.approx([0.8, 0.8], abs=0.1)
    errors = np.array([estimate[5] - x[5] for x, estimate in seen[10:]])
    assert errors.std() < 0.95 * NOISE["ws"]


def test_finds_what_the_model_lacks():
    """A vehicle that is lighter and brakes harder: the acceleration that the model does not know, and its torque."""
    observer, deviation = ShiftObserver(DATA, 2, 0.01), Deviation(load=1.2, mass=0.8)
    seen, _ = slipping_run(observer, Sensors(), deviation)
    x = seen[-1][0]
    torque = DATA.k * x[3] + DATA.d * (DATA.r_d * x[5] - x[6])
    true, known = ((torque - b * DATA.b_v * x[6]) / (m * DATA.J_v) for b, m in ((1.2, 0.8), (1.0, 1.0)))
    assert observer.beside[2] == pytest.approx(true - known, abs=0.2)
    assert observer.torque_beside > 0.0, "wheels that fall behind twist the shaft"


def test_model_is_right_about_the_twist_with_what_it_lacks():
    """One sample of the linear model from the shifted state, against the plant with heavier shafts."""
    observer, deviation = ShiftObserver(DATA, 2, 0.01), Deviation(inertia=1.2, mass=0.9)
    seen, _ = slipping_run(observer, Sensors(), deviation, 20)
    (x, estimate), (after, _) = seen[8], seen[9]
    sampled = Lti.sampled(*slipping(DATA, 2)[:2], ts=0.01)
    u = (after[:3] - x[:3]) / 0.01

    def bend(state):
        """Change of the rate of the twist."""
        then = sampled.A @ state + sampled.B @ (u * [1.0, *observer.factors[::-1]])
        return DATA.r_d * (then[5] - state[5]) - (then[6] - state[6])

    true = DATA.r_d * (after[5] - x[5]) - (after[6] - x[6])
    assert abs(bend(estimate) - true) < 0.5 * abs(bend(x) - true)


def test_shift_that_begins_at_rest_knows_its_slip():
    x = np.array(list(DATA.stationary(2, 600.0, 75.0).values()))
    slips = []
    for seed in range(20):
        observer = ShiftObserver(DATA, 2, 0.01, settled=True)
        seen = observer.update(Sensors(NOISE, seed).read(x), np.zeros(3))
        slips.append((DATA.relative_speed(2, seen[4], seen[5]), DATA.r_d * seen[5] - seen[6]))
    assert np.abs(slips).max(axis=0) == pytest.approx([0.0, 0.0], abs=0.02)


def test_clutch_that_is_measured_to_stick_teaches_nothing():
    """The estimate alone may be wrong by more than a slip."""
    observer = ShiftObserver(DATA, 2, 0.01)
    x = np.array(list((DATA.stationary(2, 600.0, 75.0) | {"Fnc": 150.0}).values()))
    observer.update(x + np.eye(7)[4] * 8.0, np.zeros(3))
    observer.update(x, np.zeros(3))
    assert observer.factors.tolist() == [1.0, 1.0]


def test_looks_ahead_over_the_delay():
    deviation = Deviation(delay=0.005)
    seen, fine = slipping_run(ShiftObserver(DATA, 2, 0.01, 1.0, 0.005), Sensors(), deviation)
    x, estimate = seen[6]  # later the clutch sticks
    then = fine[6][9][:7]
    assert estimate[4] == pytest.approx(then[4], abs=0.05)
    assert abs(then[4] - x[4]) > 0.1
    assert estimate[:3] == pytest.approx(then[:3], rel=0.03), "effective forces, with factors near one"


def test_clutch_that_sticks_teaches_nothing():
    observer = ShiftObserver(DATA, 2, 0.01)
    x = np.array(list((DATA.stationary(2, 600.0, 75.0) | {"Fnc": 150.0}).values()))
    for _ in range(10):
        observer.update(x, np.zeros(3))
    assert observer.factors.tolist() == [1.0, 1.0]


def test_friction_survives_the_gear_change():
    observer = ShiftObserver(DATA, 2, 0.01, 0.9)
    observer.change_gear(3)
    assert (observer.gear, observer.factors.tolist()) == (3, [0.9, 0.9])


def test_sensors_repeat_themselves_and_know_their_states():
    x = np.arange(7.0)
    first, second = Sensors(NOISE, 5), Sensors(NOISE, 5)
    assert np.array_equal(first.read(x), first.read(x))
    assert np.array_equal(first.read(x), second.read(x))
    assert not np.array_equal(first.read(x + 1), x + 1)
    assert np.array_equal(Sensors().read(x), x)
    with pytest.raises(ArgumentError, match="noise of 'speed': one of Te, Fnb"):
        Sensors({"speed": 1.0})
    with pytest.raises(ArgumentError, match="noise of we is -1"):
        Sensors({"we": -1})


def test_torque_and_forces_follow_the_rates_and_lose_most_of_their_noise():
    observer, sensors = ShiftObserver(DATA, 2, 0.01, 1.0, 0.005), Sensors(NOISE, 5)
    seen, fine = slipping_run(observer, sensors, Deviation(delay=0.005), 60)
    engine = np.array([estimate[0] - fine[k][9][0] for k, (_, estimate) in enumerate(seen)])
    assert abs(engine[20:].mean()) < 0.3
    assert engine[20:].std() < 0.5 * NOISE["Te"]
