"""All schemes tell the same story on random chains, from any start, also in stick and with clutches without force."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import hysdel_py as hys
from hysdel_py.drivetrain.recording import law_residuals

UNTIL = 0.4

STEPPING = {
    "Moreau": (hys.Moreau(dt=5e-4, theta=None), 1.0),
    "theta": (hys.Moreau(dt=5e-4), 1.0),
    "augmented Lagrangian": (hys.AugmentedLagrangian(dt=5e-4), 1.0),
    "wait state": (hys.WaitState(dt=5e-4), 4.0),
    "Switch Model": (hys.SwitchModel(dt=5e-4), 8.0),
    "variable": (hys.VariableStepMoreau(tolerance=1e-4, max_step=2e-3), 4.0),
}


def chain(inertias, forces, torques, spring):
    parts = [hys.Inertia(f"J{i}", J) for i, J in enumerate(inertias)]
    for i, force in enumerate(forces):
        if spring == i:
            parts.append(hys.SpringDamper("shaft", f"J{i}", f"J{i + 1}", 200.0, 0.1))
        else:
            parts.append(hys.Clutch(f"c{i}", f"J{i}", f"J{i + 1}", force))
    parts += [hys.TorqueSource(f"T{i}", f"J{i}", torque) for i, torque in enumerate(torques)]
    return hys.Drivetrain(*parts, hys.Brake("brake", "J0", 3.0))


@st.composite
def chains(draw):
    n = draw(st.integers(2, 5))
    inertias = draw(st.lists(st.sampled_from([0.1, 0.3, 1.0, 4.0]), min_size=n, max_size=n))
    forces = draw(st.lists(st.sampled_from([0.0, 2.0, 5.0, 20.0]), min_size=n - 1, max_size=n - 1))
    torques = draw(st.lists(st.sampled_from([-8.0, 0.0, 0.0, 4.0, 10.0]), min_size=n, max_size=n))
    speeds = draw(st.lists(st.sampled_from([-3.0, 0.0, 0.0, 1.0, 7.0]), min_size=n, max_size=n))
    return inertias, forces, torques, speeds, draw(st.sampled_from([None, 0, n - 2]))


@given(chains())
@example(([1.0, 2.0, 1.0], [5.0, 5.0], [0.0, 0.0, 0.0], [1.0, 0.0, -1.0], None))
@example(([0.1] * 5, [0.0] * 4, [10.0] * 5, [0.0] * 5, None))
@example(([1.0] * 4, [2.0] * 3, [0.0] * 4, [0.0] * 4, None))
@example(([0.1, 0.1], [0.0], [-8.0, 0.0], [-3.0, 7.0], 0))
@settings(max_examples=8, deadline=None)
def test_schemes_agree(parameters):
    inertias, forces, torques, speeds, spring = parameters
    line = chain(inertias, forces, torques, spring)
    start = {f"J{i}": w for i, w in enumerate(speeds)}
    exact = line.simulate(start, UNTIL, hys.Exact(look=5e-3), sample=0.05)
    events = line.simulate(start, UNTIL, hys.EventDriven(solver="active-set"), sample=0.05)
    np.testing.assert_allclose(events.speeds, exact.speeds, atol=2e-7)
    # A step moves a slip by the greatest relative acceleration; events displace it by a share of that.
    q = line.equations
    reach = 5e-4 * float(np.max(np.abs(np.linalg.inv(q.M)) @ (np.abs(q.W).sum(axis=1) * 20.0 + 10.0)))
    for name, (scheme, share) in STEPPING.items():
        run = line.simulate(start, UNTIL, scheme, sample=0.05)
        assert run.messages == ()
        error = np.abs(run.speeds - exact.speeds).max()
        assert error <= share * reach, name


@given(chains())
@settings(max_examples=15, deadline=None)
def test_every_step_of_time_stepping_obeys_the_law(parameters):
    inertias, forces, torques, speeds, spring = parameters
    line = chain(inertias, forces, torques, spring)
    run = line.simulate({f"J{i}": w for i, w in enumerate(speeds)}, 0.1, hys.Moreau(dt=1e-3))
    assert run.residuals.max() < 1e-10
    assert np.abs(run.imbalance).max() < 1e-9


def test_a_chain_at_rest_stays_at_rest():
    line = chain([1.0, 0.5, 0.2], [5.0, 5.0], [2.0, 0.0, -1.0], None)
    for scheme in (hys.EventDriven(), hys.Exact(), *(scheme for scheme, _ in STEPPING.values())):
        run = line.simulate(dict.fromkeys(("J0", "J1", "J2"), 0.0), 0.2, scheme)
        assert np.abs(run.speeds).max() < 1e-12
        assert set(run.modes) == {"sss"}


def test_zero_normal_force_is_no_contact():
    line = hys.Drivetrain(
        hys.Inertia("a", 1), hys.Inertia("b", 1), hys.Clutch("c", "a", "b", [(0, 0), (1, 0), (2, 10)]),
        hys.TorqueSource("T", "a", 3),
    )  # fmt: skip
    for scheme in (hys.EventDriven(), hys.Exact(), hys.Moreau(), hys.WaitState(), hys.SwitchModel(), hys.Karnopp()):
        run = line.simulate({"a": 0, "b": 0}, 1.0, scheme)
        assert run["a"][-1] == pytest.approx(3.0, abs=1e-9)
        assert run["b"][-1] == 0.0
        assert run.modes[len(run.modes) // 2] == "o"


def test_equal_and_different_coefficients_on_the_same_slide():
    """Stribeck friction with a short decay is Coulomb friction with the dynamic coefficient away from zero."""

    def run(friction):
        line = hys.Drivetrain(hys.Inertia("a", 1), hys.Brake("b", "a", 10, friction))
        return line.simulate({"a": 5}, 1.0, hys.EventDriven())

    coulomb, stribeck = run(hys.Coulomb(0.8, 0.4)), run(hys.Stribeck(0.8, 0.4, 1e-3))
    assert coulomb["a"][100 if len(coulomb.t) > 200 else 10] > 0
    assert stribeck["a"][-1] == pytest.approx(coulomb["a"][-1], abs=2e-3)
    assert coulomb["a"][-1] == pytest.approx(1.0)


def test_residuals_measure_slip_and_missing_torque():
    lower, upper, mobility = -np.ones((1, 1)), np.ones((1, 1)), np.full((1, 1), 0.5)

    def residual(torque, slip):
        return law_residuals(np.array([[torque]]), np.array([[slip]]), lower, upper, mobility)[0]

    assert residual(0.3, 0.0) == 0.0
    assert residual(-1.0, 4.0) == 0.0
    assert residual(0.3, 0.01) == pytest.approx(0.01)
    assert residual(1.0, 4.0) == pytest.approx(1.0)  # twice the limit is missing, times the mobility


@pytest.mark.parametrize("scheme", [hys.EventDriven(), hys.EventDriven(decomposition="boxed"), hys.Exact()])
def test_of_two_parallel_clutches_one_gives_way_after_the_other(scheme):
    """With limits of 10 and 5 on equal inertias they hold a torque of 30 t until t = 1; which slips first is open."""
    line = hys.Drivetrain(
        hys.Inertia("a", 1.0), hys.Inertia("b", 1.0), hys.Clutch("c1", "a", "b", 10), hys.Clutch("c2", "a", "b", 5),
        hys.TorqueSource("T", "a", [(0, 0), (2, 60)]),
    )  # fmt: skip
    run = line.simulate({"a": 0, "b": 0}, 2.0, scheme)
    assert run.t[-1] == 2.0
    (message,) = run.messages
    assert message.startswith("the torques of c1, c2 are not unique")
    assert run["a"][-1] == pytest.approx(7.5 + 45 - 15, abs=1e-6)
    assert run["b"][-1] == pytest.approx(7.5 + 15, abs=1e-6)
    assert all(type(event.time) is float for event in run.events)
