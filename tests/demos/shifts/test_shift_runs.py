"""A whole upshift on the plant with stick and slip, judged at each of its fine steps, and its references."""

import numpy as np
import pytest

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.plant import FINE
from hysdel_py.demos.shifts.references import clutch_reference, landing, smooth, wheel_reference
from hysdel_py.demos.shifts.shift import run_shift
from hysdel_py.demos.shifts.transmission import Transmission

DATA = Transmission()


@pytest.fixture(scope="module")
def upshift():
    return run_shift(SHIFTS["upshift-23"])


def test_torque_stays_within_two_percent_while_the_clutch_opens(upshift):
    assert upshift.judgement.relative_release < 0.02
    assert upshift.judgement.clutch_at_change <= 0.011


def test_brake_is_off_where_the_flywheel_reverses(upshift):
    wf, brake = (upshift.fine[:, FINE.index(name)] for name in ("wf", "Fnb"))
    turns = np.flatnonzero(wf[:-1] * wf[1:] <= 0)
    assert turns.size > 0
    assert brake[turns].max() <= 0.011


def test_clutch_of_the_new_gear_locks_from_above(upshift):
    assert upshift.done
    assert upshift.judgement.shift_time < 1.7
    assert -100 < upshift.judgement.lockup_slope <= 0


def test_ranges_curve_brake_rule_and_sign_hold_at_every_step(upshift):
    assert upshift.judgement.broken == ()


def test_hand_over_keeps_the_state(upshift):
    release, engage, _ = upshift.parts
    assert np.array_equal(release.x[-1], engage.x[0])


def test_references_begin_and_end_where_they_should():
    shift = SHIFTS["upshift-23"]
    assert smooth(1.0, 3.0, [-1.0, 0.0, 0.5, 1.0, 2.0]).tolist() == [1.0, 1.0, 2.0, 3.0, 3.0]
    wheel = wheel_reference(shift, DATA, 280.0, 84.0, [0.0, 1.0])
    assert wheel == pytest.approx([DATA.flywheel_speed(280.0 * 1.913 + 2.0, 280.0), -50.0])
    assert np.all(landing(100.0) == 0)
    assert np.all(np.diff(landing(3.0)) < 0)
    force = clutch_reference(SHIFTS["upshift-12"], DATA, 129.0, np.arange(0, 0.5, 0.01))
    assert force[0] == 129.0
    assert force[-1] == 0.0
