"""Systems and controllers in scipy.signal and python-control, and back: the same runs."""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.errors import ArgumentError, HysdelError, SimulationError

TANK = """SYSTEM tank {
  INTERFACE {
    STATE { REAL level [-9, 9]; BOOL was; }
    INPUT { REAL flow [-1, 1]; BOOL open; }
    OUTPUT { REAL y; }
    PARAMETER { REAL ts = 0.5; }
  }
  IMPLEMENTATION {
    AUX { REAL z; BOOL high; }
    AD { high = level >= 1; }
    DA { z = {IF open & ~high THEN flow ELSE -0.5}; }
    CONTINUOUS { level = 0.7*level + z; }
    AUTOMATA { was = open; }
    OUTPUT { y = level + flow; }
  }
}"""
LTI = {"A": [[0.9, 0.2], [0.0, 0.7]], "B": [[0.0], [1.0]], "C": [[1.0, 0.5]], "D": [[0.25]]}


@pytest.fixture
def control():
    """The package; the folder tests/control has its name and can be imported in its place."""
    found = find_spec("control")
    if found is None or found.origin is None:
        pytest.skip("python-control is not installed: pip install control")
    return import_module("control")


@pytest.fixture(scope="module")
def tank():
    return hys.load(TANK)


def inputs(count=40):
    rng = np.random.default_rng(5)
    return np.column_stack([rng.uniform(-1, 1, count), rng.integers(2, size=count)])


@pytest.mark.parametrize("form", ["model", "dha", "mld", "pwa"])
def test_every_form_runs_there_as_here(control, tank, form):
    system = tank if form == "model" else getattr(tank, form)
    there = hys.to_iosystem(system, sample_time=0.5)
    assert (there.state_labels, there.input_labels, there.output_labels) == (["level", "was"], ["flow", "open"], ["y"])
    assert there.dt == 0.5
    u, run = inputs(), tank.simulate([0.5, 0], inputs())
    found = control.input_output_response(there, 0.5 * np.arange(40), u.T, [0.5, 0])
    assert pytest.approx(run.x[:-1], abs=1e-12) == found.states.T
    assert found.outputs[0] == pytest.approx(run["y"], abs=1e-12)
    assert len(set(run.modes)) > 2


def test_linear_systems_stay_linear(control):
    lti = hys.Lti(*LTI.values(), ts=0.1, x=("a", "b"), u=("f",), y=("out",))
    there = hys.to_iosystem(lti, name="cart")
    assert isinstance(there, control.StateSpace)
    assert (there.name, there.dt, there.state_labels) == ("cart", 0.1, ["a", "b"])
    back = hys.Lti.of(there)
    assert {key: getattr(back, key).tolist() for key in LTI} == LTI
    assert [v.name for v in (*back.x, *back.u, *back.y)] == ["a", "b", "f", "out"]


def test_constant_terms_are_kept(control):
    lti = hys.Lti(*LTI.values(), ts=0.1, f=[1.0, -1.0], g=[3.0])
    there = hys.to_iosystem(lti)
    u = np.linspace(-1, 1, 9)
    found = control.input_output_response(there, 0.1 * np.arange(9), u, [1.0, 2.0])
    run = lti.simulate([1.0, 2.0], u[:, None])
    assert pytest.approx(run.x[:-1], abs=1e-12) == found.states.T
    assert found.outputs == pytest.approx(run.y[:, 0], abs=1e-12)


def test_a_model_without_outputs_shows_its_states(control):
    model = hys.load(
        "SYSTEM s { INTERFACE { STATE { REAL v(2) [0, 9]; } } IMPLEMENTATION { CONTINUOUS { v = 0.5*v; } } }"
    )
    there = hys.to_iosystem(model)
    assert there.output_labels == there.state_labels == ["v_1", "v_2"]


def law():
    lti = hys.Lti([[0.9]], [[0.5]], x=("v",), u=("force",), ts=0.1)
    mpc = hys.LinearMpc(
        lti, "track", horizon=2, cost=hys.LinearCost(y=[1.0], du=[0.1]), limits=hys.LinearLimits(u=(-1, 1))
    )
    return lti, mpc, hys.explicit(mpc, {"v": (-2, 2), "force(-1)": (-1, 1), "r(v)": (-1, 1)})


@pytest.mark.parametrize("explicit", [False, True], ids=["online", "explicit"])
def test_a_controller_closes_the_loop_there(control, explicit):
    lti, mpc, made = law()
    own = made if explicit else mpc
    there = hys.to_iosystem(own, references=("v",), sample_time=0.1)
    assert there.input_labels == ["v", "r_v"]
    assert (there.output_labels, there.state_labels) == (["force"], ["force_last"])
    states = control.ss(lti.A, lti.B, np.eye(1), np.zeros((1, 1)), 0.1, inputs=["force"], outputs=["v"], name="plant")
    loop = control.interconnect([states, there], inputs=["r_v"], outputs=["v"])
    found = control.input_output_response(loop, 0.1 * np.arange(15), np.full(15, 0.6), [0.0, 0.0])
    run = hys.closed_loop(lti, own, [0.0], 15, [0.6], last_input=[0.0])
    assert np.ravel(found.outputs) == pytest.approx(run.x[:-1, 0], abs=1e-9)


def test_a_controller_without_a_plan_says_so(control):
    there = hys.to_iosystem(law()[2], references=("v",))
    with pytest.raises(SimulationError, match="the controller has no input: no plan found"):
        there.output(0, [0.0], [5.0, 0.0])


def test_a_system_from_there_is_a_plant_here(control):
    there = control.nlsys(
        lambda t, x, u, p: np.array([0.5 * x[0] + np.tanh(u[0])]), lambda t, x, u, p: 2 * x,
        inputs=["u"], outputs=["w"], states=["v"], dt=0.2,
    )  # fmt: skip
    plant = hys.from_iosystem(there)
    run = hys.closed_loop(plant, lambda x, _: [-x[0]], [1.0], 5)
    assert run.names["x"] == ("v",)
    assert run.t[-1] == pytest.approx(1.0)
    x = 1.0
    for k in range(5):
        assert run["v"][k] == pytest.approx(x)
        assert run["w"][k] == pytest.approx(2 * x)
        x = 0.5 * x + np.tanh(-x)
    assert plant.simulate([1.0], [[0.0]] * 2)["v"].tolist() == [1.0, 0.5, 0.25]


@pytest.mark.parametrize(
    ("make", "ts", "words"),
    [
        (lambda c: c.tf([1], [1, 1]), None, "a system of python-control|continuous"),
        (lambda c: c.ss(-1, 1, 1, 0), None, "the system is continuous"),
        (lambda c: c.ss(0.5, 1, 1, 0, 0.1), 0.2, "ts is 0.2, but the system is sampled with 0.1"),
        (lambda c: c.ss(0.5, 1, 1, 0, True), -1.0, r"ts is -1\.0: a positive number"),
        (lambda c: c.ss(0.5, 1, 1, 0, True), "a", "ts is 'a': a positive number"),
        (lambda c: c.ss(0.5, 1, 1, 0, True), float("nan"), "ts is nan: a positive number"),
        (lambda c: 3, None, "system is a int"),
    ],
)
def test_what_is_no_plant(control, make, ts, words):
    with pytest.raises(ArgumentError, match=words):
        hys.from_iosystem(make(control), ts)


@pytest.mark.parametrize(
    ("system", "options", "words"),
    [(3, {}, "system is a int"), (TANK, {"ref": {"y": 1}}, "belong to a controller"),
     (TANK, {"sample_time": -1.0}, "sample_time is -1.0"), (TANK, {"sample_time": "a"}, "sample_time is 'a'"),
     (hys.Lti([[1]], [[1]]), {"sample_time": 0.0}, "sample_time is 0.0")],  # python-control: 0 is continuous
)  # fmt: skip
def test_wrong_arguments(control, system, options, words):
    with pytest.raises(ArgumentError, match=words):
        hys.to_iosystem(hys.load(system) if isinstance(system, str) else system, **options)


@pytest.mark.parametrize("found", [None, ModuleType("control")])
def test_without_python_control_it_is_said(monkeypatch, tank, found):
    monkeypatch.setitem(sys.modules, "control", found)
    with pytest.raises(HysdelError, match="pip install control"):
        hys.to_iosystem(tank)


def test_scipy_and_back():
    from scipy.signal import dlsim

    lti = hys.Lti(*LTI.values(), ts=0.1)
    there = hys.to_scipy(lti)
    u = np.sin(np.arange(30.0))[:, None]
    _, y, x = dlsim(there, u, x0=[1.0, -1.0])
    run = lti.simulate([1.0, -1.0], u)
    assert x == pytest.approx(run.x[:-1], abs=1e-12)
    assert y == pytest.approx(run.y, abs=1e-12)
    assert hys.Lti.of(there).A.tolist() == LTI["A"]


def test_scipy_has_no_constant_terms():
    with pytest.raises(ArgumentError, match="constant terms"):
        hys.to_scipy(hys.Lti(*LTI.values(), ts=0.1, f=[1.0, 0.0]))
