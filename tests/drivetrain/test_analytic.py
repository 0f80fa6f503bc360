"""Every scheme on the cases with known answers; tolerances are relative to the size of the speeds."""

import sys
from math import pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

import hysdel_py as hys

sys.path.insert(0, str(Path(__file__).parent))
from analytic_cases import CASES

DT = 1e-3
EXACTLY, SECOND, FIRST = 1e-9, 3e-4, 3e-3

# Scheme, tolerance of the end values, tolerance of event times, kinds of cases it is not meant for.
SCHEMES = {
    "exact": (hys.Exact(look=2e-2), EXACTLY, 1e-8, {"function"}),
    "event-driven": (hys.EventDriven(), 1e-8, 1e-8, set()),
    "event-driven, Pfeiffer-Glocker and Lemke": (
        hys.EventDriven(decomposition="pfeiffer-glocker", solver="lemke"), 1e-8, 1e-8, set(),
    ),
    "Moreau theta=1/2": (hys.Moreau(dt=DT), SECOND, 2 * DT, set()),
    "Moreau": (hys.Moreau(dt=DT, theta=None), FIRST, 2 * DT, set()),
    "augmented Lagrangian": (hys.AugmentedLagrangian(dt=DT), SECOND, 2 * DT, set()),
    "wait state": (hys.WaitState(dt=DT), FIRST, 5 * DT, set()),
    "variable steps": (hys.VariableStepMoreau(tolerance=1e-6, max_step=5e-3), FIRST, 1e-2, {"static"}),
    "Switch Model": (hys.SwitchModel(dt=DT), SECOND, 0.1, {"static"}),
    "Karnopp": (hys.Karnopp(dt=1e-4), 1e-2, 0.1, {"static"}),
    "fixed-step LCP": (hys.FixedStepLcp(dt=1e-4, solver="active-set"), 1e-2, 0.1, {"static"}),
    "smoothing": (hys.Smoothing(steepness=1e5), 2e-2, None, {"static"}),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_answer_is_the_known_one(name, scheme):
    case = CASES[name]()
    options, tolerance, event_tolerance, not_meant = SCHEMES[scheme]
    if case.tags & not_meant or (scheme == "exact" and not case.linear):
        pytest.skip("the scheme does not claim to solve this case")
    if "static" in case.tags and scheme.split()[0] in ("Moreau", "augmented", "wait"):
        tolerance, event_tolerance = FIRST, 20 * DT  # one step late at each break-away
    run = case.line.simulate(case.start, case.until, options)
    assert run.messages == ()
    for signal, value in case.ends.items():
        known = 1e-7 if name.startswith("V16") else 0.0  # digits of the published values
        assert run[signal][-1] == pytest.approx(value, abs=tolerance * case.scale + known)
    if event_tolerance is not None:
        times = np.array([event.time for event in run.events])
        assert all(np.min(np.abs(times - t)) <= event_tolerance for t in case.events)


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case().heat is not None])
def test_heat(name):
    case = CASES[name]()
    run = case.line.simulate(case.start, case.until, hys.EventDriven())
    assert -run.works[-1, 2] == pytest.approx(case.heat, rel=1e-10)


def test_the_located_events_are_the_only_ones():
    for name in ("V6 stick-slip", "V9 simultaneous", "V10 brake"):
        case = CASES[name]()
        run = case.line.simulate(case.start, case.until, hys.EventDriven())
        np.testing.assert_allclose([event.time for event in run.events], case.events, atol=1e-8)


def rough_plane(friction):
    line = hys.Drivetrain(hys.Inertia("m", 1), hys.Brake("plane", "m", friction), hys.TorqueSource("force", "m", sin))
    return line.simulate({"m": 0}, 8 * pi, hys.EventDriven(rtol=1e-7, max_step=0.2, solver="active-set"))


def test_v11_sliding_without_a_stop_ends_at_a_known_friction():
    limit = 1 / sqrt(1 + pi**2 / 4)
    for friction, sticks in ((limit - 7e-3, False), (limit + 3e-3, True)):
        late = [e for e in rough_plane(friction).events if e.time > 4 * pi]
        assert any(e.after is hys.ContactMode.STICK for e in late) == sticks


def test_v14_and_v15_one_step_of_a_chain():
    line = hys.Drivetrain(
        *(hys.Inertia(name, 1) for name in "abc"), hys.Clutch("ab", "a", "b", 6), hys.Clutch("bc", "b", "c", 2)
    )
    start = {"a": 10, "b": 0, "c": 0}
    step = line.simulate(start, 0.1, hys.Moreau(dt=0.1))
    np.testing.assert_allclose(step.speeds[-1], [9.4, 0.4, 0.2], atol=1e-13)
    np.testing.assert_allclose(line.simulate(start, 10, hys.Moreau(dt=10)).speeds[-1], 10 / 3, atol=1e-12)


def test_v5_a_steep_slope_is_not_held():
    for slope, holds in ((0.29, True), (0.30, False)):  # atan(0.3) = 0.2915
        vehicle = hys.VehicleLoad("brick", mass=1, radius=1, rolling=0.3, slope=slope)
        run = hys.Drivetrain(vehicle).simulate({"brick": 0}, 1.0, hys.EventDriven())
        assert (run["brick"][-1] == 0.0) == holds
