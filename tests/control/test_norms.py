"""The norms 1 and infinity: costs by hand, against enumeration, and what warm starts must not change."""

from __future__ import annotations

import numpy as np
import pytest
from pwa_enumeration import optimum, random_problem

import hysdel_py as hys
from hysdel_py.control.costs import Cost
from hysdel_py.control.formulation import formulate
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import MoveStatus
from hysdel_py.errors import ArgumentError

NORMS = [1, np.inf]
SEEDS = range(34)


def judge(problem):
    move, expected = problem.controller().solve(problem.x0), optimum(problem)
    if not np.isfinite(expected):
        assert move.status is MoveStatus.INFEASIBLE
        return
    assert move.status is MoveStatus.OPTIMAL
    assert move.cost == pytest.approx(expected, rel=1e-5, abs=1e-5)
    assert move.bound <= expected + 1e-5 * max(1.0, abs(expected))


@pytest.mark.parametrize("norm", [1, 2, np.inf])
@pytest.mark.parametrize("seed", SEEDS)
def test_random_systems_equal_enumeration(seed, norm):
    judge(random_problem(seed, norm))


def test_some_of_the_random_problems_have_no_plan():
    kinds = {random_problem(seed, 1).controller().solve(random_problem(seed, 1).x0).status for seed in range(20)}
    assert kinds == {MoveStatus.OPTIMAL, MoveStatus.INFEASIBLE}


@pytest.mark.parametrize("norm", NORMS)
def test_cost_is_that_of_the_plan(systems, norm):
    """Every term by hand: outputs with a matrix of three rows, references, Boolean auxiliaries, the last state."""
    W = np.array([[1.0, -2.0], [0.5, 0.0], [0.0, 3.0]])
    cost = Cost(y=W, u={"fan": 0.2, "switch": 0.4}, d={"heat": 0.7}, terminal=[[2.0, 1.0]], norm=norm)
    mpc = HybridMpc(systems.heater(), 3, cost)
    ref = {"felt": [4.0, 8.0, 2.0], "hot": 0.5, "T": 1.0}
    move = mpc.solve([3.0, 1.0], ref)
    p, total = move.predicted, 0.0
    for k in range(3):
        total += np.linalg.norm(W @ (p.y[k] - [ref["felt"][k], 0.5]), norm)
        total += np.linalg.norm([0.2 * p.u[k, 0], 0.4 * p.u[k, 1]], norm) + 0.7 * p.d[k, 0]
    total += abs(2.0 * (p.x[3, 0] - 1.0) + p.x[3, 1])
    assert move.status is MoveStatus.OPTIMAL
    assert move.cost == pytest.approx(total, rel=1e-7)


@pytest.mark.parametrize("norm", NORMS)
def test_warm_and_cold_cost_agree(systems, norm):
    step, cost = systems.fold_step(), Cost(y={"seen": 1}, u={"push": 0.05}, norm=norm)
    warm, cold = HybridMpc(systems.fold(), 4, cost), HybridMpc(systems.fold(), 4, cost)
    x = np.array([8.0])
    for _ in range(4):
        a, b = warm.solve(x, {"seen": -3.0}), cold.solve(x, {"seen": -3.0}, warm=False)
        assert a.cost == pytest.approx(b.cost, rel=1e-4, abs=1e-5)
        x = step(x, a.u)[0]


def test_the_norms_differ(systems):
    costs = {norm: Cost(y=np.eye(2), norm=norm) for norm in (1, 2, "inf")}
    moves = [HybridMpc(systems.heater(), 2, c).solve([3.0, 1.0], {"felt": 9, "hot": 0.5}) for c in costs.values()]
    assert len({round(move.cost, 6) for move in moves}) == 3


@pytest.mark.parametrize("norm", NORMS)
def test_slack_is_priced_linearly(systems, norm):
    limits = Limits(x={"x": (-1, 1)}, soft=True, rho=100.0)
    move = HybridMpc(systems.fold(), 3, Cost(norm=norm), limits).solve([-10.0])
    assert move.slack["x"] == pytest.approx(6.0, abs=1e-6)
    assert move.cost == pytest.approx(600.0, rel=1e-7)


def test_bounds_of_the_terms_cut_nothing_off(systems):
    mld = systems.heater()
    cost = Cost(y=np.array([[1.0, -2.0], [3.0, 1.0]]), norm="inf")
    f = formulate(mld, 2, cost.resolve(mld), Limits().resolve(mld))
    vectors = f.vectors(np.array([-50.0, 1.0]), {"felt": np.full(3, 60.0), "hot": np.zeros(3)})
    # felt is between -50.5 and 50.5, hot between 0 and 1; |3 felt + hot - 180| is at most 331.5
    assert vectors.ub[f.layout.term(0) :] == pytest.approx([332.5, 332.5])
    assert f.layout.describe(f.layout.term(1)) == "cost of y[1]"


def test_shape_of_a_matrix(systems):
    with pytest.raises(ArgumentError, match=r"shape.*2 columns"):
        HybridMpc(systems.heater(), 2, Cost(y=np.ones((2, 3)), norm=1))
    with pytest.raises(ArgumentError, match="not a finite"):
        HybridMpc(systems.heater(), 2, Cost(y=[[np.nan, 1.0]], norm=1))
    with pytest.raises(ArgumentError, match="2 by 2"):
        HybridMpc(systems.heater(), 2, Cost(y=np.ones((3, 2))))


@pytest.mark.parametrize("norm", [1, 2, np.inf])
def test_the_model_runs_as_planned(norm):
    """The Dha, which knows no big-M and no solver, under the planned inputs."""
    model = hys.load("two_tanks")
    mpc = HybridMpc(model, 5, Cost(y={"level1": 1, "level2": 10}, norm=norm), gap_rel=1e-6)
    for start in ([0.1, 0.4], [0.45, 0.1], [0.3, 0.35]):
        plan = mpc.solve(start, {"level1": 0.2, "level2": 0.3}).predicted
        run = model.dha.simulate(start, plan.u, check=False)
        assert run.x == pytest.approx(plan.x, abs=1e-5)
        assert run.modes == plan.modes


@pytest.mark.parametrize("norm", [1, 2, np.inf])
def test_a_piecewise_affine_form_has_the_same_plans(norm):
    model, cost = hys.load("two_tanks"), Cost(y={"level1": 1, "level2": 10}, norm=norm)
    ref = {"level1": 0.2, "level2": 0.3}
    whole, modes = (HybridMpc(system, 3, cost, gap_rel=1e-6) for system in (model, hys.to_mld(model.pwa)))
    for start in ([0.1, 0.4], [0.45, 0.1]):
        assert modes.solve(start, ref).cost == pytest.approx(whole.solve(start, ref).cost, rel=1e-5, abs=1e-7)


def test_a_piecewise_affine_form_itself_is_refused_with_the_way():
    with pytest.raises(ArgumentError, match=r"a Pwa: .*hys\.to_mld\(pwa\)"):
        HybridMpc(hys.load("two_tanks").pwa, 3, Cost())
