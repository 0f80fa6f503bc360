"""What a controller does without a plan: never silent, and it says which input it took."""

from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import MoveStatus
from hysdel_py.errors import ArgumentError

COST = Cost(y={"seen": 1})
TIGHT = Limits(x={"x": (-1, 1)})


def controller(systems, fallback, limits=TIGHT, **options):
    return HybridMpc(systems.fold(), 3, COST, limits, fallback=fallback, **options)


def test_without_a_fallback_there_is_no_input(systems):
    move = controller(systems, None).solve([-10.0])
    assert (move.status, move.u, move.fallback) == (MoveStatus.INFEASIBLE, None, "")


def test_softened_limits(systems):
    move = controller(systems, "soft").solve([-10.0])
    soft = HybridMpc(systems.fold(), 3, COST, Limits(x={"x": (-1, 1)}, soft=True)).solve([-10.0])
    assert move.status is MoveStatus.FALLBACK
    assert move.ok
    assert (move.fallback, move.cause) == ("soft", MoveStatus.INFEASIBLE)
    assert move.u == pytest.approx(soft.u)
    assert move.cost == pytest.approx(soft.cost)
    assert "fallback soft: softened limits, exceeded: x by 6" in move.message
    assert "infeasible: no plan keeps the model" in move.message


def test_softening_does_not_mend_a_state_outside_the_model(systems):
    move = controller(systems, "soft").solve([11.0])
    assert move.status is MoveStatus.INFEASIBLE
    assert move.u is None
    assert "softened limits found none either" in move.message


def test_rest_of_the_last_plan(systems):
    mpc = controller(systems, "last_plan")
    first = mpc.solve([0.9], {"seen": 0.3})
    planned = first.predicted.u[:, 0]
    for k in (1, 2):
        move = mpc.solve([-10.0], {"seen": 0.3})
        assert move.status is MoveStatus.FALLBACK
        assert move.u.tolist() == [planned[k]]
        assert f"input {k} of the last plan" in move.message
    over = mpc.solve([-10.0], {"seen": 0.3})
    assert over.status is MoveStatus.INFEASIBLE
    assert "no input of an earlier plan left" in over.message


def test_last_plan_needs_a_plan_and_forgets_it(systems):
    assert controller(systems, "last_plan").solve([-10.0]).u is None
    mpc = controller(systems, "last_plan")
    mpc.solve([0.5])
    mpc.reset()
    assert mpc.solve([-10.0]).u is None


def test_last_plan_keeps_the_limits_of_increments(systems):
    mpc = controller(systems, "last_plan", Limits(x={"x": (-1, 1)}, du={"push": (-0.3, 0.3)}))
    assert mpc.solve([0.2], last_input=[0.0]).ok
    move = mpc.solve([-10.0], last_input=[0.9])
    assert move.u is None
    assert "breaks the limits now: increment of push" in move.message


def test_an_input_from_the_caller(systems):
    seen = []

    def brake(x, move):
        seen.append((x.tolist(), move.status))
        return {"push": 0.75}

    move = controller(systems, brake).solve([-10.0])
    assert (move.status, move.u.tolist(), move.fallback) == (MoveStatus.FALLBACK, [0.75], "callable")
    assert seen == [([-10.0], MoveStatus.INFEASIBLE)]
    with pytest.raises(ArgumentError, match=r"input of the fallback push = 2 is outside"):
        controller(systems, lambda x, move: [2.0]).solve([-10.0])


def test_closed_loop_counts_the_fallbacks(systems):
    run = closed_loop(systems.fold(), controller(systems, "soft"), [-6.0], 8, {"seen": 0.5})
    count = int(run.info["fallback"].sum())
    assert 1 <= count < 8
    assert run.info["status"][0] == MoveStatus.FALLBACK.code
    assert f"{count} of 8 inputs came from the fallback" in run.messages
    assert run.messages[0].startswith("step 0: fallback soft")
    quiet = closed_loop(systems.fold(), controller(systems, "soft"), [0.5], 3, {"seen": 0.5})
    assert quiet.messages == ()
    assert not quiet.info["fallback"].any()


@pytest.mark.parametrize("norm", [1, np.inf])
def test_fallback_with_a_linear_program(systems, norm):
    mpc = HybridMpc(systems.fold(), 3, Cost(y={"seen": 1}, norm=norm), TIGHT, fallback="soft")
    assert mpc.solve([-10.0]).status is MoveStatus.FALLBACK


def test_wrong_fallbacks(systems):
    with pytest.raises(ArgumentError, match="fallback is 'stop'"):
        controller(systems, "stop")
    with pytest.raises(ArgumentError, match="could be softened"):
        controller(systems, "soft", Limits(u={"push": (0, 1)}))
