"""Torques that the law leaves open are told by every scheme that can meet them, and by no other run."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.drivetrain.undetermined import undetermined_torques

SCHEMES = (
    hys.Moreau(dt=1e-2),
    hys.Moreau(dt=1e-2, theta=None, solver="lemke"),
    hys.Moreau(dt=1e-2, solver="newton", decomposition="boxed"),
    hys.AugmentedLagrangian(dt=1e-2),
    hys.VariableStepMoreau(dt=1e-2, min_step=1e-3),
    hys.WaitState(dt=1e-2),
    hys.SwitchModel(dt=1e-2),
    hys.Karnopp(dt=1e-2),
    hys.FixedStepLcp(dt=1e-2),
    hys.FixedStepLcp(dt=1e-2, solver="active-set"),
    hys.EventDriven(),
    hys.Exact(look=0.05),
)


def beside(second):
    """Two clutches between a and b, which hold up to 10 and `second`, and a third one that slips."""
    return hys.Drivetrain(
        *(hys.Inertia(name, 1.0) for name in "abc"), hys.Clutch("c1", "a", "b", 10), hys.Clutch("c2", "a", "b", second),
        hys.Clutch("c3", "b", "c", 1), hys.TorqueSource("T", "a", 8),
    )  # fmt: skip


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_clutches_that_carry_together(scheme):
    run = beside(5).simulate({"a": 0, "b": 0, "c": 9}, 0.5, scheme, sample=0.1)
    assert run.undetermined.shape == run.torques.shape
    assert run.undetermined[1:, :2].all()
    assert not run.undetermined[:, 2].any()
    (message,) = run.messages
    assert message.startswith("the torques of c1, c2 are not unique in ")
    np.testing.assert_allclose(run.torques[1:, :2].sum(axis=1), 3.5, atol=0.05)  # (8 - 1) / 2: what they add up to is


@pytest.mark.parametrize("scheme", [*SCHEMES, hys.Smoothing(rtol=1e-4)], ids=str)
def test_one_that_carries_alone_has_its_torque(scheme):
    run = beside(0).simulate({"a": 0, "b": 0, "c": 9}, 0.3, scheme, sample=0.1)
    assert not run.undetermined.any()
    assert run.messages == ()


def judged(W, slips, modes):
    """Of one sample."""
    W, slips, modes = np.array(W, dtype=float), np.array([slips], dtype=float), np.array([modes])
    return undetermined_torques(W, np.ones((1, len(W))), slips, modes)[0].tolist()


BESIDE = [[1, 1], [-1, -1]]
RING = [[1, 0, 1], [-1, 1, 0], [0, -1, -1]]


@pytest.mark.parametrize(
    ("W", "slips", "modes", "expected"),
    [
        (BESIDE, [0, 0], [0, 0], [True, True]),
        (BESIDE, [0, 0], [1, 0], [True, True]),  # the first at its limit: it can carry less, and the second more
        (BESIDE, [0, 0], [2, 0], [False, False]),  # open
        (BESIDE, [1, 1], [1, 1], [False, False]),  # both slide
        (BESIDE, [0, 0], [1, 1], [False, False]),  # both at the same limit: no other torques have the same sum
        (RING, [0, 0, 0], [0, 0, 0], [True, True, True]),
        (RING, [0, 5, 5], [0, 1, 1], [False, False, False]),
        ([[1, 1], [-1, -1.5]], [0, 0], [0, 0], [False, False]),  # the Dual-clutch: different ratios
        ([[1, 1, 0], [-1, 0, 1], [0, -1, -1]], [0, 0, 0], [1, 1, 0], [False, False, False]),
    ],
)
def test_what_can_change_without_a_slip(W, slips, modes, expected):
    assert judged(W, slips, modes) == expected


def test_two_brakes_and_a_clutch_between_them():
    line = hys.Drivetrain(
        hys.Inertia("a", 1), hys.Inertia("b", 1), hys.Brake("left", "a", 5), hys.Brake("right", "b", 5),
        hys.Clutch("middle", "a", "b", 5), hys.TorqueSource("T", "a", 4),
    )  # fmt: skip
    run = line.simulate({"a": 0, "b": 0}, 0.1, hys.Moreau(dt=1e-2))
    assert run.undetermined[-1].all()
    assert run["left.torque"][-1] + run["right.torque"][-1] == pytest.approx(4.0)


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
@pytest.mark.parametrize(("clutch", "brake", "end", "mode"), [(5, 10, 0.0, "+s"), (10, 5, 2.0, "s+")])
@pytest.mark.parametrize("start", [0.0, 2.0])
def test_given_speeds_that_contradict_each_other_are_decided_by_the_stronger(scheme, clutch, brake, end, mode, start):
    """A brake and a clutch to a given speed on one shaft cannot both stick: the weaker one slips at its limit."""
    line = hys.Drivetrain(
        hys.Inertia("a", 1.0), hys.SpeedSource("s", 2.0), hys.Clutch("c", "s", "a", clutch), hys.Brake("b", "a", brake)
    )  # fmt: skip
    run = line.simulate({"a": start}, 0.5, scheme, sample=0.1)
    assert run["a"][-1] == pytest.approx(end, abs=0.2)  # within the bands of those that have one
    np.testing.assert_allclose(run.torques[-1], [5.0, 5.0], atol=0.05)
    assert run.modes[-1] == mode
    assert run.messages == ()


def test_given_speeds_that_contradict_each_other_on_a_long_chain():
    parts = [hys.Inertia(f"J{i}", 1.0) for i in range(40)]
    parts += [hys.Clutch(f"c{i}", f"J{i}", f"J{i + 1}", 50.0) for i in range(39)]
    ends = [hys.SpeedSource("s", 2.0), hys.Clutch("drive", "s", "J0", 10), hys.Brake("hold", "J39", 5)]
    run = hys.Drivetrain(*parts, *ends).simulate(np.full(40, 2.0), 0.5)
    np.testing.assert_allclose(run.speeds[-1, :40], 2.0, atol=1e-9)
    np.testing.assert_allclose(run.torques[-1], 5.0, atol=1e-6)
    assert run.modes[-1] == "s" * 40 + "+"


@pytest.mark.parametrize("scheme", [hys.Exact(), hys.EventDriven()], ids=str)
def test_the_weaker_of_two_clutches_may_reach_its_limit_while_both_stick(scheme):
    line = hys.Drivetrain(
        hys.Inertia("a", 1), hys.Inertia("b", 1), hys.Clutch("strong", "a", "b", 10), hys.Clutch("weak", "a", "b", 4),
        hys.TorqueSource("T", "a", [(0, 0), (1, 36)]),
    )  # fmt: skip
    run = line.simulate({"a": 0, "b": 0}, 1.0, scheme, sample=0.01)
    assert run.t[-1] == 1.0
    held = run.t < 0.77
    np.testing.assert_allclose(run.torques[held].sum(axis=1), 18 * run.t[held], atol=1e-9)
    assert run.events[-1].time == pytest.approx(28 / 36, abs=1e-6)  # both at their limits, 14 together
    np.testing.assert_allclose(run["a"][-1] - run["b"][-1], 18 * (1 - 28 / 36) ** 2, atol=1e-9)
