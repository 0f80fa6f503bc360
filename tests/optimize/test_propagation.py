"""Propagation must never lose a feasible point and must find what a hand would find."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.propagation import PropagationSettings, Propagator

INF = np.inf


def propagate(A, integers, lb, ub, l, u, changed=None):  # noqa: E741
    vectors = (np.array(v, dtype=float) for v in (lb, ub, l, u))
    return Propagator(np.array(A, dtype=float), np.array(integers, dtype=int)).propagate(*vectors, changed)


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_no_feasible_point_is_lost(seed):
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 7), rng.integers(1, 6)
    integers = np.flatnonzero(rng.random(n) < 0.5)
    A = rng.normal(size=(m, n)) * 10.0 ** rng.integers(-3, 4, size=(m, 1)) * (rng.random((m, n)) < 0.7)
    x = rng.normal(size=n) * 3
    x[integers] = np.round(x[integers])
    at = A @ x
    # rows that are exactly tight, and up to the rounding of the sum
    l = at - rng.choice([0.0, 1e-6, 1.0, INF], size=m)  # noqa: E741
    u = at + rng.choice([0.0, 1e-6, 1.0, INF], size=m)
    lb, ub = x - rng.choice([0.0, 1.0, INF], size=n), x + rng.choice([0.0, 1.0, INF], size=n)
    box = propagate(A, integers, lb, ub, l, u)
    assert box.conflict is None
    assert np.all(box.lb <= x)
    assert np.all(x <= box.ub)


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_an_increment_keeps_the_feasible_point_too(seed):
    rng = np.random.default_rng(seed)
    A, x = rng.normal(size=(4, 6)), np.concatenate([rng.integers(0, 2, 3), rng.uniform(-3, 3, 3)])
    l, u = A @ x - rng.exponential(0.3, 4), A @ x + rng.exponential(0.3, 4)  # noqa: E741
    lb, ub = np.array([0, 0, 0, -4, -4, -4.0]), np.array([1, 1, 1, 4, 4, 4.0])
    propagator = Propagator(A, np.arange(3))
    box = propagator.propagate(lb, ub, l, u)
    for k in range(3):
        low, high = box.lb.copy(), box.ub.copy()
        low[k] = high[k] = x[k]
        box = propagator.propagate(low, high, l, u, np.array([k]))
        assert box.conflict is None
        assert np.all(box.lb <= x)
        assert np.all(x <= box.ub)


def test_a_chain_of_rows_is_followed():
    # a >= 1, b = a + 1, c = b + 1
    box = propagate([[-1, 1, 0], [0, -1, 1]], [], [1, -9, -9], [2, 9, 9], [1, 1], [1, 1])
    np.testing.assert_allclose(box.lb, [1, 2, 3], atol=1e-6)
    np.testing.assert_allclose(box.ub, [2, 3, 4], atol=1e-6)


def test_integers_are_rounded_inwards():
    box = propagate([[2.0]], [0], [-9], [9], [-3], [5])
    assert (box.lb[0], box.ub[0]) == (-1.0, 2.0)


@pytest.mark.parametrize("decision", [0.0, 1.0])
def test_a_mode_follows_its_threshold(decision):
    # x <= (M + eps) d - eps and x >= M d - M with M = 2
    eps = 1e-6
    box = propagate([[1, -(2 + eps)], [1, -2]], [1], [-2, decision], [2, decision], [-INF, -2], [-eps, INF])
    expected = (-2.0, -eps) if decision == 0 else (0.0, 2.0)
    np.testing.assert_allclose((box.lb[0], box.ub[0]), expected, atol=1e-7)


def test_a_gap_of_epsilon_decides_the_binary():
    # x = 0 exactly, so that d = 0 (x <= -eps) is impossible
    eps = 1e-6
    box = propagate([[1, -(2 + eps)], [1, -2]], [1], [0, 0], [0, 1], [-INF, -2], [-eps, INF])
    assert (box.lb[1], box.conflict) == (1.0, None)


def test_a_gap_below_the_margin_decides_nothing():
    box = propagate(
        [[1.0, -1.0]],
        [],
        [0, 0],
        [0, 1],
        [
            1e-12,
        ],
        [
            1e-12,
        ],
    )
    assert box.conflict is None
    assert propagate([[1.0]], [], [0], [0], [1e-12], [1.0]).conflict is None
    assert propagate([[1.0]], [], [0], [0], [1e-6], [1.0]).conflict == 0


def test_rows_with_missing_bounds_still_bound_the_one_that_is_missing():
    box = propagate([[1.0, 1.0]], [], [-INF, 0], [INF, 1], [-INF], [3])
    assert box.lb[0] == -INF
    assert box.ub[0] == pytest.approx(3.0, abs=1e-6)


@pytest.mark.parametrize(
    ("A", "l", "u", "lb", "ub"),
    [
        ([[0.0, 0.0]], [1.0], [2.0], [0, 0], [1, 1]),
        ([[1.0, 1.0]], [2.0], [1.0], [0, 0], [1, 1]),
        ([[1.0, 1.0]], [2.5], [INF], [0, 0], [1, 1]),
        ([[1.0, 1.0]], [-INF], [INF], [2, 0], [1, 1]),
    ],
)
def test_conflicts_are_found(A, l, u, lb, ub):  # noqa: E741
    assert propagate(A, [], lb, ub, l, u).conflict is not None


def test_input_is_left_alone():
    lb, ub = np.zeros(1), np.full(1, 9.0)
    Propagator(np.ones((1, 1)), np.array([0])).propagate(lb, ub, np.zeros(1), np.full(1, 4.0))
    assert (lb[0], ub[0]) == (0.0, 9.0)


def test_settings_are_checked():
    with pytest.raises(ArgumentError, match="rounds is 0"):
        PropagationSettings(rounds=0)
