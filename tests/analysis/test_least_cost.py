"""The least sum of squares over mixed-integer rows, against a search through all points of a grid."""

from itertools import product

import numpy as np
import pytest

from hysdel_py.analysis.consistency import Clock
from hysdel_py.analysis.least_cost import Squares, least_value
from hysdel_py.analysis.milp import Milp

GRID = np.linspace(-1.0, 1.0, 81)


def problem_of(rng):
    """Two reals in [-1, 1] and two Booleans under two random rows that the origin keeps."""
    problem = Milp()
    places = [problem.real(-1.0, 1.0), problem.real(-1.0, 1.0), problem.boolean(), problem.boolean()]
    A, b = rng.normal(size=(2, 4)), rng.uniform(0.1, 1.0, 2)
    for row, side in zip(A, b, strict=True):
        problem.row(dict(zip(places, row, strict=True)), high=float(side))
    return problem, places, A, b


def by_grid(A, b, Q, r):
    x, y = np.meshgrid(GRID, GRID)
    best = np.inf
    for word in product((0.0, 1.0), repeat=2):
        points = np.column_stack([x.ravel(), y.ravel(), *(np.full(x.size, value) for value in word)])
        kept = points[np.all(points @ A.T <= b + 1e-12, axis=1)]
        away = kept - r
        best = min(best, np.einsum("ki,ij,kj->k", away, Q, away).min(initial=np.inf))
    return best


@pytest.mark.parametrize("seed", range(6))
def test_the_bound_is_the_least_value(seed):
    rng = np.random.default_rng(seed)
    problem, places, A, b = problem_of(rng)
    root, r = rng.normal(size=(2, 4)), rng.normal(size=4) * 2
    Q = root.T @ root
    least = least_value(problem, [(Squares((("x", "a"),) * 4, Q, r), places)], Clock(60.0))
    found = by_grid(A, b, Q, r)
    slope = 2 * np.linalg.norm(Q, 2) * np.linalg.norm(np.abs(r) + 1.0)
    assert least.bound <= found + 1e-9
    assert least.bound >= found - slope * (GRID[1] - GRID[0])
    assert np.all(A @ least.w[places] <= b + 1e-6)


def test_without_integers_the_value_of_the_linear_program_bounds():
    problem = Milp()
    place = problem.real(1.0, 3.0)
    squares = Squares((("x", "v"),), np.array([[4.0]]), np.array([-2.0]))
    assert least_value(problem, [(squares, [place])], Clock(60.0)).bound == pytest.approx(36.0, rel=1e-4)


def test_without_a_point_the_bound_is_infinite():
    problem = Milp()
    place = problem.real(1.0, 3.0)
    problem.row({place: 1.0}, high=0.0)
    squares = Squares((("x", "v"),), np.eye(1), np.zeros(1))
    assert least_value(problem, [(squares, [place])], Clock(60.0)).bound == np.inf


def test_no_weight_costs_nothing():
    problem = Milp()
    problem.real(1.0, 3.0)
    assert least_value(problem, [(Squares((), np.zeros((0, 0)), np.zeros(0)), [])], Clock(60.0)).bound == 0.0
