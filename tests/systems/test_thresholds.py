"""The gap of a threshold: where it is, and that a controller has plans from states in it."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.systems.thresholds import Threshold, out_of_gaps, state_thresholds

MODEL = """SYSTEM s { INTERFACE { STATE { REAL v [-4, 4]; REAL w [-4, 4]; BOOL b; } INPUT { REAL u [-1, 1]; } }
  IMPLEMENTATION { AUX { BOOL high, low, both; REAL z; }
    AD { high = v >= 1; low = 2*w <= 1; both = v + w <= 0; }
    DA { z = {IF high & low THEN 0.1 ELSE 0}; }
    AUTOMATA { b = both; }
    CONTINUOUS { v = 0.5*v + z + u; w = w; } } }"""


@pytest.fixture(scope="module")
def model():
    return hys.load(MODEL)


def test_thresholds_of_single_states_have_a_gap_on_their_false_side(model):
    high, low = state_thresholds(model.dha)
    assert (high.column, high.true_end, low.column, low.true_end) == (0, 1.0, 1, 0.5)
    assert high.false_end < 1.0 < high.false_end + 1e-5
    assert 0.5 < low.false_end < 0.5 + 1e-5


@pytest.mark.parametrize("share", [0.001, 0.5, 0.999])
def test_a_state_in_a_gap_moves_to_the_side_that_the_model_sees(model, share):
    high, low = state_thresholds(model.dha)
    inside = np.array([1.0 + share * (high.false_end - 1.0), 0.5 + share * (low.false_end - 0.5), 0.0])
    moved = out_of_gaps(inside, (high, low), 1e-6)
    assert moved.tolist() == [high.false_end, low.false_end, 0.0]
    for x in (inside, moved):
        assert model.dha.step(x, [0.0])[2][:2].tolist() == [0.0, 0.0]


def test_other_states_stay_as_they_are(model):
    thresholds = state_thresholds(model.dha)
    for value in (1.0, thresholds[0].false_end, 0.9, 3.0):
        x = np.array([value, 0.0, 1.0])
        assert out_of_gaps(x, thresholds, 1e-6) is x
    inside = np.array([1.0 - 5e-7, 0.0, 1.0])
    assert out_of_gaps(inside, thresholds, 1e-9) is inside


def test_moves_out_of_two_gaps_are_no_farther_than_out_of_one():
    first, second = Threshold(0, 1.0, 1.000001), Threshold(0, 1.0000006, 1.0000016)
    assert out_of_gaps(np.array([1.0000005]), (first, second), 1e-6).tolist() == [1.000001]


def test_a_controller_has_a_plan_from_a_state_in_a_gap():
    model = hys.load("two_tanks")
    mpc = hys.HybridMpc(model, 3, hys.Cost(y={"level2": 1}), references=("level2",))
    for level in (0.3 - 1e-9, 0.3 - 5e-7, 0.3 - 1e-6 + 1e-12):
        assert mpc.solve([level, 0.2], {"level2": 0.3}).ok
