"""Bounds must hold for every point and every multiplier, and must be tight at a solution."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hysdel_py.optimize.backends.registry import get_backend
from hysdel_py.optimize.certificate import Certifier, dual_bound, farkas_bound, spare_curvature
from hysdel_py.optimize.qp import Qp, objective_value


def random_qp(rng, n=4, m=3, scale=1.0):
    """A feasible problem and one of its feasible points."""
    L, A = rng.normal(size=(n, rng.integers(0, n + 1))), rng.normal(size=(m, n)) * scale
    x = rng.uniform(-1, 1, n)
    at = A @ x
    l, u = at - rng.exponential(1, m), at + rng.exponential(1, m)  # noqa: E741
    l[rng.random(m) < 0.3], u[rng.random(m) < 0.3] = -np.inf, np.inf
    q = rng.normal(size=n) * scale
    return Qp(L @ L.T, q, A, l, u, x - rng.exponential(1, n), x + rng.exponential(1, n), rng.normal()), x


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-6, 6), st.floats(-3, 3))
def test_dual_bound_is_below_every_feasible_point(seed, size, scale):
    rng = np.random.default_rng(seed)
    qp, feasible = random_qp(rng, scale=10.0**scale)
    x, y = rng.normal(size=qp.n) * 10.0**size, rng.normal(size=qp.m) * 10.0**size
    assert dual_bound(qp, x, y) <= objective_value(qp, feasible)


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-6, 6))
def test_no_multiplier_refutes_a_feasible_problem(seed, size):
    rng = np.random.default_rng(seed)
    qp, _ = random_qp(rng)
    assert farkas_bound(qp, rng.normal(size=qp.m) * 10.0**size) <= 0


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3))
def test_curved_bound_holds_without_bounds_of_some_variables(seed, free):
    rng = np.random.default_rng(seed)
    qp, feasible = random_qp(rng)
    lb, ub = qp.lb.copy(), qp.ub.copy()
    lb[:free], ub[:free] = -np.inf, np.inf
    feasible[:free] = feasible[:free] + 0.0
    qp = qp.with_vectors(lb=lb, ub=ub)
    certifier = Certifier.of(qp, spare_curvature(qp, ~np.isfinite(lb)))
    bound = certifier.dual_bound(qp, rng.normal(size=qp.n), rng.normal(size=qp.m))
    assert bound <= objective_value(qp, feasible)


@pytest.mark.parametrize("seed", range(20))
def test_dual_bound_is_tight_at_a_solution(seed):
    qp, _ = random_qp(np.random.default_rng(seed))
    result = get_backend("piqp").workspace(qp).solve()
    assert dual_bound(qp, result.x, result.y) == pytest.approx(result.objective, abs=1e-6)


def test_free_variables_get_an_honest_answer():
    free = np.full(1, np.inf)
    linear = Qp([[0.0]], [1.0], np.zeros((0, 1)), [], [], -free, free)
    assert dual_bound(linear, np.zeros(1), np.zeros(0)) == -np.inf
    curved = Qp([[2.0]], [-4.0], np.zeros((0, 1)), [], [], -free, free)
    assert dual_bound(curved, np.full(1, 2.0 + 1e-7), np.zeros(0)) == -np.inf
    certifier = Certifier.of(curved, spare_curvature(curved, np.array([True])))
    assert certifier.dual_bound(curved, np.full(1, 2.0 + 1e-7), np.zeros(0)) == pytest.approx(-4.0, abs=1e-9)


def test_no_curvature_is_found_where_there_is_none():
    singular = Qp([[1.0, 1.0], [1.0, 1.0]], [0.0, 0.0], np.zeros((0, 2)), [], [], [-9, -9], [9, 9])
    assert spare_curvature(singular, np.array([True, False])) is None
    assert spare_curvature(singular, np.array([False, False])) is None


def test_multipliers_at_missing_sides_count_as_zero():
    qp = Qp([[0.0]], [1.0], [[1.0]], [-np.inf], [5.0], [-1.0], [1.0])
    assert dual_bound(qp, np.zeros(1), np.array([-7.0])) == pytest.approx(-1.0)


def test_values_that_are_not_finite_prove_nothing():
    qp = Qp([[1.0]], [1.0], [[1.0]], [0.0], [1.0], [-1.0], [1.0])
    assert dual_bound(qp, np.array([np.nan]), np.zeros(1)) == -np.inf
    assert farkas_bound(qp, np.array([np.inf])) == -np.inf


@pytest.mark.parametrize("gap", [1.0, 1e-3, 1e-6])
def test_a_ray_proves_a_gap_of_the_size_of_an_epsilon(gap):
    # x + y >= 1 + gap and x + y <= 1
    qp = Qp(np.zeros((2, 2)), [0.0, 0.0], [[1.0, 1.0], [1.0, 1.0]], [1 + gap, -np.inf], [np.inf, 1.0], [0, 0], [1, 1])
    assert farkas_bound(qp, np.array([-1.0, 1.0])) == pytest.approx(gap, rel=1e-6)
    assert farkas_bound(qp, np.array([1.0, 1.0])) <= 0
