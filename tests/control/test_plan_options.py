"""Increments, limits that vary, outputs of the last state, blocks, and switches relaxed beyond a stage."""

from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import MoveStatus
from hysdel_py.control.prediction import simulated_binaries
from hysdel_py.errors import ArgumentError

TOUCH = 1e-5


def solve(mld, x, ref=None, *, N=4, last=None, cost=None, limits=None, **options):
    mpc = HybridMpc(mld, N, cost or Cost(y={"seen": 1}), limits or Limits(), **options)
    return mpc.solve(x, {"seen": 3.0} if ref is None else ref, last_input=last)


# ------------------------------------------------------------------ increments


def test_limits_of_increments_hold_from_the_last_input_on(systems):
    move = solve(systems.fold(), [-5.0], last=[-0.6], limits=Limits(du={"push": (-0.1, 0.25)}))
    steps = np.diff(np.concatenate([[-0.6], move.predicted.u[:, 0]]))
    assert steps.max() <= 0.25 + TOUCH
    assert steps.max() == pytest.approx(0.25, abs=TOUCH)  # and without them the plan would go faster
    assert steps.min() >= -0.1 - TOUCH
    assert np.diff(np.concatenate([[-0.6], solve(systems.fold(), [-5.0]).predicted.u[:, 0]])).max() > 0.5


@pytest.mark.parametrize("norm", [1, 2, np.inf])
def test_weights_of_increments(systems, norm):
    cost = Cost(y={"seen": 1}, du={"push": 0.7}, norm=norm)
    move = solve(systems.fold(), [-5.0], last={"push": -0.6}, cost=cost)
    steps = np.diff(np.concatenate([[-0.6], move.predicted.u[:, 0]]))
    size = (lambda v: v**2) if norm == 2 else abs
    expected = sum(size(move.predicted.y[:, 0] - 3.0)) + 0.7 * sum(size(steps))
    assert move.cost == pytest.approx(expected, rel=1e-5)
    held = solve(systems.fold(), [-5.0], last=[-0.6], cost=Cost(y={"seen": 1}, du={"push": 1e5}, norm=norm))
    assert held.predicted.u[:, 0] == pytest.approx(np.full(4, -0.6), abs=1e-3)


def test_boolean_inputs_can_be_kept_from_switching(systems):
    cost = Cost(y={"felt": 1})
    free = HybridMpc(systems.heater(), 3, cost).solve([0.0, 1.0], {"felt": 9.0})
    kept = HybridMpc(systems.heater(), 3, cost, Limits(du={"switch": (0, 0)})).solve(
        [0.0, 1.0], {"felt": 9.0}, last_input=[0.0, 0.0]
    )
    assert free.predicted.u[:, 1].any()
    assert not kept.predicted.u[:, 1].any()


def test_the_last_input_is_asked_for_exactly_when_it_counts(systems):
    mpc = HybridMpc(systems.fold(), 2, Cost(y={"seen": 1}), Limits(du={"push": (-1, 1)}))
    with pytest.raises(ArgumentError, match=r"last_input is missing.*push"):
        mpc.solve([1.0])
    with pytest.raises(ArgumentError, match="last input"):
        mpc.solve([1.0], last_input=[1.0, 2.0])
    assert mpc.uses_last_input
    plain = HybridMpc(systems.fold(), 2, Cost(y={"seen": 1}))
    assert not plain.uses_last_input
    assert plain.solve([1.0]).cost == pytest.approx(plain.solve([1.0], last_input=[0.5], warm=False).cost, rel=1e-6)


def test_closed_loop_hands_the_applied_input_on(systems):
    mpc = HybridMpc(systems.fold(), 3, Cost(y={"seen": 1}), Limits(du={"push": (-0.2, 0.2)}))
    run = closed_loop(systems.fold(), mpc, [-5.0], 6, {"seen": 3.0}, last_input=[-1.0])
    steps = np.diff(np.concatenate([[-1.0], run.u[:, 0]]))
    assert np.abs(steps).max() == pytest.approx(0.2, abs=TOUCH)
    assert run.u[-1, 0] > -0.5  # more than one step of 0.2 away from the first
    with pytest.raises(ArgumentError, match="last_input"):
        closed_loop(systems.fold(), mpc, [-5.0], 6, {"seen": 3.0})


@pytest.mark.parametrize(
    ("du", "words"),
    [({"pull": (0, 1)}, "push"), ({"push": (1, 0)}, r"\[1, 0\]"), ({"push": (5, 9)}, r"\[-2, 2\]")],
)
def test_wrong_limits_of_increments(systems, du, words):
    with pytest.raises(ArgumentError, match=words):
        HybridMpc(systems.fold(), 2, Cost(), Limits(du=du))


# ------------------------------------------------------------------ limits that vary


def test_limits_over_the_horizon(systems):
    ends = [1.0, 0.5, 0.25, 0.1]
    move = solve(systems.fold(), [-5.0], limits=Limits(u={"push": (None, ends)}))
    assert move.predicted.u[:, 0].max() <= 1.0
    assert (move.predicted.u[:, 0] <= np.array(ends) + 1e-9).all()
    assert (solve(systems.fold(), [-5.0]).predicted.u[:, 0] > np.array(ends) + 0.1).any()


@pytest.mark.parametrize("soft", [False, True])
def test_a_state_limit_that_tightens(systems, soft):
    ends = [10.0, 10.0, 10.0, 0.5, 0.5]
    limits = Limits(x={"x": (None, ends)}, soft=soft, rho=1e6)
    move = solve(systems.fold(), [4.0], {"seen": 9.0}, limits=limits)
    x = move.predicted.x[:, 0]
    assert x[3] <= 0.5 + 1e-2
    assert solve(systems.fold(), [4.0], {"seen": 9.0}).predicted.x[3, 0] > 0.6


def test_an_output_limit_with_n_entries_goes_on(systems):
    move = HybridMpc(systems.heater(), 3, Cost(y={"felt": 1}), Limits(y={"felt": (-9, [5.0, 4.0, 3.0])})).solve(
        [2.0, 1.0], {"felt": 20.0}
    )
    assert (move.predicted.y[:, 0] <= np.array([5.0, 4.0, 3.0]) + TOUCH).all()
    assert move.predicted.y[:, 0].max() > 2.5


def test_a_floor_that_rises(systems):
    floor = [-1.0, -0.5, 0.25, 0.5]
    move = solve(systems.fold(), [6.0], {"seen": -9.0}, limits=Limits(u={"push": (floor, None)}))
    assert (move.predicted.u[:, 0] >= np.array(floor) - 1e-9).all()
    assert move.predicted.u[0, 0] < -0.9


def test_lengths_of_limits(systems):
    with pytest.raises(ArgumentError, match=r"shape \(3,\).*length 4 or 5"):
        solve(systems.fold(), [1.0], limits=Limits(u={"push": (None, [1, 1, 1])}))
    with pytest.raises(ArgumentError, match="low end"):
        solve(systems.fold(), [1.0], limits=Limits(u={"push": (0.5, [1, 1, 1, 0])}))


def test_limit_of_an_output_of_the_last_state(systems):
    limits = Limits(terminal={"seen": (0.6, None)})
    assert solve(systems.fold(), [-1.0], {"seen": -5.0}, limits=limits).predicted.x[-1, 0] >= 0.6 - TOUCH
    assert solve(systems.fold(), [-1.0], {"seen": -5.0}).predicted.x[-1, 0] < 0
    soft = Limits(terminal={"seen": (9.0, None)}, soft=True)
    assert solve(systems.fold(), [-1.0], limits=soft).slack["seen"] > 1
    with pytest.raises(ArgumentError, match=r"felt.*depends on an input"):
        HybridMpc(systems.heater(), 2, Cost(), Limits(terminal={"felt": (0, 1)}))
    with pytest.raises(ArgumentError, match="no state or output named"):
        HybridMpc(systems.heater(), 2, Cost(), Limits(terminal={"cold": (0, 1)}))


# ------------------------------------------------------------------ blocks and horizons


def test_blocks_hold_the_inputs(systems):
    move = solve(systems.fold(), [8.0], {"seen": 0.7}, N=8, blocking=(1, 1, 2, 4))
    u = move.predicted.u[:, 0]
    for start, end in ((2, 4), (4, 8)):
        assert u[start:end] == pytest.approx(np.full(end - start, u[start]), abs=1e-6)
    assert move.cost > solve(systems.fold(), [8.0], {"seen": 0.7}, N=8).cost + 1e-3


def test_blocked_plan_is_the_optimum_among_such_plans(systems):
    """Two free numbers: a fine grid cannot be better, and comes close."""
    step = systems.fold_step()
    move = solve(systems.fold(), [4.0], {"seen": 2.0}, N=4, blocking=[2, 2], gap_rel=1e-7)

    def cost(a, b):
        x, total = np.array([4.0]), 0.0
        for u in (a, a, b, b):
            total += (x[0] - 2.0) ** 2
            x = step(x, np.array([u]))[0]
        return total

    grid = min(cost(a, b) for a in np.linspace(-1, 1, 81) for b in np.linspace(-1, 1, 81))
    assert move.cost <= grid + 1e-4
    assert move.cost >= grid - 0.1


def test_control_horizon_is_a_last_long_block(systems):
    u = solve(systems.fold(), [8.0], {"seen": -3.0}, N=6, control_horizon=2).predicted.u[:, 0]
    assert u[1:] == pytest.approx(np.full(5, u[1]), abs=1e-6)
    assert abs(u[0] - u[1]) > 1e-3


def test_warm_start_within_blocks(systems):
    mpc = HybridMpc(systems.fold(), 6, Cost(y={"seen": 1}), blocking=(1, 2, 3))
    cold = HybridMpc(systems.fold(), 6, Cost(y={"seen": 1}), blocking=(1, 2, 3))
    for x in (8.0, -7.0, 5.5):
        assert mpc.solve([x], {"seen": 2.0}).cost == pytest.approx(
            cold.solve([x], {"seen": 2.0}, warm=False).cost, rel=1e-4
        )


def test_guesses_hold_the_inputs_too(systems):
    mpc = HybridMpc(systems.fold(), 4, Cost(y={"seen": 1}), blocking=(2, 2))
    v = np.zeros(mpc.formulation.layout.n)
    v[[mpc.formulation.layout.start("u", k) for k in range(4)]] = [0.5, -1.0, -1.0, 1.0]
    plan = mpc.formulation.layout.split(v, np.array([-0.5]))
    # held: 0.1, 0.45, -1.225, -1.98; as they stand: 0.1, -1.05, -1.84, -0.472
    guess = simulated_binaries(mpc.formulation, systems.fold().step, np.array([-0.5]), plan)
    assert guess.tolist() == [0.0, 1.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"blocking": (1, 2)}, "sum 4"),
        ({"blocking": (4, 0)}, "sum 4"),
        ({"blocking": 4}, "blocking is 4"),
        ({"blocking": (2.0, 2)}, "whole numbers"),
        ({"control_horizon": 5}, "control_horizon is 5"),
        ({"control_horizon": 0}, "from 1"),
        ({"binary_horizon": "all"}, "binary_horizon"),
        ({"blocking": (2, 2), "control_horizon": 2}, "both"),
    ],
)
def test_wrong_shapes(systems, options, words):
    with pytest.raises(ArgumentError, match=words):
        solve(systems.fold(), [1.0], **options)


def test_relaxed_switches_beyond_the_binary_horizon(systems):
    exact = solve(systems.fold(), [-6.0], {"seen": 4.0}, N=6)
    short = solve(systems.fold(), [-6.0], {"seen": 4.0}, N=6, binary_horizon=2)
    assert short.status is MoveStatus.OPTIMAL
    assert short.cost <= exact.cost + 1e-4 * exact.cost
    assert short.cost < exact.cost - 1e-3  # here the relaxation is a real one
    assert (exact.approximate_from, short.approximate_from) == (None, 2)
    assert "approximation: binaries of step 2 and later are relaxed" in short.message
    assert set(short.predicted.d[:2, 0]) <= {0.0, 1.0}
    assert not set(short.predicted.d[2:, 0]) <= {0.0, 1.0}
