"""The sampled drivetrain as a model: its steps are those of the simulation, and those of the shipped clutch."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.drivetrain.dual_clutch import dual_clutch
from hysdel_py.errors import ArgumentError


def line(torque=30.0, force=50.0):
    return hys.Drivetrain(
        hys.Inertia("engine", 0.2), hys.Inertia("vehicle", 0.8), hys.Clutch("clutch", "engine", "vehicle", force),
        hys.TorqueSource("Te", "engine", torque), hys.Load("road", "vehicle", damping=0.67),
    )  # fmt: skip


RANGES = {"engine": (0, 300), "vehicle": (0, 300), "Te": (0, 150), "clutch": (0, 180)}


@pytest.mark.parametrize(
    "scheme",
    [hys.Moreau(dt=0.01), hys.Moreau(dt=0.01, theta=None), hys.Karnopp(dt=0.01, band=1.0, integrator="euler")],
    ids=["theta", "explicit", "Karnopp"],
)
def test_the_dha_steps_as_the_simulation(scheme):
    torque, force = [(0, 30), (0.5, 80), (1, 10)], [(0, 0), (0.3, 150), (0.7, 20), (1, 20)]
    plant = line(torque, force)
    run = plant.simulate({"engine": 60, "vehicle": 20}, 1.0, scheme)
    model = hys.load(plant.to_hysdel(RANGES, scheme))
    reads = 0.005 if isinstance(scheme, hys.Moreau) else 0.0
    x = np.array([60.0, 20.0])
    modes = set()
    for k in range(100):
        t = 0.01 * k + reads
        u = [np.interp(t, *np.transpose(torque)), np.interp(t, *np.transpose(force))]
        x, y, d, _ = model.dha.step(x, u)
        modes.add(tuple(d))
        np.testing.assert_allclose(x, run.speeds[k + 1], atol=1e-9)
        row = k + 1 if isinstance(scheme, hys.Moreau) else k
        assert y[1] == pytest.approx(run["clutch.torque"][row], abs=1e-7)
    assert len(modes) >= 2


def test_the_mld_agrees_too():
    plant = line()
    model = hys.load(plant.to_hysdel(RANGES))
    x_dha = x_mld = np.array([120.0, 20.0])
    for _ in range(60):
        x_dha = model.dha.step(x_dha, [30, 90])[0]
        x_mld = model.mld.step(x_mld, [30, 90])[0]
    np.testing.assert_allclose(x_mld, x_dha, atol=1e-6)
    assert x_dha[0] == pytest.approx(x_dha[1])


def test_the_shipped_clutch_has_the_same_steps_where_it_has_the_same_equations():
    """Its Karnopp test looks at one limit of the torque only, and slips by the sign of the slip inside the band."""
    clutch, plant = hys.load("clutch"), line()
    ranges = {"engine": (0, 300), "vehicle": (-100, 300), "Te": (0, 150), "clutch": (0, 180)}
    text = plant.to_hysdel(ranges, hys.Karnopp(dt=0.01, band=1.0, integrator="euler"))
    sampled = hys.load(text)
    random, compared = np.random.default_rng(5), 0
    for _ in range(300):
        we, gamma = random.uniform(90, 190), random.choice([random.uniform(-0.9, 0.99), random.uniform(1.01, 80)])
        te, fn = random.uniform(0, 150), random.uniform(0, 180)
        stick = (te * 0.8 + 0.67 * (we - gamma) * 0.2) / 1.0
        if stick < -fn or (gamma <= 0 and stick > fn):
            continue
        try:
            theirs = clutch.dha.step([we, gamma, te, fn, 0.0], [0, 0])[0]
        except hys.SimulationError:
            continue  # it leaves the ranges of the shipped model
        ours = sampled.dha.step([we, we - gamma], [te, fn])[0]
        np.testing.assert_allclose([ours[0], ours[0] - ours[1]], theirs[:2], atol=1e-9)
        compared += 1
    assert compared > 100


def test_two_clutches_have_nine_modes():
    plant = dual_clutch()
    ranges = {
        "engine": (-100, 400), "F": (-100, 400), "vehicle": (-10, 100), "twist": (-0.3, 0.3), "engine_torque": (0, 100),
        "clutch_F": (0, 150), "clutch_C": (0, 150),
    }  # fmt: skip
    scheme = hys.Moreau(dt=0.01)
    model = hys.load(plant.to_hysdel(ranges, scheme, name="dual"))
    run = plant.simulate({"engine": 150, "F": 150, "vehicle": 18}, 10, scheme)
    x = np.array([150.0, 150, 18, 0])
    for k in range(250, 350):
        x = np.array([run["engine"][k], run["F"][k], run["vehicle"][k], run["twist"][k]])
        u = [s.value(0.01 * k + 0.005) for s in plant.equations.signals]
        after = model.dha.step(x, u)[0]
        expected = [run["engine"][k + 1], run["F"][k + 1], run["vehicle"][k + 1], run["twist"][k + 1]]
        np.testing.assert_allclose(after, expected, atol=1e-8)


@pytest.mark.parametrize(
    ("ranges", "scheme", "words"),
    [
        ({"engine": (0, 1)}, None, "none for vehicle"),
        ({**RANGES, "Tee": (0, 1)}, None, "names Tee"),
        ({**RANGES, "Te": (1, 0)}, None, "range of Te"),
        ({**RANGES, "Te": None}, None, "range of Te is None"),
        ({**RANGES, "Te": ("0", 1)}, None, "range of Te"),
        ({**RANGES, "clutch": (-1, 1)}, None, "a normal force of zero or more"),
        (RANGES, hys.WaitState(), "no piecewise affine step"),
        (RANGES, hys.Karnopp(), "euler"),
    ],
)
def test_wrong_arguments(ranges, scheme, words):
    with pytest.raises(ArgumentError, match=words):
        line().to_hysdel(ranges, scheme)


def test_a_signal_that_changes_needs_a_range():
    with pytest.raises(ArgumentError, match="clutch is not constant"):
        line(force=[(0, 0), (1, 1)]).to_hysdel({k: v for k, v in RANGES.items() if k != "clutch"})


def test_the_slope_under_a_vehicle_is_no_input():
    """A vehicle's speed and its slope have one name; the range is that of the speed."""
    plant = hys.Drivetrain(hys.VehicleLoad("car", 1000, 0.3, slope=0.05), hys.TorqueSource("T", "car", 100))
    model = hys.load(plant.to_hysdel({"car": (-10, 90)}, hys.Moreau(dt=0.01)))
    run = plant.simulate({"car": 20}, 0.01, hys.Moreau(dt=0.01))
    assert model.dha.step([20], [])[0][0] == pytest.approx(run["car"][1])
    assert run["car"][1] == pytest.approx(20 + 0.01 * (100 - 1000 * 9.81 * 0.3 * np.sin(0.05)) / 90)


def test_a_constant_force_below_zero_leaves_the_clutch_open():
    model = hys.load(line(force=-50).to_hysdel({"engine": (0, 300), "vehicle": (0, 300)}))
    assert model.dha.step([120, 20], [])[1].tolist() == [100.0, 0.0]
