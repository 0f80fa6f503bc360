"""Factor, nearest point and facets against what they are defined by."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.parametric import vectors
from hysdel_py.optimize.parametric.cover import uncovered_point
from hysdel_py.optimize.parametric.facets import facets, inner_point, same_rows
from hysdel_py.optimize.parametric.factor import append, factor, remove
from hysdel_py.optimize.parametric.frontier import Frontier
from hysdel_py.optimize.parametric.nearest import FOUND, NONE, nearest
from hysdel_py.optimize.parametric.settings import MpQpSettings
from hysdel_py.optimize.parametric.vectors import solve_lower, solve_upper

SEEDS = st.integers(0, 10_000)


def polytope(seed, n=3, m=9):
    rng = np.random.default_rng(seed)
    N = rng.normal(size=(m, n))
    N /= np.linalg.norm(N, axis=1)[:, None]
    return N, rng.uniform(-0.3, 1.0, m), rng.normal(size=n) * 3


@settings(max_examples=30, deadline=None)
@given(SEEDS)
def test_the_factor_follows_rows_that_come_and_go(seed):
    rng = np.random.default_rng(seed)
    n = 5
    Qt, R, rows = np.eye(n), np.zeros((n, n)), []
    for _ in range(12):
        if rows and (len(rows) == n or rng.random() < 0.4):
            leaving = int(rng.integers(len(rows)))
            remove(Qt, R, len(rows), leaving)
            del rows[leaving]
        else:
            row = rng.normal(size=n)
            append(Qt, R, len(rows), Qt @ row)
            rows.append(row)
        k = len(rows)
        assert np.allclose(Qt @ Qt.T, np.eye(n))
        assert np.allclose(Qt[:k].T @ np.triu(R[:k, :k]), np.array(rows).reshape(k, n).T)


def test_the_factor_stops_at_a_dependent_row():
    rows = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    assert factor(rows, 1e-9)[2] == 2
    assert factor(rows[[0, 1, 3]], 1e-9)[2] == 3


def test_triangular_systems():
    R = np.triu(np.random.default_rng(0).normal(size=(4, 4))) + 3 * np.eye(4)
    right = np.ones((4, 2))
    upper, lower = right.copy(), right.copy()
    solve_upper(R, 4, upper)
    solve_lower(R, 4, lower)
    assert np.allclose(R @ upper, right)
    assert np.allclose(R.T @ lower, right)


@settings(max_examples=60, deadline=None)
@given(SEEDS)
def test_the_nearest_point_is_optimal_or_proven_not_to_exist(seed):
    N, h, centre = polytope(seed)
    status, x, active, u = nearest(N, h, centre, 1e-11, 1e-10)
    if status == FOUND:
        assert np.all(N @ x <= h + 1e-9)
        assert np.all(u >= 0)
        assert np.allclose(N[active] @ x, h[active])
        assert np.allclose(x - centre + N[active].T @ u, 0)
    else:
        assert status == NONE
        assert np.all(u >= 0)
        assert np.allclose(N[active].T @ u, 0, atol=1e-8)
        assert u @ h[active] < 0


def test_both_answers_of_the_nearest_point_occur():
    found = {nearest(*polytope(seed), 1e-11, 1e-10)[0] for seed in range(40)}
    assert found == {FOUND, NONE}


def test_nearly_parallel_rows_are_told_apart():
    angle = 1e-8
    N = np.array([[1.0, 0.0], [-np.cos(angle), np.sin(angle)]])
    status, x, active, _ = nearest(N, np.zeros(2), np.array([0.5, 1.0]), 1e-13, 1e-10)
    assert status == FOUND
    assert len(active) == 2
    assert np.allclose(x, 0, atol=1e-6)


@settings(max_examples=40, deadline=None)
@given(SEEDS)
def test_facets_are_the_irredundant_rows(seed):
    N, h, _ = polytope(seed, m=12)
    h = np.abs(h) + 0.2
    N, h = np.vstack([N, np.eye(3), -np.eye(3)]), np.concatenate([h, np.full(6, 2.0)])
    status, centre = inner_point(N, h, np.zeros(3), np.array([1e-2, 1e-9]), 1e-11, 1e-10)
    is_facet, points, lost = facets(N, h, centre, 1e-9, 1e-11, 1e-10)
    assert status == FOUND
    assert lost == 0
    assert tuple(np.flatnonzero(is_facet)) == Polyhedron(N, h).irredundant_rows()
    for row in np.flatnonzero(is_facet):
        assert N[row] @ points[row] == pytest.approx(h[row])
        assert np.delete(h - N @ points[row], row).min() > 0


def test_same_rows_point_at_the_first():
    N = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 0.0]])
    assert same_rows(N, np.array([1.0, 1.0, 1.0, 2.0]), 1e-9).tolist() == [0, 1, 0, 3]


def test_an_uncovered_point_is_found_and_a_cover_is_recognised():
    eye = np.vstack([np.eye(2), -np.eye(2)])
    square = eye, np.ones(4)
    left, right = (eye, np.array([0.0, 1.0, 1.0, 1.0])), (eye, np.array([1.0, 1.0, 0.0, 1.0]))
    chosen = MpQpSettings()
    assert uncovered_point(square, [left, right], 1e-7, chosen) is None
    point = uncovered_point(square, [left], 1e-7, chosen)
    assert point is not None
    assert 0 < point[0] < 1


def steps(rng):
    """Arguments of every innermost step."""
    n, m, k = 4, 9, 2
    N, h, a, d = rng.normal(size=(m, n)), rng.uniform(0.1, 1, m), rng.normal(size=n), rng.normal(size=n + 1)
    R, square, many = np.triu(rng.normal(size=(n, n))) + 3 * np.eye(n), rng.normal(size=(n, n)), rng.normal(size=(n, 3))
    lines, twice = rng.normal(size=(m, n + 2)), np.vstack([N[0], N[0] + 1e-3, N[1]])
    return {
        "worst_row": (N, h, m - 1, a),
        "turned": (square, a, k, d),
        "back_substituted": (R, d, k, np.zeros(n)),
        "move": (a, square, d, k, 0.7),
        "reflect": (square, d, k, 0.3),
        "rotate": (square, 1, k, n, 0.6, 0.8),
        "first_hit": (N, h, m - 1, a, 1e-9, np.zeros(m)),
        "solve_upper": (R, n, many),
        "solve_lower": (R, n, many),
        "blend": (N, lines, np.zeros((n, n + 2)), -1.0),
        "differs": (twice, 0, int(rng.integers(1, 3)), 1e-2),
        "greatest": (N,),
        "row_lengths": (lines, n),
    }


@settings(max_examples=25, deadline=None)
@given(SEEDS)
def test_loops_and_arrays_mean_the_same(seed):
    for name, arguments in steps(np.random.default_rng(seed)).items():
        ends = []
        for form in ("loops", "arrays"):
            own = [np.array(a) if isinstance(a, np.ndarray) else a for a in arguments]
            answer = getattr(vectors, f"_{name}_{form}")(*own)
            ends.append([np.zeros(1) if answer is None else answer, *own])
        for one, other in zip(*ends, strict=True):
            assert np.allclose(one, other), name


def test_every_step_has_both_forms():
    forms = {name[1:-6] for name in vars(vectors) if name.endswith("_loops")}
    assert forms == set(steps(np.random.default_rng(0))) == {name[1:-7] for name in vars(vectors) if "_arrays" in name}


def test_the_frontier_keeps_every_set_once_and_in_order():
    rng = np.random.default_rng(0)
    frontier, numbers = Frontier.empty(3, 2), {}
    for _ in range(20):
        sets = np.sort(rng.integers(0, 9, (40, 3)), axis=1)
        found = frontier.add(sets, rng.normal(size=(40, 2)))
        expected = [numbers.setdefault(tuple(row), len(numbers)) for row in sets.tolist()]
        assert found.tolist() == expected
    assert frontier.count == len(numbers) > 64
    assert [tuple(row) for row in frontier.sets[: frontier.count].tolist()] == list(numbers)
    assert frontier.row((4, 7)).tolist() == [4, 7, -1]
