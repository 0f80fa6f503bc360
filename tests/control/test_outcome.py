from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.move import MoveStatus
from hysdel_py.control.outcome import judged
from hysdel_py.control.settings import ControlTolerances
from hysdel_py.optimize.miqp import MiqpResult, MiqpStatus

X0 = np.array([3.0])


@pytest.fixture(scope="module")
def formulation(systems):
    return HybridMpc(systems.fold(), 2, Cost(y={"seen": 1})).formulation


def answer(status, x=None, objective=np.inf):
    return MiqpResult(status, x, objective, 1.0, objective - 1.0, 7, 9, 0.1, "said by the solver", 0.0)


def judge(formulation, result):
    return judged(formulation, formulation.vectors(X0, {}), X0, result, ControlTolerances())


@pytest.mark.parametrize(
    ("found", "expected", "words"),
    [
        (MiqpStatus.INFEASIBLE, MoveStatus.INFEASIBLE, "declared ranges"),
        (MiqpStatus.TIME_LIMIT, MoveStatus.NO_PLAN, "more time or nodes"),
        (MiqpStatus.NODE_LIMIT, MoveStatus.NO_PLAN, "more time or nodes"),
        (MiqpStatus.INTERRUPTED, MoveStatus.NO_PLAN, "search ended"),
        (MiqpStatus.UNBOUNDED, MoveStatus.UNBOUNDED, "range"),
        (MiqpStatus.NUMERICAL, MoveStatus.NUMERICAL, "said by the solver"),
    ],
)
def test_without_a_plan(formulation, found, expected, words):
    move, plan = judge(formulation, answer(found))
    assert move.status is expected
    assert not move.status.has_input
    assert move.u is None
    assert plan is None
    assert words in move.message
    assert (move.nodes, move.qps) == (7, 9)


GOOD = np.array([0.5, 1.0, 3.0, -1.0, 0.0, 0.0, 0.0, -0.8])  # u, d, z, x1 of two steps of the fold from 3


@pytest.mark.parametrize(
    ("found", "expected", "words"),
    [
        (MiqpStatus.OPTIMAL, MoveStatus.OPTIMAL, "optimal"),
        (MiqpStatus.TIME_LIMIT, MoveStatus.FEASIBLE, "time limit"),
        (MiqpStatus.NODE_LIMIT, MoveStatus.FEASIBLE, "node limit"),
        (MiqpStatus.INTERRUPTED, MoveStatus.FEASIBLE, "interruption"),
        (MiqpStatus.NUMERICAL, MoveStatus.FEASIBLE, "said by the solver"),
    ],
)
def test_with_a_plan(formulation, found, expected, words):
    move, plan = judge(formulation, answer(found, GOOD.copy(), 10.0))
    assert move.status is expected
    assert move.u.tolist() == [0.5]
    assert (move.cost, move.bound, move.gap) == (10.0, 1.0, 9.0)
    assert words in move.message
    assert plan().x[:, 0].tolist() == [3.0, -1.0, -0.8]


def test_a_plan_that_breaks_the_model_is_not_given_out(formulation):
    wrong = GOOD.copy()
    wrong[3] = -2.0
    move, plan = judge(formulation, answer(MiqpStatus.OPTIMAL, wrong, 10.0))
    assert move.status is MoveStatus.NUMERICAL
    assert move.u is None
    assert plan is None
    assert "violates the model" in move.message
