"""Disturbances, the filter and the moving horizon, where the answer is known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

import hysdel_py as hys
from hysdel_py.control.costs import Cost
from hysdel_py.control.disturbance import with_disturbances
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.move import MoveStatus
from hysdel_py.control.moving_horizon import MovingHorizonEstimator
from hysdel_py.control.observer import KalmanObserver, mode_maps
from hysdel_py.errors import ArgumentError

# ------------------------------------------------------------------ disturbances


def test_extended_model_steps_as_the_definition_says(systems):
    mld = systems.heater()
    both = with_disturbances(mld, {"felt": 2.0}, {"fan": 0.5})
    assert [v.name for v in both.x] == ["T", "offset_felt", "offset_fan", "on"]
    x1, y, d, _ = both.step([4.0, 1.5, -0.25, 1.0], [0.5, 1.0])
    plain1, plain_y, plain_d, _ = mld.step([4.0, 1.0], [0.25, 1.0])
    assert x1 == pytest.approx([plain1[0], 1.5, -0.25, plain1[1]])
    assert y == pytest.approx(plain_y + np.array([1.5, 0.0]))
    assert d.tolist() == plain_d.tolist()
    assert len(both.updates) == both.nx


@pytest.mark.parametrize(
    ("outputs", "inputs", "words"),
    [
        ({"hot": 1.0}, None, "no real output named hot"),
        ({"felt": 0.0}, None, "positive"),
        (None, {"switch": 1.0}, "no real input named switch"),
    ],
)
def test_wrong_disturbances(systems, outputs, inputs, words):
    with pytest.raises(ArgumentError, match=words):
        with_disturbances(systems.heater(), outputs, inputs)


def test_an_input_of_the_inequalities_is_refused():
    text = VALVE.replace("AD { open = level >= 5; }", "AD { open = flow >= 0.5; }")
    with pytest.raises(ArgumentError, match="inequalities"):
        with_disturbances(hys.load(text), inputs={"flow": 0.1})


def tracked(step, model, observer, steps=25):
    """The plant has a leak of 0.3 per step that the controller's model does not know."""
    x = np.array([-4.0])
    mpc = HybridMpc(model, 4, Cost(y={"seen": 1}, du={"push": 0.1}))
    u = np.zeros(1)
    for _ in range(steps):
        estimate = x if observer is None else observer.correct(x)
        move = mpc.solve(estimate, {"seen": 0.7}, last_input=u)
        assert move.ok, move.message
        u = move.u
        if observer is not None:
            observer.predict(u)
        x = step(x, u)[0] - 0.3
    return x[0]


def test_offset_free_tracking(systems):
    mld = systems.fold(right=0.5)
    extended = with_disturbances(mld, {"seen": 3.0})
    observer = KalmanObserver(extended, {"x": 1e-4, "offset_seen": 1e-1}, {"seen": 1e-4}, [-4.0, 0.0])

    step = systems.fold_step(right=0.5)
    assert tracked(step, extended, observer) == pytest.approx(0.7, abs=1e-3)
    assert abs(tracked(step, mld, None) - 0.7) > 0.02


# ------------------------------------------------------------------ the filter


@pytest.mark.parametrize(
    ("x", "slope"), [(3.0, -0.5), (-3.0, 0.8), (0.0, -0.5), (10.0, -0.5), (-10.0, 0.8), (-1e-4, 0.8)]
)
def test_maps_of_a_mode(systems, x, slope):
    mld = systems.fold()
    maps = mode_maps(lambda *point: mld.step(*point, check=False), mld, np.array([x]), np.array([0.2]))
    assert pytest.approx(np.array([[slope]]), abs=1e-9) == maps.A
    assert pytest.approx(np.array([[1.0]]), abs=1e-9) == maps.C
    assert maps.x1 == pytest.approx([slope * x + 0.2])


def test_covariance_settles_at_the_solution_of_the_riccati_equation(systems):
    observer = KalmanObserver(systems.fold(), [0.3], [0.7], [-9.0], variance=5.0)
    for _ in range(60):
        observer.correct([-5.0])
        observer.predict([-1.0])
    expected = solve_discrete_are(np.array([[0.8]]), np.eye(1), np.array([[0.3]]), np.array([[0.7]]))
    assert pytest.approx(expected, rel=1e-9) == observer.P


def test_one_correction_by_hand(systems):
    observer = KalmanObserver(systems.fold(), [0.0], {"seen": 1.0}, [2.0], variance={"x": 3.0})
    assert observer.correct({"seen": 4.0}) == pytest.approx([2.0 + 0.75 * 2.0])
    assert pytest.approx(np.array([[0.75]])) == observer.P


def test_the_filter_uses_the_mode_of_its_estimate(systems):
    right, left = (KalmanObserver(systems.fold(), [0.0], [1.0], [x], variance=1.0) for x in (2.0, -2.0))
    right.predict([0.0])
    left.predict([0.0])
    assert pytest.approx(np.array([[0.25]])) == right.P
    assert pytest.approx(np.array([[0.64]])) == left.P


def test_boolean_states_follow_the_model(systems):
    observer = KalmanObserver(systems.heater(), {"T": 0.1}, [0.1], [0.0, 0.0], measured=["felt"])
    observer.correct([1.0], [0.0, 1.0])
    assert observer.predict([0.0, 1.0])[1] == 1.0
    assert observer.P[1].tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"process": {"y": 1}}, "process names y"),
        ({"noise": [0.0]}, "positive"),
        ({"noise": [1.0, 1.0]}, "1 numbers"),
        ({"measured": ["x"]}, "measured names x"),
    ],
)
def test_wrong_filters(systems, change, words):
    given = {"process": [0.1], "noise": [0.1], "x0": [0.0]} | change
    with pytest.raises(ArgumentError, match=words):
        KalmanObserver(systems.fold(), **given)


# ------------------------------------------------------------------ the moving horizon

VALVE = """SYSTEM valve {
INTERFACE {
  STATE { REAL level [0, 10]; BOOL stuck; }
  INPUT { REAL flow [0, 1]; BOOL breaks; }
  OUTPUT { REAL seen; }
}
IMPLEMENTATION {
  AUX { REAL lost; BOOL open; }
  AD { open = level >= 5; }
  DA { lost = {IF open & ~stuck THEN 2 ELSE 0}; }
  AUTOMATA { stuck = stuck | breaks; }
  CONTINUOUS { level = level + flow - lost; }
  OUTPUT { seen = level; }
} }"""


@pytest.fixture(scope="module")
def valve():
    return hys.load(VALVE)


def measured(valve, start, flows, breaks, noise=0.0):
    """Outputs and states of a run."""
    rng, x = np.random.default_rng(3), np.array(start)
    states, outputs = [x], []
    for flow, broken in zip(flows, breaks, strict=True):
        x, y, _, _ = valve.dha.step(x, [flow, broken])
        states.append(x)
        outputs.append(y + noise * rng.normal(size=1))
    return np.array(states), np.array(outputs)


def test_a_fault_is_found_with_its_time(valve):
    """Above 5 the level falls by 2 unless the valve is stuck: one look at the level after the fault tells."""
    flows = [1.0] * 8
    breaks = [0, 0, 0, 0, 1, 0, 0, 0]
    states, outputs = measured(valve, [3.5, 0.0], flows, breaks)
    estimator = MovingHorizonEstimator(
        valve, 6, {"level": 3.0, "stuck": 0}, noise=[1e-4], arrival={"stuck": 1e-2}, unknown={"breaks": 0.1}
    )
    found = [estimator.update(y, [flow]) for y, flow in zip(outputs, flows, strict=True)]
    assert all(estimate.status is MoveStatus.OPTIMAL for estimate in found)
    last = found[-1]
    assert last.x == pytest.approx(states[-1], abs=1e-2)
    assert last.states[:, 0] == pytest.approx(states[-7:, 0], abs=1e-2)
    tells = states[-7:, 0] >= 5.0  # below, a stuck valve makes no difference
    assert last.states[tells, 1].tolist() == states[-7:, 1][tells].tolist()
    assert found[3].x[1] == 0.0


def test_without_the_unknown_input_nothing_explains_the_fault(valve):
    _, outputs = measured(valve, [3.5, 0.0], [1.0] * 6, [0, 0, 1, 0, 0, 0])
    known = MovingHorizonEstimator(valve, 6, [3.5, 0.0], noise=[1e-4], arrival={"stuck": 1e-6})
    open_to_faults = MovingHorizonEstimator(
        valve, 6, [3.5, 0.0], noise=[1e-4], arrival={"stuck": 1e-6}, unknown=("breaks",)
    )
    for y in outputs:
        closed = known.update(y, [1.0, 0.0])
        free = open_to_faults.update(y, [1.0])
    assert closed.cost > 100.0
    assert free.cost < 1e-3


def test_mode_that_nobody_measures(valve):
    """The valve is stuck from the beginning, against the first guess."""
    states, outputs = measured(valve, [6.0, 1.0], [0.5] * 3, [0] * 3, noise=0.01)
    estimator = MovingHorizonEstimator(valve, 3, [6.0, 0.0], noise=[1e-4], arrival={"level": 1.0, "stuck": 1.0})
    for y in outputs:
        estimate = estimator.update(y, [0.5, 0.0])
    assert estimate.x[1] == 1.0
    assert estimate.x[0] == pytest.approx(states[-1, 0], abs=0.05)


def test_least_squares_by_hand(systems):
    """In one mode with process noise: the normal equations of the window."""
    mld = systems.fold()
    estimator = MovingHorizonEstimator(mld, 2, [-4.0], noise=[0.5], arrival=2.0, process=[0.25], gap_rel=1e-9)
    estimator.update([-3.5], [0.1])
    estimate = estimator.update([-3.0], [-0.2])
    rows = np.array([[1, 0, 0], [1, 0, 0], [0, 1, 0], [-0.8, 1, 0], [0, -0.8, 1]])
    right = np.array([-4.0, -3.5, -3.0, 0.1, -0.2])
    root = np.sqrt(1 / np.array([2.0, 0.5, 0.5, 0.25, 0.25]))
    expected, cost, *_ = np.linalg.lstsq(rows * root[:, None], right * root, rcond=None)
    assert estimate.states[:, 0] == pytest.approx(expected, abs=1e-4)
    assert estimate.cost == pytest.approx(cost[0], rel=1e-4)


def test_the_window_slides(systems):
    estimator = MovingHorizonEstimator(systems.fold(), 2, [-4.0], noise=[0.1], arrival=1e6)
    lengths = [len(estimator.update([y], [0.0]).states) for y in (-4.0, -3.2, -2.56, -2.048)]
    assert lengths == [2, 3, 3, 3]
    estimator.reset()
    assert len(estimator.update([1.0], [0.0]).states) == 2


def test_a_past_that_cannot_be(systems):
    """The first state is known, and the input takes the state out of its range."""
    estimator = MovingHorizonEstimator(systems.fold(right=0.9, left=0.9), 3, [9.9], noise=[1.0])
    tight = MovingHorizonEstimator(systems.fold(right=0.9, left=0.9, power=30.0), 3, [9.9], noise=[1.0])
    assert estimator.update([9.9], [1.0]).ok
    none = tight.update([9.9], [25.0])
    assert none.status is MoveStatus.INFEASIBLE
    assert none.x is None
    assert "no past of the model" in none.message


def test_the_guess_moves_with_the_window(systems):
    """A guess that is trusted: were it not moved on, it would contradict the measurements."""
    estimator = MovingHorizonEstimator(systems.fold(), 2, [-4.0], noise=[0.1], arrival=1e-6)
    for y in (-4.0, -3.2, -2.56, -2.048):
        estimate = estimator.update([y], [0.0])
        assert estimate.cost < 1e-3
    assert estimate.x == pytest.approx([-1.6384], abs=1e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"unknown": ["flow", "leak"]}, "unknown names leak"),
        ({"unknown": {"breaks": -1.0}}, "price of breaks"),
        ({"noise": [0.0]}, "noise"),
        ({"horizon": 0}, "horizon"),
        ({"arrival": {"seen": 1.0}}, "arrival names seen"),
    ],
)
def test_wrong_estimators(valve, change, words):
    arguments = {"horizon": 3, "x0": [1.0, 0.0], "noise": [1.0]} | change
    with pytest.raises(ArgumentError, match=words):
        MovingHorizonEstimator(valve, **arguments)
