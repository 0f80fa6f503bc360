"""The Dual-clutch: event tables, energies, errors and orders against the exact solution."""

from dataclasses import replace

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.drivetrain.comparison import FIXED, mean_error
from hysdel_py.drivetrain.dual_clutch import START, UNTIL, dual_clutch
from hysdel_py.errors import ArgumentError

EVENTS = {
    "a": [
        ("F", "slip", 1.947054504), ("F", "stick", 2.035501810), ("F", "slip", 2.071378873),
        ("C", "stick", 2.288302143), ("C", "slip", 2.392129502), ("C", "stick", 3.096740406),
        ("C", "slip", 3.145108748), ("C", "stick", 3.195883181), ("C", "slip", 6.237484119),
        ("C", "stick", 6.307728385), ("C", "slip", 6.349710009), ("F", "stick", 6.923820172),
        ("F", "slip", 8.713455667), ("F", "stick", 9.286306530),
    ],
    "b": [
        ("F", "slip", 2.219910688), ("C", "stick", 2.606844057), ("C", "slip", 2.749775553),
        ("C", "stick", 2.842049951),
    ],
}  # fmt: skip
ENERGY = {
    "a": (26348.605733, 95113.8035, 82811.0527, 6389.7700),
    "b": (33652.239271, 99086.2669, 83700.8876, 2168.7651),
}
# Mean errors at 1e-3 s, cases a and b, and orders of convergence, measured on independent prototypes.
ERRORS = {
    "LCPTS": (7.6e-2, 1.1e-2),
    "Moreau, inputs in the middle": (1.3e-2, 2.5e-3),
    "Moreau theta=1/2": (2.1e-2, 2.7e-3),
    "SIMDRV": (2.8e-3, 1.35e-3),
    "SWITCH": (4.3, 2.7),
    "SWITCH ode3": (1.28, 1.47),
    "LCPEV": (3.2, 1.9),
}


@pytest.fixture(scope="module", params=["a", "b"])
def exact(request):
    plant = dual_clutch(request.param)
    return request.param, plant, plant.simulate(START, UNTIL, hys.Exact(look=4e-3), sample=2e-3)


def changes(run):
    """Changes between sticking and slipping, apart from those of opening and closing clutches."""
    found = []
    for event in run.events:
        if hys.ContactMode.OPEN not in (event.before, event.after):
            word = "stick" if event.after is hys.ContactMode.STICK else "slip"
            found.append((event.contact[-1], word, event.time))
    return found


def test_equations():
    q = dual_clutch().equations
    np.testing.assert_allclose(q.M, np.diag([0.2, 0.0325, 110]))
    np.testing.assert_allclose(q.W, [[1, 1], [-1, -1.5], [0, 0]])
    np.testing.assert_allclose(q.G, [[35.7692307692, 51.1538461538], [51.1538461538, 74.2307692308]])
    assert np.linalg.cond(q.G) == pytest.approx(312.6, abs=0.05)


def test_v12_frequencies_of_the_driveshaft():
    q = dual_clutch().equations
    for stuck, frequency in (((0,), 20.643603314), ((1,), 15.284397668), ((), 52.086533701)):
        W = q.W[:, list(stuck)]
        free = np.linalg.inv(q.M)
        if stuck:
            free = free - free @ W @ np.linalg.inv(W.T @ free @ W) @ W.T @ free
        assert np.sqrt(q.k[0] * (q.B.T @ free @ q.B)[0, 0]) == pytest.approx(frequency, abs=1e-8)


def test_v13_both_stuck_at_rest():
    torque = [("engine_torque", 40)]
    parts = [c for c in dual_clutch().components if c.name not in ("engine_torque", "clutch_F", "clutch_C")]
    line = hys.Drivetrain(
        *parts, hys.TorqueSource(torque[0][0], "engine", 40), hys.Clutch("F_", "engine", "F", 1e3),
        hys.Clutch("C_", "engine", "C", 1e3),
    )  # fmt: skip
    for scheme in (hys.EventDriven(), hys.Exact(), hys.Moreau(dt=1e-9, theta=None), hys.WaitState(dt=1e-6)):
        run = line.simulate({"engine": 0, "F": 0, "vehicle": 0, "twist": 200 / 6000}, 1e-6, scheme)
        np.testing.assert_allclose(run.torques[0], [72, -32], rtol=1e-4)


def test_v18_event_table(exact):
    case, plant, reference = exact
    for run in (reference, plant.simulate(START, UNTIL, hys.EventDriven(rtol=1e-11, atol=1e-11))):
        found = changes(run)
        assert [(c, w) for c, w, _ in found] == [(c, w) for c, w, _ in EVENTS[case]]
        np.testing.assert_allclose([t for *_, t in found], [t for *_, t in EVENTS[case]], atol=2e-9)


def test_v18_sign_changes_of_an_open_clutch_are_no_events(exact):
    _, _, reference = exact
    assert not [
        e for e in reference.events if {e.before, e.after} == {hys.ContactMode.POSITIVE, hys.ContactMode.NEGATIVE}
    ]


def test_v17_energies_of_the_exact_solution(exact):
    case, _, run = exact
    final, source, load, friction = ENERGY[case]
    assert run.energy[-1] == pytest.approx(final, abs=1e-5)
    np.testing.assert_allclose(run.works[-1], [source, -load, -friction], atol=1e-3)
    assert np.abs(run.imbalance).max() < 1e-4


def test_v17_the_midpoint_scheme_keeps_the_balance_exactly(exact):
    _, plant, _ = exact
    run = plant.simulate(START, UNTIL, hys.Moreau(), sample=1e-2)
    assert np.abs(run.imbalance).max() < 1e-7


def test_end_states(exact):
    case, _, run = exact
    ends = {"a": (168.1429, 168.1429, 20.4744), "b": (269.38, None, 21.682)}[case]
    for name, value in zip(("engine", "F", "vehicle"), ends, strict=True):
        if value is not None:
            assert run[name][-1] == pytest.approx(value, abs=5e-3)


@pytest.mark.parametrize("method", ERRORS)
def test_errors_at_a_millisecond(exact, method):
    case, plant, reference = exact
    run = plant.simulate(START, UNTIL, FIXED[method], sample=2e-3)
    assert mean_error(run, reference) == pytest.approx(ERRORS[method]["ab".index(case)], rel=0.05)


@pytest.mark.parametrize(("method", "order"), [("LCPTS", 1.0), ("Moreau theta=1/2", 2.0)])
def test_orders_of_convergence(exact, method, order):
    _, plant, reference = exact
    steps = (2e-3, 1e-3, 5e-4)
    runs = [plant.simulate(START, UNTIL, replace(FIXED[method], dt=dt), sample=2e-3) for dt in steps]
    errors = [mean_error(run, reference) for run in runs]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(order, abs=0.1)


def test_event_driven_is_accurate_to_its_tolerance(exact):
    _, plant, reference = exact
    run = plant.simulate(START, UNTIL, hys.EventDriven(), sample=2e-3)
    assert mean_error(run, reference) < 1e-6


def test_variable_steps_need_fewer_solves_for_less_error():
    plant = dual_clutch("b")
    fine = plant.simulate(START, UNTIL, hys.Exact(look=5e-3), sample=5e-2)
    run = plant.simulate(START, UNTIL, hys.VariableStepMoreau(tolerance=1e-3), sample=5e-2)
    fixed = plant.simulate(START, UNTIL, hys.Moreau(dt=1e-3), sample=5e-2)
    assert run.info["solves"] < 0.6 * fixed.info["steps"]
    assert mean_error(run, fine) < 0.6 * mean_error(fixed, fine)


def test_the_prox_iterations_find_the_answer_of_the_lcp(exact):
    _, plant, _ = exact
    by_lcp = plant.simulate(START, UNTIL, FIXED["LCPTS"], sample=1e-3)
    for name, printed in (("AUGLAGR p=1 tol=1e-4", 1e-3), ("AUGLAGR p=1 tol=1e-8", 1e-7)):
        difference = mean_error(by_lcp, plant.simulate(START, UNTIL, FIXED[name], sample=1e-3))
        assert 0.3 * printed < difference < 1.2 * printed  # the document's table H.1 prints the powers of ten


def test_too_steep_a_regularisation_does_not_converge_and_says_so():
    run = dual_clutch().simulate(START, 0.1, hys.AugmentedLagrangian(steepness=60, iterations=200))
    assert run.info["failures"] > 0
    assert "did not converge" in run.messages[0]


def test_there_are_two_cases():
    with pytest.raises(ArgumentError, match="one of a, b"):
        dual_clutch("c")
