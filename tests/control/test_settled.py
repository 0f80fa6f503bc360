"""Limits that no input can move: what they allow for, and what is said of a state that misses one."""

from dataclasses import replace

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.control.influence import settled_signals
from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES

# The speed of the next step follows from the measured force; the input moves the one after that.
CART = """SYSTEM cart {
  INTERFACE { STATE { REAL speed [-200, 200]; REAL force [-50, 50]; } INPUT { REAL rate [-60, 60]; }
    OUTPUT { REAL v, brisk; } }
  IMPLEMENTATION {
    AUX { BOOL fast; REAL drag; }
    AD { fast = speed >= 100; }
    DA { drag = {IF fast THEN 0.5 ELSE 0}; }
    CONTINUOUS { speed = speed + force - drag; force = force + rate; }
    OUTPUT { v = speed; brisk = speed + rate; }
  }
}"""
LIMIT = 80.0


@pytest.fixture(scope="module")
def model():
    return hys.load(CART)


def controller(model, group="y", **arguments):
    limits = {"y": {"v": (LIMIT, None)}} if group == "y" else {"x": {"speed": (LIMIT, None)}}
    return hys.HybridMpc(model, 3, hys.Cost(y={"v": 1.0}), hys.Limits(**limits), **arguments)


def test_what_the_measured_state_settles(model):
    settled = settled_signals(model.mld, 4)
    assert settled == {("y", 0, 0), ("y", 0, 1), ("x", 0, 1)}


def test_an_input_behind_a_threshold_moves_the_state():
    text = CART.replace("fast = speed", "fast = speed + rate")
    assert settled_signals(hys.load(text).mld, 4) == {("y", 0, 0)}


@pytest.mark.parametrize("group", ["x", "y"])
@pytest.mark.parametrize("miss", [1e-9, 5e-7, 5e-5])
def test_rounding_on_a_limit_that_no_input_can_move_is_allowed(model, group, miss):
    """The force takes the speed a hair below its limit in the next step; later steps keep the limit."""
    move = controller(model, group).solve([90.0, -10.0 - miss])
    assert move.ok, move.message
    assert move.predicted.x[1, 0] == pytest.approx(LIMIT - miss, abs=1e-7)
    assert move.predicted.x[2, 0] >= LIMIT - 1e-4


@pytest.mark.parametrize("group", ["x", "y"])
def test_more_than_rounding_is_infeasible_and_says_why(model, group):
    move = controller(model, group).solve([90.0, -10.001])
    assert move.status is hys.MoveStatus.INFEASIBLE
    assert "will be 79.999 at k = 1, 0.001 outside its limit [80, inf]" in move.message
    assert "no input can change it" in move.message


def test_the_allowance_is_a_tolerance(model):
    strict = replace(DEFAULT_CONTROL_TOLERANCES, settled=0.0)
    assert not controller(model, tolerances=strict).solve([90.0, -10.0 - 5e-6]).ok
    loose = replace(DEFAULT_CONTROL_TOLERANCES, settled=1e-3)
    assert controller(model, tolerances=loose).solve([90.0, -10.001]).ok


def test_limits_of_a_call_allow_for_rounding_too(model):
    mpc = controller(model)
    assert mpc.solve([90.0, -15.0 - 5e-6], limits=hys.Limits(y={"v": (75.0, None)})).ok
    assert not mpc.solve([90.0, -15.001], limits=hys.Limits(y={"v": (75.0, None)})).ok


def test_only_settled_hard_limits_are_wider(model):
    f = controller(model).formulation
    low = {row.stage: low for row, low in zip(f.rows, f.low, strict=True) if row.band == ("y", 0)}
    assert low == {1: pytest.approx(LIMIT * (1 - 1e-6), abs=1e-12), 2: LIMIT}
    soft = hys.HybridMpc(model, 3, hys.Cost(y={"v": 1.0}), hys.Limits(y={"v": (LIMIT, None)}, soft=True)).formulation
    assert {low for row, low in zip(soft.rows, soft.low, strict=True) if row.band == ("y", 0)} == {LIMIT}


def test_a_closed_loop_rides_on_a_limit(model):
    """The cheapest speed is the least one; every step ends on the limit, which the next state settles."""
    run = hys.closed_loop(model, controller(model), [120.0, 0.0], 40)
    assert run.steps == 40
    assert run.x[:, 0].min() >= LIMIT - LIMIT * DEFAULT_CONTROL_TOLERANCES.settled
    assert np.abs(run.x[-5:, 0] - LIMIT).max() < 1e-3
