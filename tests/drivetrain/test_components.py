"""Assembly: equations of motion against hand-derived ones, and the messages of wrong ones."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.errors import ArgumentError

J, G = hys.Inertia, hys.Gear


def test_a_gear_carries_inertia_torque_and_contact_across():
    q = hys.Drivetrain(
        J("in", 1.0), J("out", 3.0), G("gear", "in", "out", 2.0), hys.TorqueSource("T", "in", 5.0),
        hys.Brake("brake", "out", 7.0),
    ).equations  # fmt: skip
    assert q.names.coordinates == ("in",)
    np.testing.assert_allclose(q.M, [[1.0 + 3.0 / 4]])
    np.testing.assert_allclose(q.W, [[0.5]])
    np.testing.assert_allclose(q.T, [[1.0], [0.5]])


def test_planetary_gear():
    """Sun + z ring = (1 + z) carrier; the torques of the three shafts share the same ratio."""
    z = 2.1155
    q = hys.Drivetrain(J("s", 0.1), J("c", 0.2), J("r", 0.3), hys.PlanetaryGear("pg", "s", "c", "r", z)).equations
    assert q.names.coordinates == ("s", "c")
    ring = np.array([-1 / z, (1 + z) / z])
    np.testing.assert_allclose(q.T[2], ring)
    np.testing.assert_allclose(q.M, np.diag([0.1, 0.2]) + 0.3 * np.outer(ring, ring))


def test_massless_shafts_disappear():
    q = hys.Drivetrain(
        J("a", 1.0), G("g1", "a", "middle", 2.0), G("g2", "middle", "b", 3.0), J("b", 36.0)
    ).equations  # fmt: skip
    np.testing.assert_allclose(q.M, [[2.0]])


def test_spring_damper_and_load():
    q = hys.Drivetrain(
        J("a", 1.0), J("b", 2.0), hys.SpringDamper("s", "a", "b", 10.0, 0.5), hys.Load("l", "b", 0.3)
    ).equations
    np.testing.assert_allclose(q.B, [[1.0], [-1.0]])
    np.testing.assert_allclose(q.D, [[0.5, -0.5], [-0.5, 0.8]])


def test_a_prescribed_speed_drives_through_a_gear():
    """The sun is given; the ring follows it, and its inertia is felt through the acceleration of the sun."""
    line = hys.Drivetrain(
        hys.SpeedSource("sun", [(0, 0), (2, 4)]), J("ring", 1.0), J("carrier", 1.0),
        hys.PlanetaryGear("pg", "sun", "carrier", "ring", 2.0),
    )  # fmt: skip
    run = line.simulate({"ring": 0.0}, 1.0, hys.EventDriven())
    # carrier = (sun + 2 ring)/3, M = 1 + 4/9, force = -(2/9) * sun' -> ring' = -(2/9) * 2 / (13/9)
    assert run["ring"][-1] == pytest.approx(-4 / 13, abs=1e-9)
    assert run["carrier"][-1] == pytest.approx((2 - 8 / 13) / 3, abs=1e-9)
    assert run["sun"][-1] == pytest.approx(2.0)


def test_engine_map_is_bilinear_and_held_outside():
    engine = hys.EngineMap("map", "e", [100, 200], [0, 1], [[0, 0], [100, 50]], throttle=0.5)
    for speed, torque in ((100, 50.0), (150, 37.5), (250, 25.0), (50, 50.0)):
        run = hys.Drivetrain(J("e", 1e6), engine).simulate({"e": speed}, 1e-3, hys.EventDriven())
        assert (run["e"][-1] - speed) * 1e9 == pytest.approx(torque, rel=1e-3)


def test_vehicle_coasts_down_as_the_formula_says():
    """m v' = -c v^2 - m g f: v = sqrt(k) tan(atan(v0/sqrt(k)) - sqrt(k) c/m t) with k = m g f / c."""
    m, c, f, v0 = 1000.0, 0.4, 0.01, 30.0
    line = hys.Drivetrain(hys.VehicleLoad("car", m, 0.3, drag=c, rolling=f))
    root = np.sqrt(m * 9.81 * f / c)
    stop = np.arctan(v0 / root) * m / (c * root)
    for scheme, tolerance in (
        (hys.EventDriven(max_step=1.0), 1e-6),
        (hys.Moreau(dt=1e-2), 1e-3),
        (hys.WaitState(dt=1e-2), 1e-3),
    ):
        run = line.simulate({"car": v0 / 0.3}, 0.5 * stop, scheme)
        expected = root * np.tan(np.arctan(v0 / root) - root * c / m * 0.5 * stop)
        assert 0.3 * run["car"][-1] == pytest.approx(expected, abs=tolerance)
    run = line.simulate({"car": v0 / 0.3}, 1.1 * stop, hys.EventDriven(max_step=1.0))
    assert run.events[-1].time == pytest.approx(stop, abs=1e-6)
    assert abs(run["car"][-1]) < 1e-15  # the speed at the located event, projected: rounding of rounding


def test_one_way_clutch_drives_and_lets_run_ahead():
    line = hys.Drivetrain(
        J("a", 1.0), J("b", 1.0), hys.OneWayClutch("free", "a", "b", 100.0),
        hys.TorqueSource("T", "a", [(0, 10), (1, 10), (1, -10), (2, -10)]),
    )  # fmt: skip
    for scheme in (hys.EventDriven(), hys.Moreau(), hys.WaitState(), hys.AugmentedLagrangian(), hys.Exact()):
        run = line.simulate({"a": 0, "b": 0}, 2.0, scheme)
        assert run["a"][-1] == pytest.approx(-5.0, abs=2e-2)
        assert run["b"][-1] == pytest.approx(5.0, abs=2e-2)


def test_matrices_give_the_same_run_as_components():
    whole = hys.Drivetrain(J("a", 0.2), J("b", 0.8), hys.Clutch("c", "a", "b", 50, 0.5), hys.TorqueSource("T", "a", 30))
    plain = hys.Drivetrain.from_matrices(
        np.diag([0.2, 0.8]), [[1.0], [-1.0]], [50], force=[30, 0], friction=[0.5], coordinates=["a", "b"]
    )
    start = {"a": 100, "b": 0}
    np.testing.assert_array_equal(whole.simulate(start, 1).speeds, plain.simulate(start, 1).speeds)


@pytest.mark.parametrize(
    ("components", "words"),
    [
        ([], "needs an Inertia"),
        ([J("a", 1), J("a", 2)], "used twice"),
        ([J("a", 1), hys.Brake("b", "aa", 1)], "no shaft aa: did you mean a"),
        ([J("engine", 1), hys.Clutch("c", "engine", "engin", 1)], "did you mean engine"),
        ([J("a", 1), hys.Clutch("c", "a", "a", 1)], "with itself"),
        ([J("a", 1), G("g", "a", "b", 2)], "shaft b has no inertia and leads nowhere"),
        ([J("a", 1), J("b", 1), G("g", "a", "b", 2), G("h", "a", "b", 3)], "hold them still"),
        ([J("a", 1), J("b", 1), G("g", "a", "b", 2), G("h", "a", "b", 2)], "repeats what other gears"),
        ([J("a", 1), J("b", 1), G("g", "a", "b", 1), hys.Clutch("c", "a", "b", 1)], "c has no slip"),
        ([J("a", 1), G("g", "b", "c", 2), hys.Brake("x", "b", 1), hys.Brake("y", "c", 1)], "move without inertia"),
        ([J("ground", 1)], "not ground"),
        (["engine"], "no component"),
        ([[J("a", 1)]], r"write Drivetrain\(\*components\)"),
        ([J("t", 1)], "t would name two signals"),
        ([hys.VehicleLoad("v", 1, 1, rolling=0.1), hys.Brake("v_rolling", "v", 1)], r"v_rolling\.slip would name two"),
        ([J("a", 1), J("b", 1), hys.Clutch("c", None, "b", 1)], "None is no shaft"),
        ([hys.SpeedSource("s", 1.0), J("a", 1), G("g", "s", "a", 2)], "can move"),
    ],
)
def test_wrong_drivetrains(components, words):
    with pytest.raises(ArgumentError, match=words):
        hys.Drivetrain(*components)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: J("a", 0), "inertia is 0, above 0"),
        (lambda: J("a", float("nan")), "inertia is nan"),
        (lambda: hys.SpringDamper("s", "a", "b", -1), "stiffness is -1"),
        (lambda: G("g", "a", "b", 0), "ratio is 0"),
        (lambda: hys.Clutch("c", "a", "b", force="x"), "is no signal"),
        (lambda: hys.Clutch("c", "a", "b", force=[(1, 0), (0, 1)]), "fall from 1 to 0"),
        (lambda: hys.Clutch("c", "a", "b", 1, friction=-1), "-1"),
        (lambda: hys.Clutch("c", "a", "b", 1, radius=0), "radius is 0"),
        (lambda: hys.Coulomb(0.3, 0.4), "exceeds the static"),
        (lambda: hys.Stribeck(0.4, 0.3, 0), "speed of a Stribeck law"),
        (lambda: hys.SpeedSource("s", [(0, 0), (1, 0), (1, 1)]), "without jumps"),
        (lambda: hys.EngineMap("m", "e", [1, 2], [0, 1], [[1, 2]], 0), "torques have shape"),
        (lambda: hys.EngineMap("m", "e", [2, 1], [0, 1], [[1, 2], [3, 4]], 0), "ascend strictly"),
        (lambda: hys.VehicleLoad("v", 1, 1, slope=2), "slope is 2"),
        (lambda: hys.OneWayClutch("o", "a", "b", 0), "capacity is 0"),
        (lambda: hys.PiecewiseLinear([0, 0, 0], [1, 2, 3]), "more than twice"),
        (lambda: hys.Moreau(dt=0), "dt is 0"),
        (lambda: hys.Moreau(theta=0.2), "theta is 0.2"),
        (lambda: hys.Moreau(solver="magic"), "solver is 'magic'"),
        (lambda: hys.SwitchModel(tau=0), "tau is 0"),
        (lambda: hys.EventDriven(integrator="lsoda"), "integrator is 'lsoda'"),
        (lambda: hys.Drivetrain.from_matrices([[1, 2], [2, 1]], [[1], [0]], [1]), "without inertia"),
        (lambda: hys.Drivetrain.from_matrices([[1, 2], [3, 9]], [[1], [0]], [1]), "not symmetric"),
        (lambda: hys.Drivetrain.from_matrices([[1]], [[1]], [1, 2]), "capacity has 2"),
        (lambda: hys.Drivetrain.from_matrices([[1]], [[1]], 5.0), "capacity is 5.0: a sequence of 1"),
        (lambda: hys.Drivetrain.from_matrices([[1]], [[0]], [1]), "contact1 has no slip"),
        (lambda: hys.Drivetrain.from_matrices(1.0, [[1]], [1]), "M has shape"),
        (lambda: hys.Drivetrain.from_matrices([["x"]], [[1]], [1]), "M is .*numbers were expected"),
        (lambda: hys.Drivetrain.from_matrices([[1]], [[1]], [1], B=[[1]], k=["x"]), "k is"),
        (lambda: hys.Drivetrain.from_matrices([[1]], [[1]], [1], friction=[1, 2]), "friction has 2 entries"),
        (lambda: J("a", True), "inertia is True"),
        (lambda: hys.Coulomb("x"), "coefficient is 'x'"),
        (lambda: hys.Stribeck(0.4, 0.3, "x"), "speed of a Stribeck law is 'x'"),
        (lambda: hys.VehicleLoad("v", 1, 1, slope="5 %"), "slope is '5 %'"),
        (lambda: hys.Clutch("c", "a", "b", 1, surfaces=2.5), "surfaces is 2.5, a whole number"),
        (lambda: hys.Moreau(theta="x"), "theta is 'x'"),
        (lambda: hys.Moreau(dt=None), "dt is None"),
        (lambda: hys.SwitchModel(tau="x"), "tau is 'x'"),
        (lambda: hys.VariableStepMoreau(min_step=1.0), "min_step 1 exceeds max_step"),
    ],
)
def test_wrong_arguments(make, words):
    with pytest.raises(ArgumentError, match=words):
        make()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (({"a": 1}, 1.0), "no speed for b"),
        (({"a": 1, "b": 1, "x": 1}, 1.0), "start names x"),
        (({"a": 1, "b": float("inf")}, 1.0), "start of b"),
        (({"a": 1, "b": 1, "g": 7}, 1.0), "its gears make it 2"),
        (([1.0], 1.0), "shape"),
        (({"a": 1, "b": 1}, -1.0), "until is -1"),
        (({"a": 1, "b": 1}, 1.0, "moreau"), "scheme is 'moreau'"),
        (({"a": 1, "b": 1}, 1e9), "steps"),
        (({"a": 1, "b": 1}, "1"), "until is '1'"),
        (({"a": "x", "b": 1}, 1.0), "start of a is 'x'"),
        (({"a": 10**400, "b": 1}, 1.0), "start of a"),
        (([[1], [1, 2]], 1.0), "a mapping of names"),
        (({"a": 1, "b": 1}, 1.0, hys.Moreau), "as in scheme="),
    ],
)
def test_wrong_runs(arguments, words):
    line = hys.Drivetrain(J("a", 1), J("b", 1), J("g", 1), G("gear", "g", "a", 2.0), hys.Clutch("c", "a", "b", 1))
    with pytest.raises(ArgumentError, match=words):
        line.simulate(*arguments)


def test_samples_have_to_divide_the_time():
    line = hys.Drivetrain(J("a", 1))
    assert len(line.simulate({"a": 1}, 1.0, hys.Moreau(dt=0.03), sample=0.1).t) == 11
    with pytest.raises(ArgumentError, match="does not divide"):
        line.simulate({"a": 1}, 1.0, sample=0.3)
    with pytest.raises(ArgumentError, match="1e\\+09 samples"):
        line.simulate({"a": 1}, 1.0, sample=1e-9)


def test_the_first_step_of_a_variable_method_does_not_limit_its_run():
    line = hys.Drivetrain(J("a", 1))
    assert line.simulate({"a": 1}, 1e5, hys.EventDriven(max_step=1e4))["a"][-1] == pytest.approx(1.0)


def test_numbers_of_numpy_are_numbers():
    line = hys.Drivetrain(J("a", np.int64(1)), hys.Brake("b", "a", 1, np.float32(0.5)))
    assert line.simulate({"a": np.int64(1)}, 1.0)["a"][-1] == pytest.approx(0.5)


def test_inertias_of_all_sizes_go_together():
    line = hys.Drivetrain(J("a", 1e-9), J("b", 1e8), hys.Clutch("c", "a", "b", 1e-8))
    assert line.simulate({"a": 1, "b": 0}, 0.05)["a"][-1] == pytest.approx(0.5)
    assert line.simulate({"a": 1, "b": 0}, 1.0)["a"][-1] == pytest.approx(0.0, abs=1e-9)


def test_exact_refuses_what_is_not_linear():
    with pytest.raises(ArgumentError, match="linear equations"):
        hys.Drivetrain(J("a", 1), hys.Load("l", "a", quadratic=1)).simulate({"a": 1}, 1, hys.Exact())
    with pytest.raises(ArgumentError, match="function of time"):
        hys.Drivetrain(J("a", 1), hys.TorqueSource("T", "a", abs)).simulate({"a": 1}, 1, hys.Exact())


def test_the_trajectory_as_tables():
    line = hys.Drivetrain(J("a", 1), hys.Brake("b", "a", 1))
    run = line.simulate({"a": 0.25}, 0.5, hys.Moreau(dt=0.1))
    assert run.modes == ("+", "+", "+", "s", "s", "s")
    assert [str(event) for event in run.events] == ["0.300000000 s: b positive -> stick"]
    assert run.to_csv().splitlines()[0].startswith("t,a,b.slip,b.torque,b.mode")
    assert run.to_dict()["events"][0]["after"] == "STICK"
    assert run.to_pandas().shape == (6, 7) if _has_pandas() else True
    with pytest.raises(ArgumentError, match=r"no signal c: it has t, a, b\.slip"):
        run["c"]


def _has_pandas():
    try:
        import pandas  # noqa: F401
    except ImportError:
        return False
    return True
