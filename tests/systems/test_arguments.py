"""States and inputs that are no states and inputs: the message names which one and what was expected."""

import math

import numpy as np
import pytest

import hysdel_py as hys

MODEL = """SYSTEM s {
  INTERFACE { STATE { REAL level [0, 10]; BOOL open; } INPUT { REAL flow [-1, 1]; BOOL go; } OUTPUT { REAL y; } }
  IMPLEMENTATION { CONTINUOUS { level = level + flow; } AUTOMATA { open = go; } OUTPUT { y = level; } }
}"""
X, U = [1.0, 0.0], [0.5, 1.0]


@pytest.fixture(params=["dha", "mld"])
def system(request):
    return getattr(hys.load(MODEL), request.param)


WRONG = [
    ([math.nan, 0], U, r"state level is nan: a finite number was expected"),
    ([math.inf, 0], U, r"state level is inf: a finite number was expected"),
    ([1, 0.5], U, r"state open is 0\.5: it is Boolean, 0 or 1 was expected"),
    ([1, 2], U, r"state open is 2: it is Boolean"),
    ([1, math.nan], U, r"state open is nan"),
    ([1], U, r"state has shape \(1,\): 2 entries were expected, in the order level, open"),
    ([1, 0, 0], U, r"state has shape \(3,\)"),
    ([[1, 0]], U, r"state has shape \(1, 2\)"),
    (1.0, U, r"state has shape \(\)"),
    ("full", U, r"the state must be 2 numbers"),
    (["a", 0], U, r"the state must be 2 numbers"),
    (None, U, r"state"),
    ([1j, 0], U, r"the state must be 2 numbers"),
    ({"level": 1}, U, r"no value for the state open: the states are level, open"),
    ({"level": 1, "open": 0, "lid": 1}, U, r"no state named lid: the states are level, open"),
    (X, [math.nan, 0], r"input flow is nan"),
    (X, [0, -1], r"input go is -1: it is Boolean"),
    (X, [], r"input has shape \(0,\): 2 entries were expected, in the order flow, go"),
    (X, {"flow": 0, "stop": 1}, r"no input named stop"),
]


@pytest.mark.parametrize(("x", "u", "message"), WRONG)
def test_step(system, x, u, message):
    with pytest.raises(hys.ArgumentError, match=message):
        system.step(x, u)


@pytest.mark.parametrize(("x", "message"), [(x, message) for x, u, message in WRONG if u is U])
def test_start_of_a_simulation(system, x, message):
    with pytest.raises(hys.ArgumentError, match=message):
        system.simulate(x, [U, U])


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ([[0, 1, 2]], r"inputs has shape \(1, 3\): one row per step and 2 columns \(flow, go\) were expected"),
        ([0, 1], r"inputs has shape \(2,\)"),
        (3, r"inputs has shape \(\)"),
        ([[0, 1], [0]], r"inputs must be an array of 2 columns"),
        ([[0, 1], [math.nan, 1]], r"step 1: input flow is nan"),
        ([[0, 1], [0, 0.3]], r"step 1: input go is 0\.3"),
        (None, r"inputs"),
    ],
)
def test_inputs_of_a_simulation(system, inputs, message):
    with pytest.raises(hys.ArgumentError, match=message):
        system.simulate(X, inputs)


@pytest.mark.parametrize("ts", [0, -1, math.nan, math.inf])
def test_sample_time(system, ts):
    with pytest.raises(hys.ArgumentError, match="ts is"):
        system.simulate(X, [U], ts=ts)


def test_number_of_steps_is_for_models_without_inputs():
    model = hys.load("SYSTEM s { INTERFACE { STATE { REAL x; } } IMPLEMENTATION { CONTINUOUS { x = 2*x; } } }")
    assert model.simulate(1.0, 3).x[:, 0].tolist() == [1, 2, 4, 8]
    assert model.simulate([1.0], 0).steps == 0
    with pytest.raises(hys.ArgumentError, match="number of steps is -1"):
        model.simulate([1.0], -1)


def test_names_and_arrays_and_integers_are_the_same(system):
    expected = [v.tolist() for v in system.step(X, U)]
    for x, u in (
        ({"open": 0, "level": 1}, {"go": 1, "flow": 0.5}),
        ((1, False), (0.5, True)),
        (np.array(X), np.array(U)),
    ):
        assert [v.tolist() for v in system.step(x, u)] == expected


def test_arguments_are_not_changed(system):
    x, u = np.array(X), np.array(U)
    system.step(x, u)
    assert x.tolist() == X
    assert u.tolist() == U


def test_out_of_range_names_every_fault_and_its_line(system):
    with pytest.raises(hys.SimulationError) as caught:
        system.step([11, 0], [-2, 0])
    assert len(caught.value.problems) == 2
    assert "state level = 11 is outside its range [0, 10] (declared in line 2)" in caught.value.problems[0]
    assert system.step([11, 0], [-2, 0], check=False)[0].tolist() == [9, 0]


def test_ends_of_a_range_belong_to_it(system):
    assert system.step([0, 0], [-1, 0])[0][0] == -1
    assert system.step([10, 0], [1, 0])[0][0] == 11


def test_failing_step_of_a_simulation_is_numbered(system):
    with pytest.raises(hys.SimulationError, match=r"^step 3: state level"):
        system.simulate([8, 0], [[1, 0]] * 9)
