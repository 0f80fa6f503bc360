"""The observer against the plant: it finds the friction, filters noise, and looks ahead over a delay."""

import numpy as np
import pytest

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model
from hysdel_py.demos.shifts.observer import ShiftObserver
from hysdel_py.demos.shifts.plant import Deviation, ShiftPlant
from hysdel_py.demos.shifts.sensors import NOISE, Sensors
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.errors import ArgumentError

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
    assert observer.factors == pytest.approx([friction, friction], abs=0.02)


def test_finds_it_under_noise_and_filters_the_speeds():
    observer, sensors = ShiftObserver(DATA, 2, 0.01), Sensors(NOISE, 3)
    seen, _ = slipping_run(observer, sensors, Deviation(friction=0.8), 60)
    assert observer.factors == pytest.approx([0.8, 0.8], abs=0.1)
    errors = np.array([estimate[5] - x[5] for x, estimate in seen[10:]])
    assert errors.std() < 0.95 * NOISE["ws"]


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
