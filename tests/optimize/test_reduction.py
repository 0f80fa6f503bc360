"""The reduced problem is the full one without fixed variables and doubled rows."""

from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.optimize.backends.registry import get_backend
from hysdel_py.optimize.certificate import dual_bound, farkas_bound
from hysdel_py.optimize.qp import Qp, QpStatus, objective_value, violation
from hysdel_py.optimize.reduction import Reducer


def random_problem(seed):
    """A feasible problem with fixed variables, parallel rows of both signs and scales, and rows without sides."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(3, 8)), int(rng.integers(2, 7))
    root = rng.normal(size=(int(rng.integers(1, n + 1)), n))
    A = rng.normal(size=(m, n)) * (rng.random((m, n)) < 0.7)
    point = rng.uniform(-1, 1, n)
    copies = rng.integers(0, m, 4)
    A = np.vstack([A, A[copies] * rng.choice([-2.0, -1.0, 0.5, 3.0], 4)[:, None]])
    rows = A @ point
    low, high = rows - rng.exponential(0.5, len(rows)), rows + rng.exponential(0.5, len(rows))
    low[rng.random(len(rows)) < 0.4], high[rng.random(len(rows)) < 0.3] = -np.inf, np.inf
    lb, ub = point - rng.uniform(0.1, 2, n), point + rng.uniform(0.1, 2, n)
    fixed = rng.random(n) < 0.4
    lb[fixed] = ub[fixed] = point[fixed]
    return Qp(root.T @ root, rng.normal(size=n), A, low, high, lb, ub, constant=0.5)


@pytest.mark.parametrize("seed", range(60))
def test_answer_of_the_reduced_problem_solves_the_full_one(seed):
    qp = random_problem(seed)
    reduction = Reducer(qp).reduce(qp)
    if reduction is None:
        assert np.all(qp.lb == qp.ub) or not np.abs(qp.A.toarray()[:, qp.lb < qp.ub]).any()
        return
    answer = get_backend("piqp").workspace(reduction.qp).solve()
    assert answer.status is QpStatus.OPTIMAL
    x, y = reduction.primal(answer.x), reduction.multipliers(answer.y)
    assert violation(qp, x) < 1e-7
    assert objective_value(qp, x) == pytest.approx(answer.objective, abs=1e-8)
    # A certified bound that meets the value proves that both x and the multipliers are those of the full problem.
    assert dual_bound(qp, x, y) == pytest.approx(objective_value(qp, x), abs=1e-5)


def test_parallel_rows_become_one_and_meeting_sides_an_equality():
    # z <= f and -2 z <= -2 f with f = 3, and a row that only bounds the fixed variable
    A = [[1.0, 0.0], [-2.0, 0.0], [1.0, 5.0], [0.0, 1.0]]
    qp = Qp(np.eye(2), [0.0, 0.0], A, [-np.inf] * 4, [3.0, -6.0, 20.0, 4.0], [-9.0, 1.0], [9.0, 1.0])
    reduced = Reducer(qp).reduce(qp)
    assert (reduced.qp.n, reduced.qp.m) == (1, 1)
    assert reduced.qp.l == reduced.qp.u == [3.0]
    assert reduced.primal(np.array([3.0])).tolist() == [3.0, 1.0]
    assert reduced.multipliers(np.array([4.0])).tolist() == [4.0, 0.0, 0.0, 0.0]
    assert reduced.multipliers(np.array([-4.0])).tolist() == [0.0, 2.0, 0.0, 0.0]


def test_contradicting_rows_give_a_ray_of_farkas():
    qp = Qp(np.eye(1), [0.0], [[1.0], [-1.0]], [-np.inf, -np.inf], [1.0, -1.001], [-5.0], [5.0])
    reduction = Reducer(qp).reduce(qp)
    answer = get_backend("piqp").workspace(reduction.qp).solve()
    assert answer.status is QpStatus.INFEASIBLE
    ray = reduction.multipliers(np.array([1.0])) + reduction.multipliers(np.array([-1.0]))
    assert farkas_bound(qp, ray) == pytest.approx(1e-3)


def test_rows_that_are_nearly_parallel_stay_apart():
    qp = Qp(np.eye(2), [0, 0], [[1.0, 5.0], [1.0, 5.000001]], [-np.inf] * 2, [1.0, 1.0], [-1, -1], [1, 1])
    assert Reducer(qp).reduce(qp).qp.m == 2


def test_nothing_is_left_of_a_fixed_problem():
    qp = Qp(np.eye(1), [0.0], [[1.0]], [0.0], [1.0], [0.5], [0.5])
    assert Reducer(qp).reduce(qp) is None
