"""The engine law of a closed clutch: it reaches the torque, and the drive shaft stops swinging."""

import numpy as np
import pytest

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model
from hysdel_py.demos.shifts.plant import FINE, ShiftPlant
from hysdel_py.demos.shifts.tracking import ClosedClutch
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.errors import ArgumentError

DATA = Transmission()


def step_up(damping, gear=3, steps=80):
    """Torque of the drive shaft after a step of the wanted one from 300 to 450 Nm."""
    plant = ShiftPlant(part_model(SHIFTS["upshift-23"], 2, DATA), DATA, gear)
    law = ClosedClutch(DATA, gear, 0.01, damping)
    x = np.array(list((DATA.rolling(gear, 300.0, 70.0) | {"Fnc": 200.0}).values()))
    for _ in range(steps):
        x = plant.step(x, np.array([law.rate(x, 450.0), 0.0, 0.0]))
    fine = np.vstack(plant.fine)
    dphi, ws, wv = (fine[:, FINE.index(name)] for name in ("dphi", "ws", "wv"))
    return DATA.k * dphi + DATA.d * (DATA.r_d * ws - wv)


def test_reaches_the_torque_and_settles():
    torque = step_up(0.4)
    assert torque[-200:] == pytest.approx(450.0, abs=5.0)


def test_without_damping_it_swings_on():
    assert np.ptp(step_up(0.0)[-400:]) > 5 * np.ptp(step_up(0.4)[-400:])


def test_frequency_is_that_of_the_plant():
    swinging = step_up(0.0)[600:] - 450.0
    crossings = np.flatnonzero(np.diff(np.sign(swinging)) > 0)
    period = np.diff(crossings).mean() * 5e-4
    assert 2 * np.pi / period == pytest.approx(ClosedClutch(DATA, 3, 0.01).frequency, rel=0.03)


def test_brake_is_made_up_for():
    law, x = ClosedClutch(DATA, 2, 0.01), np.array(list(DATA.rolling(2, 500.0, 60.0).values()))
    braked = x.copy()
    braked[1] = 5.0
    assert law.rate(x, 500.0) == pytest.approx(0.0, abs=1e-6)
    assert law.rate(braked, 500.0) > 100


def test_wrong_damping():
    with pytest.raises(ArgumentError, match="damping is -1"):
        ClosedClutch(DATA, 2, 0.01, -1)
