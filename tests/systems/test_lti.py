"""Linear systems: construction, steps, sampling, and systems from elsewhere."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal
from scipy.integrate import solve_ivp

import hysdel_py as hys
from hysdel_py.systems.signals import Kind, Type, Variable

A = np.array([[-1.0, 2.0], [0.5, -3.0]])
B = np.array([[1.0], [0.5]])
C = np.array([[1.0, -1.0]])
D = np.array([[0.25]])


def text(body, outputs="REAL felt;", more=""):
    return (
        "SYSTEM room { INTERFACE { STATE { REAL T [0, 40]; REAL q [-5, 5]; } INPUT { REAL vent [0, 1]; } "
        f"OUTPUT {{ {outputs} }} }} IMPLEMENTATION {{ {more} {body} }} }}"
    )


ROOM = text(
    "LINEAR { heat = 2*T + vent - 3; loss = heat - 2*q; } CONTINUOUS { T = 0.9*T + loss + 0.5; q = 0.5*q + vent; } "
    "OUTPUT { felt = T + heat; }",
    more="AUX { REAL heat [-100, 100]; REAL loss [-100, 100]; }",
)


def same(own, expected):
    np.testing.assert_allclose(own, expected, rtol=1e-9, atol=1e-12)


# ------------------------------------------------------------------ construction


def test_defaults():
    lti = hys.Lti(A, B)
    assert [v.name for v in lti.x] == ["x1", "x2"] == [v.name for v in lti.y]
    assert [v.name for v in lti.u] == ["u1"]
    assert (lti.nx, lti.nu, lti.ny, lti.sample_time) == (2, 1, 2, 1.0)
    assert lti.is_homogeneous
    assert not hys.Lti(A, B, f=[1.0, 0.0]).is_homogeneous


def test_names_and_units():
    lti = hys.Lti(A, B, C, x=("we [rad/s]", "dw"), u=(Variable("Fn", Type.REAL, Kind.INPUT, 0.0, 180.0),), y=["speed"])
    assert [v.label for v in (*lti.x, *lti.u, *lti.y)] == ["we [rad/s]", "dw", "Fn", "speed"]
    assert lti.u[0].high == 180.0
    assert "we' = -we + 2*dw + Fn" in lti.describe()


def test_arrays_are_read_only_copies():
    source = A.copy()
    lti = hys.Lti(source, B)
    source[0, 0] = 9.0
    assert lti.A[0, 0] == -1.0
    with pytest.raises(ValueError, match="read-only"):
        lti.A[0, 0] = 1.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"A": [[1.0, 2.0]], "B": B}, r"A has shape \(1, 2\)"),
        ({"A": A, "B": [[1.0, 2.0, 3.0]]}, "a matrix of 2 rows"),
        ({"A": A, "B": B, "C": [[1.0]]}, "2 columns were expected"),
        ({"A": A, "B": B, "D": [[1.0]]}, r"D has shape \(1, 1\)"),
        ({"A": A, "B": B, "f": [1.0]}, r"f has shape \(1,\)"),
        ({"A": A * np.nan, "B": B}, "A has an entry that is not a finite number"),
        ({"A": "abc", "B": B}, "A is 'abc'"),
        ({"A": A, "B": B, "ts": 0.0}, "ts is 0.0: a positive number"),
        ({"A": A, "B": B, "ts": True}, "ts is True"),
        ({"A": A, "B": B, "x": ("a",)}, "x has 1 names: 2 were expected"),
        ({"A": A, "B": B, "x": ("a", "a")}, "x names a signal twice"),
        ({"A": A, "B": B, "x": "ab"}, "a sequence of 2 names"),
        ({"A": A, "B": B, "x": ("a", 3)}, "3 is no name"),
        ({"A": A, "B": B, "u": (Variable("on", Type.BOOL, Kind.INPUT),)}, "on is Boolean"),
    ],
)
def test_wrong_arguments(arguments, message):
    with pytest.raises(hys.ArgumentError, match=message):
        hys.Lti(**arguments)


# ------------------------------------------------------------------ steps


def test_step_and_simulation():
    lti = hys.Lti(0.1 * A, B, C, D, ts=0.5, f=[1.0, 0.0], g=[2.0])
    x, u = np.array([1.0, -2.0]), np.array([3.0])
    x1, y, d, z = lti.step(x, u)
    assert x1 == pytest.approx(0.1 * A @ x + B @ u + [1.0, 0.0])
    assert y == pytest.approx(C @ x + D @ u + 2.0)
    assert d.size == z.size == 0
    run = lti.simulate(x, [[3.0], [0.0]])
    assert run.x[1] == pytest.approx(x1)
    assert run.t.tolist() == [0.0, 0.5, 1.0]


def test_ranges_are_checked():
    lti = hys.Lti(A, B, u=(Variable("Fn", Type.REAL, Kind.INPUT, 0.0, 1.0),))
    with pytest.raises(hys.SimulationError, match="Fn = 2 is outside its range"):
        lti.step([0.0, 0.0], [2.0])
    assert lti.step([0.0, 0.0], [2.0], check=False)[0] == pytest.approx([2.0, 1.0])
    with pytest.raises(hys.ArgumentError, match="state x1 is nan"):
        lti.step([np.nan, 0.0], [0.0])


# ------------------------------------------------------------------ sampling


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_sampling_is_that_of_scipy(seed):
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 5), rng.integers(1, 3)
    a, b = rng.normal(size=(n, n)), rng.normal(size=(n, m))
    ts = float(rng.uniform(0.01, 1.0))
    lti = hys.Lti.sampled(a, b, ts=ts)
    expected = signal.cont2discrete((a, b, np.eye(n), np.zeros((n, m))), ts, method="zoh")
    same(lti.A, expected[0])
    same(lti.B, expected[1])


def test_sampling_with_a_constant_term_is_the_solution_of_the_differential_equation():
    f, u, x0 = np.array([0.3, -0.2]), 0.7, np.array([1.0, 2.0])
    lti = hys.Lti.sampled(A, B, ts=0.4, f=f)
    flow = solve_ivp(lambda _, x: A @ x + B[:, 0] * u + f, (0.0, 0.4), x0, rtol=1e-11, atol=1e-12)
    assert lti.step(x0, [u])[0] == pytest.approx(flow.y[:, -1], abs=1e-9)


def test_a_system_that_explodes_within_a_sample_is_refused():
    with pytest.raises(hys.ArgumentError, match="grows without bound within ts = 10000"):
        hys.Lti.sampled([[1.0]], [[1.0]], ts=1e4)


# ------------------------------------------------------------------ other toolboxes


@pytest.mark.parametrize(
    "system",
    [
        signal.StateSpace(A, B, C, D),
        signal.lti(A, B, C, D),
        signal.TransferFunction([1.0, 2.0], [1.0, 3.0, 2.0]),
        signal.ZerosPolesGain([-2.0], [-1.0, -3.0], 2.0),
    ],
)
def test_continuous_systems_of_scipy(system):
    lti = hys.Lti.of(system, ts=0.1)
    form = system.to_ss()
    expected = signal.cont2discrete((form.A, form.B, form.C, form.D), 0.1)
    inputs = np.ones(20)
    _, (response,) = signal.dstep(signal.dlti(*expected[:4], dt=0.1), n=20)
    assert lti.simulate(np.zeros(lti.nx), inputs).y == pytest.approx(response)
    assert lti.ts == 0.1


def test_discrete_systems_of_scipy():
    assert hys.Lti.of(signal.dlti(A, B, C, D, dt=0.2)).ts == 0.2
    assert hys.Lti.of(signal.dlti([1.0], [1.0, -0.5], dt=0.2)).A == 0.5
    assert hys.Lti.of(signal.dlti(A, B, C, D), ts=0.3).ts == 0.3
    with pytest.raises(hys.ArgumentError, match=r"sampled with 0\.2"):
        hys.Lti.of(signal.dlti(A, B, C, D, dt=0.2), ts=0.1)


@dataclass
class StateSpaceLike:
    """The attributes that python-control's StateSpace has."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    dt: float | bool | None = 0
    state_labels: list[str] = field(default_factory=lambda: ["x[0]", "x[1]"])
    input_labels: list[str] = field(default_factory=lambda: ["force"])
    output_labels: list[str] = field(default_factory=lambda: ["y[0]"])


@dataclass
class TransferFunctionLike:
    """The attributes that python-control's TransferFunction has."""

    num: list[list[np.ndarray]]
    den: list[list[np.ndarray]]
    dt: float = 0.5
    ninputs: int = 1
    noutputs: int = 1


def test_objects_like_those_of_python_control():
    lti = hys.Lti.of(StateSpaceLike(A, B, C, D), ts=0.1)
    same(lti.A, signal.cont2discrete((A, B, C, D), 0.1)[0])
    assert [v.name for v in (*lti.x, *lti.u)] == ["x[0]", "x[1]", "force"]
    assert hys.Lti.of(StateSpaceLike(A, B, C, D, dt=0.2)).ts == 0.2
    same(hys.Lti.of(StateSpaceLike(A, B, C, D, dt=True), ts=0.2).A, A)
    with pytest.raises(hys.ArgumentError, match="does not say whether it is continuous"):
        hys.Lti.of(StateSpaceLike(A, B, C, D, dt=None), ts=0.1)
    transfer = TransferFunctionLike([[np.array([1.0])]], [[np.array([1.0, -0.5])]])
    assert hys.Lti.of(transfer).A == 0.5
    wide = TransferFunctionLike(transfer.num, transfer.den, ninputs=2)
    with pytest.raises(hys.ArgumentError, match="several inputs or outputs"):
        hys.Lti.of(wide)


def test_python_control_itself():
    pytest.importorskip("control.statesp")
    import control

    system = control.ss(A, B, C, D, states=["pos", "vel"], inputs=["force"], outputs=["y"])
    discrete = control.c2d(system, 0.1)
    for lti in (hys.Lti.of(system, ts=0.1), hys.Lti.of(discrete)):
        same(lti.A, discrete.A)
        same(lti.B, discrete.B)
        assert [v.name for v in lti.x] == ["pos", "vel"]
    transfer = control.tf([1.0, 2.0], [1.0, 3.0, 2.0])
    lti = hys.Lti.of(transfer, ts=0.1)
    response = control.step_response(control.c2d(control.ss(transfer), 0.1), np.arange(20) * 0.1)
    assert lti.simulate(np.zeros(lti.nx), np.ones(20)).y[:, 0] == pytest.approx(np.squeeze(response.y))


def test_an_improper_transfer_function_is_refused():
    with pytest.raises(hys.ArgumentError, match="no state-space form"):
        hys.Lti.of(signal.TransferFunction([1, 0, 0], [1, 1]), ts=0.1)


def test_a_stack_of_matrices_is_no_matrix():
    with pytest.raises(hys.ArgumentError, match=r"A has shape \(1, 1, 1\): a matrix was expected$"):
        hys.Lti(np.zeros((1, 1, 1)), 1)


def test_a_missing_sample_time_and_strangers():
    with pytest.raises(hys.ArgumentError, match="ts is missing: the system is continuous"):
        hys.Lti.of(signal.StateSpace(A, B, C, D))
    with pytest.raises(hys.ArgumentError, match="system is a str"):
        hys.Lti.of("tank")


# ------------------------------------------------------------------ models without logic


@settings(max_examples=20, deadline=None)
@given(st.floats(0, 40), st.floats(-5, 5), st.floats(0, 1))
def test_a_model_without_logic_steps_alike(T, q, vent):
    model = hys.load(ROOM)
    lti = hys.Lti.of(model)
    own, expected = lti.step([T, q], [vent]), model.dha.step([T, q], [vent])
    assert own[0] == pytest.approx(expected[0])
    assert own[1] == pytest.approx(expected[1])


def test_names_ranges_and_sample_time_of_a_model_stay():
    lti = hys.Lti.of(hys.load(ROOM), ts=None)
    assert (lti.x[0].name, lti.x[0].high, lti.u[0].high, lti.name) == ("T", 40.0, 1.0, "room")
    assert hys.Lti.of(hys.load(ROOM).dha, ts=0.5).ts == 0.5


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("clutch", "stick is Boolean"),
        (
            text(
                "AD { hot = T >= 30; } CONTINUOUS { T = 0.9*T; q = q; } OUTPUT { felt = T; }", more="AUX { BOOL hot; }"
            ),
            "hot = T >= 30",
        ),
        (text("CONTINUOUS { T = 0.9*T; q = q; } OUTPUT { felt = T; } MUST { T + q <= 30; }"), r"T \+ q <= 30"),
    ],
)
def test_a_model_with_logic_is_refused(source, message):
    with pytest.raises(hys.ArgumentError, match=message):
        hys.Lti.of(hys.load(source))
