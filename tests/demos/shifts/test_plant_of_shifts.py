"""The transmission against the equations of its model, and its contacts where the model has none."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model
from hysdel_py.demos.shifts.plant import FINE, Deviation, ShiftPlant
from hysdel_py.demos.shifts.traction import bridged, sustained, traction
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit
from hysdel_py.errors import ArgumentError

DATA = Transmission()
SHIFT = SHIFTS["upshift-23"]


def plant(part=1, **deviation):
    return ShiftPlant(part_model(SHIFT, part, DATA), DATA, SHIFT.gears[part - 1], Deviation(**deviation))


def at_rest(**changes):
    return np.array(list((DATA.stationary(2, 600.0, 75.0) | changes).values()))


def test_slipping_plant_follows_the_shipped_model_in_the_limit_of_small_steps():
    rates = np.array([100.0, 200.0, -100.0])
    start = at_rest(Fnb=40.0, we=556.0)
    seen = plant().step(start, rates)
    gaps = []
    for ts in (1e-3, 1e-4):
        fine, x = hys.load("bist_part1", ts=ts).dha, start
        for _ in range(round(0.01 / ts)):
            x = fine.step(x, rates)[0]
        gaps.append(np.abs(x - seen).max())
    assert gaps[1] < 0.02
    assert gaps[1] < gaps[0] / 5, "Euler comes closer in proportion to its step"


def test_clutch_with_force_to_spare_sticks_and_carries_less_than_it_could():
    one = plant()
    one.step(at_rest(Fnc=150.0), np.zeros(3))
    last = dict(zip(FINE, one.fine[-1][-1], strict=True))
    assert abs(last["slip"]) < 1e-9
    assert 0 < last["Tc"] < 149


def test_brake_opposes_the_flywheel_on_either_side():
    torques = {}
    for engine in (536.0, 300.0):
        one = plant()
        one.step(at_rest(we=engine, Fnb=50.0, Fnc=0.0), np.zeros(3))
        last = dict(zip(FINE, one.fine[-1][-1], strict=True))
        torques[np.sign(last["wf"])] = last["Tb"]
    assert torques == {-1.0: pytest.approx(-50.0), 1.0: pytest.approx(50.0)}


def test_deviation_changes_friction_and_mass():
    weak = plant(friction=0.8)
    weak.step(at_rest(Fnc=50.0), np.zeros(3))
    assert weak.fine[-1][-1][FINE.index("Tc")] == pytest.approx(40.0)
    with pytest.raises(ArgumentError, match=r"mass is 0.0: a factor above zero was expected"):
        Deviation(mass=0.0)


@pytest.mark.parametrize(("speed", "torque"), [(84, 60), (105, 105), (419, 145), (628, 127), (524.5, 135.914)])
def test_engine_curve_at_its_knots(speed, torque):
    assert engine_limit(speed) == pytest.approx(torque, abs=1e-3)


def test_engine_curve_beyond_its_last_knot():
    assert engine_limit(700) == pytest.approx(127 - 72 * 18 / 209)
    assert engine_limit(700, beyond="range") == 145
    with pytest.raises(ArgumentError, match='"line" or "range" was expected'):
        engine_limit(700, beyond="flat")


def test_traction_covers_the_cases_of_the_document():
    assert traction(DATA, 1, 40) > 1600
    assert traction(DATA, 2, 40) > 850
    assert traction(DATA, 3, 75) > 600
    assert traction(DATA, 2, 75) > 800 > traction(DATA, 3, 75)
    assert traction(DATA, 1, 100) == 0.0


def test_sustained_torque_is_what_the_plant_swings_about():
    torque = sustained(DATA, 2, 60.0)
    start = DATA.stationary(2, torque, 60.0) | {"Te": engine_limit(DATA.engine_speed(2, 60.0)), "Fnc": 200.0}
    one, x, seen = plant(), np.array(list(start.values())), []
    for _ in range(60):
        x = one.step(x, np.zeros(3))
        seen.append(DATA.k * x[3] + DATA.d * (DATA.r_d * x[5] - x[6]))
        x[0] = engine_limit(x[4])
    assert np.mean(seen) == pytest.approx(torque, rel=0.03)


def test_bridged_torque_leaves_the_secondary_shaft_at_rest():
    torque = bridged(DATA, 100.0, 60.0)
    x = at_rest(Te=100.0, Fnb=60.0, Fnc=0.0, dphi=torque / DATA.k, we=500.0)
    after = plant().step(x, np.zeros(3))
    assert after[5] == pytest.approx(x[5], abs=0.05)
