"""Pseudo-costs: what they choose, how they are learnt and handed on, and that they never change an answer."""

import numpy as np
import pytest

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.kernels.branching import branching_variable, learn
from hysdel_py.optimize.kernels.residual import violations
from hysdel_py.optimize.miqp import MiqpSettings, MiqpSolver, MiqpStatus
from hysdel_py.optimize.qp import violation

TIGHT = MiqpSettings(backend="dense", gap_abs=1e-8, gap_rel=1e-8)


def choice(w, priorities, costs=None, wanted=1.0, fixed=()):
    n = len(w)
    lb, ub = np.zeros(n), np.ones(n)
    lb[list(fixed)] = 1.0
    costs = np.zeros((n, 4)) if costs is None else costs
    return branching_variable(
        lb, ub, np.array(w), np.arange(n), np.array(priorities, dtype=float), 1e-6, costs, wanted
    )  # fmt: skip


def seen(n, growths):
    """Pseudo-costs after one observation of each pair (variable, growth in both halves)."""
    costs = np.zeros((n, 4))
    for variable, growth in growths:
        learn(costs, variable, 0.0, 0.5, growth)
        learn(costs, variable, 1.0, 0.5, growth)
    return costs


def test_without_experience_the_earliest_stage_and_there_the_most_fractional():
    assert choice([0.9, 0.6, 0.5], [0, 0, 1]) == 1
    assert choice([1.0, 0.0, 0.5], [0, 0, 1]) == 2
    assert choice([1.0, 0.0, 1.0], [1, 0, 2]) == 1
    assert choice([0.5, 0.5], [0, 1], fixed=(0, 1)) == -1


def test_a_binary_that_never_paid_is_passed_over():
    costs = seen(3, [(0, 0.0), (1, 0.2), (2, 0.25)])
    assert choice([0.5, 0.5, 0.5], [0, 1, 2], costs) == 1
    assert choice([0.5, 0.5, 0.5], [0, 1, 2], costs, fixed=(1, 2)) == 0


def test_growth_beyond_what_is_wanted_does_not_count():
    costs = seen(2, [(0, 1.0), (1, 1e6)])
    assert choice([0.5, 0.5], [0, 1], costs, wanted=0.5) == 0
    assert choice([0.5, 0.5], [0, 1], costs, wanted=np.inf) == 1


def test_an_unknown_growth_is_not_learnt():
    costs = np.zeros((1, 4))
    learn(costs, 0, 1.0, 0.25, np.nan)
    assert not costs.any()
    learn(costs, 0, 1.0, 0.25, 3.0)
    assert costs[0].tolist() == [0.0, 0.0, 4.0, 1.0]


@pytest.mark.parametrize("seed", range(60))
def test_any_pseudo_costs_give_the_optimum(small_problem, oracle, seed):
    solver = MiqpSolver(small_problem(seed), TIGHT)
    costs = np.random.default_rng(seed).exponential(size=(solver.miqp.qp.n, 4)) ** 4
    result, expected = solver.solve(pseudo_costs=costs), oracle(seed)
    if expected == np.inf:
        assert result.status is MiqpStatus.INFEASIBLE
    else:
        assert result.objective == pytest.approx(expected, abs=1e-6 * (1 + abs(expected)))
        assert result.bound <= expected + 1e-7 * (1 + abs(expected))


def test_a_search_hands_its_pseudo_costs_on(two_mode_problem):
    solver = MiqpSolver(two_mode_problem(horizon=6), MiqpSettings(backend="dense", rounding=0))
    first = solver.solve()
    assert first.pseudo_costs[:, [1, 3]].sum() > 0
    again = solver.solve(pseudo_costs=first.pseudo_costs)
    assert again.objective == pytest.approx(first.objective, rel=1e-6)
    assert again.pseudo_costs[:, [1, 3]].sum() > first.pseudo_costs[:, [1, 3]].sum()
    assert solver.solve().nodes == first.nodes  # nothing is remembered that was not handed on


def test_what_a_search_of_another_program_handed_on_is_refused(two_mode_problem):
    settings = MiqpSettings(backend="dense", rounding=0, leaves=8)
    short, long = (MiqpSolver(two_mode_problem(horizon=h), settings) for h in (4, 6))
    found = long.solve()
    with pytest.raises(ArgumentError, match="point has shape"):
        short.solve(point=found.x)
    with pytest.raises(ArgumentError, match="active names rows outside"):
        short.solve(active=np.array([[10**6, 1]]))
    with pytest.raises(ArgumentError, match="active has shape"):
        short.solve(active=np.zeros(3, dtype=np.int64))
    with pytest.raises(ArgumentError, match="pseudo_costs has shape"):
        short.solve(pseudo_costs=found.pseudo_costs)
    with pytest.raises(ArgumentError, match="cover is not one of a program with"):
        short.solve(cover=found.cover)
    again = long.solve(cover=found.cover, pseudo_costs=found.pseudo_costs)
    assert again.objective == pytest.approx(found.objective, rel=1e-6)
    assert again.nodes < found.nodes


def test_one_end_is_no_division():
    with pytest.raises(ArgumentError, match="leaves is 1"):
        MiqpSettings(leaves=1)


@pytest.mark.parametrize("seed", range(20))
def test_violations_are_those_of_a_direct_computation(small_problem, seed):
    qp = small_problem(seed).qp
    x = np.random.default_rng(seed).normal(size=qp.n) * 3
    rows = qp.A.tocsr()
    compressed = rows.indptr.astype(np.int64), rows.indices.astype(np.int64), rows.data
    absolute, relative = violations(compressed, qp.l, qp.u, qp.lb, qp.ub, x)
    at = rows @ x
    over = np.concatenate([np.maximum(qp.l - at, at - qp.u), np.maximum(qp.lb - x, x - qp.ub)])
    size = np.concatenate([abs(rows) @ abs(x), abs(x)])
    assert absolute == pytest.approx(max(over.max(), 0.0), rel=1e-12)
    assert relative == pytest.approx(max((over / np.maximum(1.0, size)).max(), 0.0), rel=1e-12)
    assert (absolute > 0) == (violation(qp, x) > 0)
    x[0] = np.nan
    assert violations(compressed, qp.l, qp.u, qp.lb, qp.ub, x) == (np.inf, np.inf)
