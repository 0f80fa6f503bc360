"""Runs are repeated steps; times, shapes and messages."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hysdel_py as hys
from hysdel_py.systems.simulation import assemble_trajectory, simulate

MODEL = """SYSTEM s {
  INTERFACE { STATE { REAL x [-100, 100]; BOOL b; } INPUT { REAL u [-1, 1]; } OUTPUT { REAL y; } }
  IMPLEMENTATION {
    AUX { BOOL high; REAL z; }
    AD { high = x >= 0; }
    DA { z = {IF high THEN -0.5*x ELSE u}; }
    CONTINUOUS { x = 0.9*x + z; }
    AUTOMATA { b = ~b; }
    OUTPUT { y = x + u; }
  }
}"""


@pytest.fixture(scope="module")
def model():
    return hys.load(MODEL)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.floats(-50, 50), st.lists(st.floats(-1, 1), max_size=8))
def test_a_run_is_its_steps_one_after_the_other(start, controls):
    dha = hys.load(MODEL).dha
    run = dha.simulate([start, 0], np.reshape(controls, (-1, 1)))
    assert run.x.shape == (len(controls) + 1, 2)
    for k, u in enumerate(controls):
        x1, y, d, z = dha.step(run.x[k], [u])
        assert run.x[k + 1].tolist() == x1.tolist()
        assert [run.y[k].tolist(), run.d[k].tolist(), run.z[k].tolist()] == [y.tolist(), d.tolist(), z.tolist()]
        assert run.u[k].tolist() == [u]


def test_one_input_may_be_a_plain_list(model):
    assert model.simulate([1, 0], [0.5, 1]).x.tolist() == model.simulate([1, 0], [[0.5], [1]]).x.tolist()


def test_state_by_name(model):
    assert model.simulate({"b": 1, "x": 2}, [0.0]).x[0].tolist() == [2, 1]


@pytest.mark.parametrize("form", ["dha", "mld"])
def test_no_steps_keep_the_shapes(model, form):
    run = getattr(model, form).simulate([1, 0], np.zeros((0, 1)))
    assert [getattr(run, key).shape for key in "xuydz"] == [(1, 2), (0, 1), (0, 1), (0, 1), (0, 1)]
    assert run.t.tolist() == [0]


def test_times(model):
    assert simulate(model.dha, [1, 0], [0.0, 0.0], ts=0.25).t.tolist() == [0, 0.25, 0.5]
    assert model.simulate([1, 0], [0.0]).t.tolist() == [0, 1], "the model has no sample time"


def test_sample_time_of_the_model_and_of_the_call():
    model = hys.load("two_tanks")
    assert model.simulate([0.1, 0.1], [[0, 0]]).t.tolist() == [0, 5]
    assert model.simulate([0.1, 0.1], [[0, 0]], ts=1).t.tolist() == [0, 1]


def test_arguments_and_results_share_no_memory(model):
    start, controls = np.array([1.0, 0.0]), np.array([[0.5], [0.5]])
    run = model.simulate(start, controls)
    start[0], controls[0, 0] = 7, 7
    assert run.x[0, 0] == 1
    assert run.u[0, 0] == 0.5


def test_steps_without_check_leave_ranges():
    model = hys.load("SYSTEM s { INTERFACE { STATE { REAL x [0, 3]; } } IMPLEMENTATION { CONTINUOUS { x = x + 2; } } }")
    with pytest.raises(hys.SimulationError, match=r"^step 2: state x = 5 is outside its range"):
        model.simulate([1], 3)
    assert model.simulate([1], 3, check=False).x[:, 0].tolist() == [1, 3, 5, 7]


def test_every_problem_of_a_step_carries_its_number():
    model = hys.load("""SYSTEM s { INTERFACE { STATE { REAL x [0, 3]; } }
      IMPLEMENTATION { CONTINUOUS { x = x + 2; } MUST { x <= 2; } } }""")
    with pytest.raises(hys.SimulationError) as caught:
        model.simulate([2], 3)
    assert len(caught.value.problems) == 2
    assert all(problem.startswith("step 1: ") for problem in caught.value.problems)


def test_fewer_steps_than_controls(model):
    dha = model.dha
    step = dha.step([1, 0], [0])
    run = assemble_trajectory(dha, np.array([1.0, 0.0]), np.zeros((5, 1)), [step], ts=2)
    assert run.steps == 1
    assert run.t.tolist() == [0, 2]
    assert run.x[1].tolist() == step[0].tolist()
