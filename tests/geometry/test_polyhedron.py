"""Polyhedra against HiGHS, vertices of boxes and cross-polytopes, and points."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.lp import Lp, LpStatus, maximise, proven_bound
from hysdel_py.geometry.polyhedron import Polyhedron


def random_polytope(rng, n, m, *, scale=1.0):
    A = rng.normal(size=(m, n)) * scale
    centre = rng.normal(size=n)
    b = A @ centre + rng.random(m) * np.linalg.norm(A, axis=1)
    box = Polyhedron.box(centre - 5, centre + 5)
    return Polyhedron(np.vstack([A, box.A]), np.concatenate([b, box.b]))


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(1, 25), st.sampled_from([1e-3, 1.0, 1e4]))
def test_maximise_agrees_with_highs(seed, n, m, scale):
    rng = np.random.default_rng(seed)
    p = random_polytope(rng, n, m, scale=scale)
    c = rng.normal(size=n)
    answer = p.maximise(c)
    expected = linprog(-c, p.A, p.b, bounds=[(None, None)] * n, method="highs")
    assert answer.is_optimal
    np.testing.assert_allclose(answer.value, -expected.fun, rtol=1e-7, atol=1e-7)
    assert answer.bound >= -expected.fun - 1e-9 * (1 + abs(expected.fun))
    assert p.contains(answer.w, 1e-8)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(1, 14))
def test_minimal_is_the_same_set_and_needs_every_row(seed, n, m):
    rng = np.random.default_rng(seed)
    p = random_polytope(rng, n, m)
    kept = p.irredundant_rows()
    q = p.minimal()
    for row in range(p.m):
        assert q.maximise(p.A[row]).value <= p.b[row] + 1e-7 * p.lengths[row]
    for row in range(q.m):
        rest = [r for r in range(q.m) if r != row]
        without = Polyhedron(q.A[rest], q.b[rest]).maximise(q.A[row])
        assert without.status is LpStatus.UNBOUNDED or without.value > q.b[row] + 1e-10
    assert list(kept) == sorted(set(kept))


def test_repeated_rows_are_kept_once():
    p = Polyhedron([[1.0], [2.0], [-1.0], [1.0], [0.0]], [1.0, 2.0, 0.0, 3.0, 4.0])
    assert p.irredundant_rows() == (0, 2)


@pytest.mark.parametrize(("gap", "empty", "flat"), [(0.0, False, True), (1e-6, True, False), (-1e-3, False, False)])
def test_gap_of_a_threshold_is_seen(gap, empty, flat):
    p = Polyhedron([[1.0, 2.0], [-1.0, -2.0]], [1.0, -1.0 - gap])
    assert p.is_empty is empty
    assert p.is_flat is flat


def test_ball_of_a_box_and_of_a_half_space():
    assert Polyhedron.box([0, 0], [4, 2]).ball.radius == pytest.approx(1.0)
    assert Polyhedron([[1.0, 0.0]], [3.0]).ball.radius > 1e3
    assert Polyhedron([[0.0]], [-1.0]).is_empty
    assert Polyhedron(np.zeros((0, 2)), np.zeros(0)).ball.radius > 1e3


def test_bounding_box():
    cross = Polyhedron([[1, 1], [1, -1], [-1, 1], [-1, -1]], [1, 1, 1, 1])
    low, high = cross.bounding_box
    np.testing.assert_allclose(low, [-1, -1], atol=1e-8)
    np.testing.assert_allclose(high, [1, 1], atol=1e-8)
    low, high = Polyhedron([[1.0, 0.0]], [3.0]).bounding_box
    assert (high[0], high[1], low[0]) == (pytest.approx(3.0), np.inf, -np.inf)


def test_infeasible_unbounded_and_crossed_bounds():
    A, b = np.array([[1.0], [-1.0]]), np.array([0.0, -1.0])
    assert maximise([1.0], A, b, [-np.inf], [np.inf]).status is LpStatus.INFEASIBLE
    assert maximise([-1.0], A[:1], b[:1], [-np.inf], [np.inf]).status is LpStatus.UNBOUNDED
    assert maximise([1.0], A[:1], b[:1], [2.0], [1.0]).status is LpStatus.INFEASIBLE
    assert maximise([1.0], A[:1], [np.inf], [0.0], [7.0]).value == pytest.approx(7.0)


@given(st.lists(st.floats(-5, 5), min_size=2, max_size=2))
def test_bound_holds_for_any_multipliers(y):
    A, b = np.array([[1.0, 1.0], [1.0, -1.0]]), np.array([1.0, 0.5])
    c, low, high = np.array([1.0, 0.3]), np.zeros(2), np.ones(2)
    best = maximise(c, A, b, low, high).value
    assert proven_bound(Lp(c, A, b, low, high), np.array(y)) >= best - 1e-9


def test_wrong_shapes_are_named():
    with pytest.raises(ArgumentError, match=r"A has shape \(1, 2\) and b \(2,\)"):
        Polyhedron([[1.0, 0.0]], [1.0, 2.0])


def test_a_ray_that_vanishes_in_a_shadow_leaves_no_direction():
    """What rounding leaves of the third coordinate's ray would point up, where the second row ends the shadow."""
    A = [[-1.0, -3.0, -3.0], [0.0, -2.0, 0.0], [-1.0, -3.0, 0.0], [2.0, -1.0, -3.0]]
    tall = Polyhedron(np.array(A), np.array([600002.0, 200001.0, 300000.0, 400001.0]))
    assert tall.project([0, 1]).maximise([0.0, -1.0]).value == pytest.approx(100000.5)
    assert tall.project([0, 1]).maximise([-1.0, -3.0]).value == pytest.approx(300000.0)


@pytest.mark.parametrize("far", [0.0, 1e3, 1e5])
def test_hull_of_flat_points_far_away(far):
    """Rounding of the far coordinate is no thickness: the sides of the flat set are told too."""
    A = np.array([[0, 0, 3], [2, -2, 3], [0, -2, 3], [-2, -3, -2], [2, 3, 2.0]])
    flat = Polyhedron(A, np.array([0.0, 3, 0, 0, 0]) - far * A[:, 2]) & Polyhedron.box(
        [-2, -2, -1 - far], [1, 1, 3 - far]
    )
    hull = Polyhedron.hull(flat.vertices)
    assert hull.is_flat
    assert hull.dimension == 2
    for direction in np.vstack([np.eye(3), -np.eye(3)]):
        value = hull.maximise(direction).value
        assert value == pytest.approx((flat.vertices @ direction).max(), abs=1e-6)


@pytest.mark.parametrize("size", [1e5, 1e3])
def test_a_set_is_not_empty_for_its_large_coordinate(size):
    """The coefficients of the large coordinate are below what solvers take for zero."""
    sizes = np.array([size, 1e-5, 1e-3])
    corners = np.array([[x, x**2, x**3] for x in (1.0, 2.0, 3.0, 4.0)])
    small = Polyhedron.hull(corners)
    p = Polyhedron(small.A / sizes, small.b).normalised()
    assert not p.is_empty
    assert p.ball.radius > 1e-7
    for direction in (*np.eye(3), *-np.eye(3)):
        assert p.maximise(direction / sizes).value == pytest.approx((corners @ direction).max(), rel=1e-5)


def test_a_program_with_points_is_not_infeasible_for_small_coefficients():
    """Rows of unit length have coefficients of 1e-10 for a coordinate of size 1e5: over its size they count."""
    sizes = np.array([1e5, 1e-5, 1e3])
    rows = np.array([[0, -3, 3], [0, 3, -1], [3, -3, -2], [3, 3, -2], [1, 0, -1], [0, 0, 0.0]])
    plain = Polyhedron(rows, np.array([1.0, 4, 4, 1, 2, 1])) & Polyhedron.box([-1, -1, -2], [1, 1, 3])
    lengths = np.linalg.norm(plain.A / sizes, axis=1)
    lengths[lengths == 0] = 1.0
    p = Polyhedron(plain.A / sizes / lengths[:, None], plain.b / lengths)
    for direction in (*np.eye(3), *-np.eye(3)):
        assert p.maximise(direction / sizes).value == pytest.approx(plain.maximise(direction).value, abs=1e-3)


def test_hull_that_rows_can_not_tell_is_refused():
    # The rows of this triangle are those of its thin coordinate alone, up to 1e-10.
    corners = np.array([[-93700.0, -5.17e-6], [41300.0, -2.39e-6], [29800.0, -3.93e-6]])
    with pytest.raises(ArgumentError, match="scale the coordinates"):
        Polyhedron.hull(corners)
    scaled = Polyhedron.hull(corners * [1e-5, 1e5])
    assert len(scaled.vertices) == 3


@pytest.mark.parametrize("sizes", [(1e-5, 1.0, 1e6), (1e-3, 1e5), (1e-6, 1.0)])
def test_hull_of_points_of_very_different_sizes(sizes):
    corners = np.array(list(itertools.product(*[(0.0, size) for size in sizes])))
    found = Polyhedron.hull(corners)
    assert found.m == 2 * len(sizes)
    low, high = found.bounding_box
    assert np.allclose(low / sizes, 0.0, atol=1e-6)
    assert np.allclose(high / sizes, 1.0, atol=1e-6)
