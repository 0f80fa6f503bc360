"""Interface, limits, honest bounds and independent solvers."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.backends.answer import failed_result
from hysdel_py.optimize.miqp import Miqp, MiqpSettings, MiqpSolver, MiqpStatus, solve_miqp
from hysdel_py.optimize.qp import Qp, QpStatus, objective_value, violation


@pytest.fixture(scope="module")
def mode_problem(two_mode_problem):
    return two_mode_problem()


@pytest.fixture(scope="module")
def mode_optimum(mode_problem):
    return solve_miqp(mode_problem, MiqpSettings(gap_abs=1e-9, gap_rel=1e-9)).objective


def knapsack(**changes):
    """Least -(3a + 4b + 2c) with 2a + 3b + c <= 4: b and c, value -6."""
    data = {"P": np.zeros((3, 3)), "q": [-3.0, -4.0, -2.0], "A": [[2.0, 3.0, 1.0]], "l": [-np.inf], "u": [4.0],
            "lb": [0, 0, 0], "ub": [1, 1, 1]}  # fmt: skip
    return Miqp(Qp(**(data | changes)), [0, 1, 2])


@pytest.mark.parametrize("backend", ["dense", "piqp", "osqp"])
def test_a_knapsack(backend):
    result = solve_miqp(knapsack(), MiqpSettings(backend=backend))
    assert result.status is MiqpStatus.OPTIMAL
    assert result.objective == pytest.approx(-6.0)
    assert result.x.tolist() == [0.0, 1.0, 1.0]
    assert result.gap <= 1e-5
    assert result.residual == 0.0


@pytest.mark.parametrize("backend", ["dense", "piqp", "osqp"])
def test_two_mode_control_agrees_between_back_ends(mode_problem, mode_optimum, backend):
    result = solve_miqp(mode_problem, MiqpSettings(backend=backend))
    assert result.status is MiqpStatus.OPTIMAL
    assert result.objective == pytest.approx(mode_optimum, rel=2e-6)
    assert result.bound <= mode_optimum + 1e-6
    assert mode_optimum <= result.objective + 1e-6
    assert violation(mode_problem.qp, result.x) <= 1e-7


def test_two_mode_control_obeys_its_system(mode_problem):
    x, u = np.array([-3.0, 2.0]), solve_miqp(mode_problem).x.reshape(-1, 6)
    for stage in u:
        angle = np.pi / 3 if x[0] < 0 else -np.pi / 3
        rotation = 0.8 * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        x = rotation @ x + [0.0, stage[0]]
        np.testing.assert_allclose(stage[4:], x, atol=1e-5)


@pytest.mark.parametrize("settings", [{"node_limit": 3}, {"time_limit": 0.0}])
def test_limits_leave_a_consistent_result(mode_problem, mode_optimum, settings):
    result = solve_miqp(mode_problem, MiqpSettings(**settings))
    assert result.status in (MiqpStatus.NODE_LIMIT, MiqpStatus.TIME_LIMIT)
    assert result.bound <= mode_optimum
    assert result.objective >= mode_optimum - 1e-5
    assert result.gap == pytest.approx(result.objective - result.bound) or result.x is None


def test_interruption_leaves_a_consistent_result(mode_problem, mode_optimum):
    seen = []

    def progress(info):
        seen.append(info)
        return info.nodes < 4

    result = solve_miqp(mode_problem, progress=progress)
    assert result.status is MiqpStatus.INTERRUPTED
    assert (result.nodes, len(seen)) == (4, 4)
    assert all(a.bound <= b.bound + 1e-9 for a, b in pairwise(seen))
    assert result.bound <= mode_optimum <= result.objective + 1e-5


def test_bounds_never_pass_the_optimum_during_the_search(mode_problem, mode_optimum):
    bounds = []
    solve_miqp(mode_problem, progress=lambda info: bounds.append(info.bound))
    assert max(bounds) <= mode_optimum + 1e-6


def test_a_good_incumbent_saves_work(mode_problem):
    cold = MiqpSettings(rounding=0)
    plain = solve_miqp(mode_problem, cold)
    warm = solve_miqp(mode_problem, cold, incumbent=plain.x)
    assert warm.objective == pytest.approx(plain.objective, rel=1e-6)
    assert warm.nodes <= plain.nodes
    binary_only = solve_miqp(mode_problem, cold, incumbent=plain.x[mode_problem.binaries])
    assert binary_only.nodes == warm.nodes


def test_a_wrong_incumbent_does_no_harm():
    assert solve_miqp(knapsack(), incumbent=[1.0, 1.0, 1.0]).objective == pytest.approx(-6.0)
    with pytest.raises(ArgumentError, match=r"incumbent has shape \(2,\)"):
        solve_miqp(knapsack(), incumbent=[1.0, 1.0])


class Flatterer:
    """A work space that calls the origin optimal."""

    def __init__(self, qp):
        self.answer = replace(failed_result(qp, QpStatus.OPTIMAL, "a lie"), objective=0.0)

    def solve(self, **vectors):
        return self.answer


def test_a_point_that_violates_a_row_never_becomes_the_incumbent():
    # x^2 with x + d/2 >= 1
    qp = Qp(np.diag([2.0, 0.0]), [0, 0], [[1.0, 0.5]], [1.0], [np.inf], [-2.0, 0.0], [2.0, 1.0])
    solver = MiqpSolver(Miqp(qp, [1]), MiqpSettings(backend="piqp"))
    solver.verified.open_space = lambda _, problem: Flatterer(problem)
    result = solver.solve()
    assert result.status is MiqpStatus.NUMERICAL
    assert (result.x, result.gap) == (None, np.inf)
    assert "neither solved" in result.message
    assert result.bound <= 0.25


def test_heuristic_is_asked_and_its_answers_checked(mode_problem, mode_optimum):
    asked = []

    def heuristic(x, lb, ub):
        asked.append(len(x))
        return [np.ones(10), np.zeros(10)]

    result = solve_miqp(mode_problem, heuristic=heuristic)
    assert asked[0] == mode_problem.qp.n
    assert result.objective == pytest.approx(mode_optimum, rel=2e-6)


def test_a_heuristic_with_a_wrong_shape_is_named(mode_problem):
    with pytest.raises(ArgumentError, match=r"heuristic gave shape \(3,\): rows of 10"):
        solve_miqp(mode_problem, heuristic=lambda x, lb, ub: np.ones(3))


def test_one_solver_serves_many_vectors(two_mode_problem, mode_problem):
    solver = MiqpSolver(mode_problem)
    for start in ([5.0, -4.0], [1.0, 1.0], [-3.0, 2.0]):
        other = two_mode_problem(start)
        again = solver.solve(l=other.qp.l, u=other.qp.u, constant=other.qp.constant)
        assert again.objective == pytest.approx(solve_miqp(other).objective, rel=2e-6)
        assert again.objective == pytest.approx(objective_value(other.qp, again.x), rel=1e-12)


def test_infeasible_and_unbounded_problems():
    assert solve_miqp(knapsack(l=[5.5], u=[5.6])).status is MiqpStatus.INFEASIBLE
    assert solve_miqp(knapsack(l=[9.0], u=[9.0])).status is MiqpStatus.INFEASIBLE
    ray = Qp(np.zeros((2, 2)), [-1.0, 0.0], [[1.0, 1.0]], [0.0], [np.inf], [0.0, 0.0], [np.inf, 1.0])
    result = solve_miqp(Miqp(ray, [1]))
    assert result.status is MiqpStatus.UNBOUNDED
    assert (result.objective, result.bound) == (-np.inf, -np.inf)


def test_free_real_variables_are_solved_to_a_proven_optimum():
    # (x - d - 0.3)^2 + (d - 0.6)^2 with x free
    P = [[2.0, -2.0], [-2.0, 4.0]]
    qp = Qp(P, [-0.6, 0.6 - 1.2], np.zeros((0, 2)), [], [], [-np.inf, 0], [np.inf, 1], 0.09 + 0.36)
    result = solve_miqp(Miqp(qp, [1]))
    assert result.status is MiqpStatus.OPTIMAL
    assert result.objective == pytest.approx(0.16, abs=1e-7)
    assert result.x == pytest.approx([1.3, 1.0], abs=1e-5)


def test_no_binaries_is_a_plain_program():
    qp = Qp([[2.0]], [-2.0], [[1.0]], [-np.inf], [0.5], [-9.0], [9.0])
    assert solve_miqp(Miqp(qp, [])).objective == pytest.approx(-0.75, abs=1e-6)


@pytest.mark.parametrize("seed", range(40))
def test_linear_costs_agree_with_highs(small_problem, seed):
    from scipy.optimize import Bounds, LinearConstraint, milp

    miqp = small_problem(1000 + seed)
    qp = miqp.qp
    linear = Miqp(Qp(np.zeros((qp.n, qp.n)), qp.q, qp.A, qp.l, qp.u, qp.lb, qp.ub), miqp.binaries)
    integrality = np.isin(np.arange(qp.n), miqp.binaries).astype(int)
    highs = milp(
        qp.q, constraints=LinearConstraint(qp.A, qp.l, qp.u), bounds=Bounds(qp.lb, qp.ub), integrality=integrality
    )
    ours = solve_miqp(linear)
    if highs.status == 2:
        assert ours.status is MiqpStatus.INFEASIBLE
    else:
        # HiGHS may use its tolerance of 1e-6 against the epsilon of a threshold, which is no better
        assert ours.objective >= highs.fun - 1e-5
        assert violation(qp, highs.x) > 1e-7 or ours.objective <= highs.fun + 1e-5


def test_two_mode_control_agrees_with_scip(two_mode_problem):
    scip = pytest.importorskip("pyscipopt", reason="the independent solver SCIP (pyscipopt) is not installed")
    miqp = two_mode_problem((5.0, -4.0), horizon=5)
    qp, model = miqp.qp, scip.Model()
    model.hideOutput()
    kinds = ["B" if i in set(miqp.binaries.tolist()) else "C" for i in range(qp.n)]
    x = [model.addVar(lb=qp.lb[i], ub=qp.ub[i], vtype=kinds[i]) for i in range(qp.n)]
    for row, low, high in zip(qp.A.toarray(), qp.l, qp.u, strict=True):
        expression = scip.quicksum(a * x[i] for i, a in enumerate(row) if a)
        model.addCons((low <= (expression <= high)) if np.isfinite([low, high]).all() else
                      expression <= high if np.isfinite(high) else expression >= low)  # fmt: skip
    cost = model.addVar(lb=None)
    P = qp.P.tocoo()
    square = scip.quicksum(0.5 * v * x[i] * x[j] for v, i, j in zip(P.data, *P.coords, strict=True))
    model.addCons(square + scip.quicksum(c * x[i] for i, c in enumerate(qp.q) if c) <= cost)
    model.setObjective(cost + qp.constant)
    model.optimize()
    assert solve_miqp(miqp).objective == pytest.approx(model.getObjVal(), rel=1e-5)


@pytest.mark.parametrize(
    ("binaries", "message"),
    [([3], "index 3: 0 to 2"), ([0, 0], "twice"), ([-1], "index -1"), ([0.5], "list of indices")],
)
def test_wrong_binaries_are_named(binaries, message):
    with pytest.raises(ArgumentError, match=message):
        Miqp(knapsack().qp, binaries)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gap_abs": -1.0}, "gap_abs is -1"),
        ({"integrality": 0.7}, "integrality is 0.7"),
        ({"feasibility": 0.0}, "feasibility is 0"),
        ({"time_limit": np.nan}, "time_limit is nan"),
    ],
)
def test_wrong_settings_are_named(changes, message):
    with pytest.raises(ArgumentError, match=message):
        MiqpSettings(**changes)


def test_unknown_back_end_is_refused():
    with pytest.raises(ArgumentError, match="known are piqp, osqp"):
        MiqpSolver(knapsack(), MiqpSettings(backend="cplex"))


def test_wrong_priorities_are_named():
    with pytest.raises(ArgumentError, match=r"priorities has shape \(2,\): 3 numbers"):
        Miqp(knapsack().qp, [0, 1, 2], priorities=[1, 2])
