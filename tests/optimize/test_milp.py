"""HiGHS with checked answers: against the exact oracle, and what happens when it is wrong."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize import milp as module
from hysdel_py.optimize.milp import MilpSolver, solve_milp
from hysdel_py.optimize.mixed_integer import Miqp, MiqpSettings, MiqpStatus
from hysdel_py.optimize.qp import Qp

TIGHT = MiqpSettings(gap_abs=1e-8, gap_rel=1e-8)


def linear(problem):
    """The same rows with the linear part of the objective alone."""
    qp = problem.qp
    return Miqp(Qp(0 * qp.P, qp.q, qp.A, qp.l, qp.u, qp.lb, qp.ub, qp.constant), problem.binaries)


def knapsack():
    """max 3 a + 2 b + x with 2 a + 2 b + x <= 3, x <= 0.5: a = 1, x = 0.5."""
    qp = Qp(np.zeros((3, 3)), [-3.0, -2.0, -1.0], [[2.0, 2.0, 1.0]], [-inf], [3.0], [0, 0, 0], [1, 1, 0.5], 10.0)
    return Miqp(qp, [0, 1])


@pytest.mark.parametrize("seed", range(40))
def test_equals_the_oracle(seed, small_problem, enumerated):
    problem = linear(small_problem(seed))
    expected, result = enumerated(problem), solve_milp(problem, TIGHT)
    if np.isfinite(expected):
        assert result.status is MiqpStatus.OPTIMAL
        assert result.objective == pytest.approx(expected, abs=1e-6)
        assert result.bound <= expected + 1e-6
        assert set(result.x[problem.binaries]) <= {0.0, 1.0}
    else:
        assert result.status is MiqpStatus.INFEASIBLE


def test_by_hand():
    result = solve_milp(knapsack())
    assert result.status is MiqpStatus.OPTIMAL
    assert result.x.tolist() == [1.0, 0.0, 0.5]
    assert result.objective == pytest.approx(6.5)
    assert result.bound == pytest.approx(6.5)
    assert result.message.startswith("HiGHS")


def test_vectors_replace_those_of_the_problem():
    solver = MilpSolver(knapsack())
    assert solver.solve([-1.0, -2.0, -1.0], u=[2.0], constant=0.0).objective == pytest.approx(-2.0)
    assert solver.solve(ub=[0, 1, 0]).x.tolist() == [0, 1, 0]
    assert solver.solve(l=[2.5], u=[3.0]).objective == pytest.approx(6.5)


def test_unbounded_and_infeasible():
    problem = knapsack()
    free = Qp(np.zeros((3, 3)), problem.qp.q, np.zeros((0, 3)), [], [], [0, 0, 0], [1, 1, inf])
    assert solve_milp(Miqp(free, [0, 1])).status is MiqpStatus.UNBOUNDED
    assert solve_milp(problem, l=[9.0], u=[9.0]).status is MiqpStatus.INFEASIBLE
    assert solve_milp(problem, l=[2.0], u=[1.0]).status is MiqpStatus.INFEASIBLE


def test_a_quadratic_objective_is_refused():
    qp = knapsack().qp
    with pytest.raises(ArgumentError, match="linear"):
        MilpSolver(Miqp(Qp(np.eye(3), qp.q, qp.A, qp.l, qp.u, qp.lb, qp.ub), [0, 1]))


def fake(monkeypatch, **changes):
    """Change what HiGHS says about problems with binaries."""
    ask = module._highs

    def changed(qp, integrality, options):
        word = ask(qp, integrality, options)
        return replace(word, **changes) if integrality.any() else word

    monkeypatch.setattr(module, "_highs", changed)


@pytest.mark.parametrize(
    "changes",
    [
        {"status": 2, "x": None},  # wrongly infeasible, which the incumbent contradicts
        {"x": np.array([0.0, 1.0, 0.5])},  # optimal, but the bound says otherwise
        {"x": np.array([1.0, 1.0, 0.0])},  # no point
        {"bound": 5.0},  # a bound above the optimum of -3.5
        {"status": 4, "x": None, "message": "gave up"},
    ],
)
def test_an_answer_that_fails_its_check_goes_to_the_branch_and_bound(monkeypatch, changes):
    fake(monkeypatch, **changes)
    result = solve_milp(knapsack(), incumbent=None if "x" in changes and changes.get("status") != 2 else [1.0, 0.0])
    assert result.status is MiqpStatus.OPTIMAL
    assert result.objective == pytest.approx(6.5, abs=1e-6)
    assert "by branch and bound" in result.message


def test_a_binary_that_is_hardly_off_does_not_loosen_a_threshold():
    """x <= 1e7 d with x = 1 asks for d = 1, although 1e-7 would do within the tolerance of HiGHS."""
    qp = Qp(np.zeros((2, 2)), [0.0, 1.0], [[1.0, -1e7]], [-inf], [0.0], [1.0, 0.0], [1.0, 1.0])
    result = solve_milp(Miqp(qp, [1]))
    assert result.status is MiqpStatus.OPTIMAL
    assert result.x.tolist() == [1.0, 1.0]
    assert result.objective == 1.0


def test_binaries_are_rounded_before_a_point_counts(monkeypatch):
    fake(monkeypatch, x=np.array([1.0, 1e-7]), bound=1e-7)
    qp = Qp(np.zeros((2, 2)), [0.0, 1.0], [[1.0, -1e7]], [-inf], [0.0], [1.0, 0.0], [1.0, 1.0])
    assert solve_milp(Miqp(qp, [1])).objective == pytest.approx(1.0, abs=1e-6)


def test_the_incumbent_is_the_answer_when_the_search_finds_nothing(monkeypatch):
    fake(monkeypatch, status=1, x=None, bound=-inf, message="limit")
    result = solve_milp(knapsack(), incumbent=[0.0, 1.0], floor=1.0)
    assert result.status is MiqpStatus.NODE_LIMIT
    assert result.objective == pytest.approx(7.5)
    assert result.bound == 1.0
    assert result.gap == pytest.approx(6.5)
    assert solve_milp(knapsack(), MiqpSettings(time_limit=0.0)).status is MiqpStatus.TIME_LIMIT


def test_progress_is_called_once():
    seen = []
    solve_milp(knapsack(), progress=seen.append)
    assert [info.objective for info in seen] == pytest.approx([6.5])
