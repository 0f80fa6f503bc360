"""Small problems with known answers, in awkward units, and what the parts of an answer promise."""

import numpy as np
import pytest

from hysdel_py.analysis.milp import Milp, Status
from hysdel_py.analysis.search import Clock, Found, settle


def knapsack():
    """Three things of weight 2, 3, 4 and worth 3, 4, 6; room for 6."""
    problem = Milp()
    things = [problem.boolean() for _ in range(3)]
    problem.row(dict(zip(things, (2.0, 3.0, 4.0), strict=True)), high=6.0)
    return problem, dict(zip(things, (-3.0, -4.0, -6.0), strict=True))


def test_best_choice_and_its_bound():
    problem, cost = knapsack()
    answer = problem.search(cost)
    assert answer.status is Status.FOUND
    assert answer.is_optimal
    assert answer.w.round().tolist() == [1, 0, 1]
    assert answer.value == pytest.approx(-9)
    assert answer.bound == pytest.approx(-9)


def test_relaxed_is_not_worse():
    problem, cost = knapsack()
    problem.row(dict.fromkeys(cost, 1.0), high=1.5)
    assert problem.search(cost).value == pytest.approx(-6)
    assert problem.search(cost, relaxed=True).value == pytest.approx(-8)


def test_without_objective_any_point():
    problem, _ = knapsack()
    assert problem.search().status is Status.FOUND


def test_rows_of_ones_own():
    problem, cost = knapsack()
    assert problem.search(cost, rows=()).w.round().tolist() == [1, 1, 1]


@pytest.mark.parametrize("contradiction", [lambda p, x: p.row({x: 1.0}, 2.0, 1.0), lambda p, x: p.fix(x, 7.0),
                                           lambda p, x: p.row({}, low=1.0)])  # fmt: skip
def test_none(contradiction):
    problem = Milp()
    x = problem.real(0.0, 1.0)
    contradiction(problem, x)
    answer = problem.search()
    assert (answer.status, len(answer.w)) == (Status.NONE, 0)
    assert problem.refine(np.zeros(1)).status is Status.NONE


def test_without_variables():
    assert Milp().search().status is Status.FOUND
    assert settle(Milp(), {}, -1.0, lambda w: True, Clock()).found is Found.POINT
    assert settle(Milp(), {}, 0.0, lambda w: True, Clock()).found is Found.NONE
    impossible = Milp()
    impossible.row({}, low=1.0)
    assert impossible.search().status is impossible.refine(np.zeros(0)).status is Status.NONE


def test_bounds_that_cross():
    problem = Milp()
    problem.real(1.0, 0.0)
    assert problem.search().status is Status.NONE


def test_unbounded_is_unknown():
    problem = Milp()
    x = problem.real()
    assert problem.search({x: 1.0}).status is Status.UNKNOWN


def test_time_limit_is_unknown():
    problem, cost = knapsack()
    assert problem.search(cost, seconds=0.0).status is Status.UNKNOWN


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_units_do_not_matter(unit):
    """A violation of a thousandth of the range is seen in any unit."""
    problem = Milp()
    x, y = problem.real(0.0, 3.0 * unit), problem.real(-unit, unit)
    problem.row({x: 1.0, y: 1.0}, high=2.0 * unit)
    assert problem.search({x: -1.0}).value == pytest.approx(-3.0 * unit)
    problem.row({y: 1.0}, low=-0.999 * unit)
    assert problem.search({x: -1.0}).value == pytest.approx(-2.999 * unit, rel=1e-6)


def test_copy_is_independent():
    problem, cost = knapsack()
    more = problem.copy()
    more.fix(0, 0.0)
    more.real()
    assert (problem.n, len(problem.rows)) == (3, 1)
    assert more.search(cost).value == pytest.approx(-6.0)


def test_forbidden_words_run_out():
    problem = Milp()
    a, b = problem.boolean(), problem.boolean()
    problem.row({a: 1.0, b: 1.0}, high=1.0)
    words = []
    while (answer := problem.search()).status is Status.FOUND:
        words.append(tuple(answer.w.round().astype(int).tolist()))
        problem.forbid(answer.w)
    assert sorted(words) == [(0, 0), (0, 1), (1, 0)]


def test_refining_takes_the_tolerance_of_a_large_constant_out():
    """x <= M d with d = 1e-7 off allows x = 0.1 to the solver; with d fixed it does not."""
    problem = Milp()
    x, d = problem.real(0.0, 1e6), problem.boolean()
    problem.row({x: 1.0, d: -1e6}, high=0.0)
    fine = problem.refine(np.array([0.1, 1e-7]), {x: -1.0})
    assert fine.status is Status.FOUND
    assert fine.w[x] == pytest.approx(0.0, abs=1e-9)


# ---- searches that end in proof or point ---------------------------------------------------------------------------


def test_settled_by_proof_and_by_point():
    problem, cost = knapsack()
    worth = {i: -c for i, c in cost.items()}
    assert settle(problem, worth, 9.5, lambda w: True, Clock()).found is Found.NONE
    result = settle(problem, worth, 8.5, lambda w: True, Clock())
    assert (result.found, result.w.round().tolist()) == (Found.POINT, [1, 0, 1])
    assert len(problem.rows) == 1


def test_points_that_nobody_confirms_are_doubtful():
    problem, cost = knapsack()
    seen = []
    result = settle(problem, {i: -c for i, c in cost.items()}, 6.5, lambda w: bool(seen.append(w)), Clock())
    assert result.found is Found.DOUBTFUL
    assert sorted(w.round().tolist() for w in seen) == [[1, 0, 1], [1, 1, 0]]


def test_no_time_left_is_unsettled():
    problem, cost = knapsack()
    assert settle(problem, cost, 0.0, lambda w: True, Clock(0.0)).found is Found.UNSETTLED
