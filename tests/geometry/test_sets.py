"""Vertices, hulls, projections, sums, differences and unions, checked against points, supports and volumes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.relations import (
    are_equal,
    common_facet,
    includes,
    minkowski_sum,
    pontryagin_difference,
    share_boundary,
)
from hysdel_py.geometry.union import PolyhedralUnion, difference

seeds = st.integers(0, 10**6)


def random_polytope(rng, n, m, scale=1.0):
    A = rng.normal(size=(m, n))
    centre = rng.normal(size=n) * scale
    box = Polyhedron.box(centre - 3 * scale, centre + 3 * scale)
    return Polyhedron(np.vstack([A, box.A]), np.concatenate([A @ centre + rng.random(m) * scale, box.b]))


def support(polyhedron, direction):
    return polyhedron.maximise(direction).value


def directions(rng, n, count=12):
    return rng.normal(size=(count, n))


@settings(max_examples=25, deadline=None)
@given(seeds, st.integers(1, 5), st.integers(0, 8), st.sampled_from([1e-4, 1.0, 1e5]))
def test_hull_of_the_vertices_is_the_polytope(seed, n, m, scale):
    rng = np.random.default_rng(seed)
    p = random_polytope(rng, n, m, scale)
    found = p.generators
    assert found.is_bounded
    for d in directions(rng, n):
        assert np.max(found.points @ d) == pytest.approx(support(p, d), rel=1e-7, abs=1e-8 + 1e-7 * scale)
    again = Polyhedron.hull(found.points)
    assert are_equal(again, p, 1e-7 * max(scale, 1.0))
    assert again.m == p.minimal().m


@settings(max_examples=25, deadline=None)
@given(seeds, st.integers(1, 4), st.integers(1, 6), st.integers(0, 3), st.integers(0, 2))
def test_unbounded_and_flat_sets_survive_the_way_to_rows_and_back(seed, n, p, r, k):
    rng = np.random.default_rng(seed)
    points, rays, lines = (rng.integers(-3, 4, size=(count, n)).astype(float) for count in (p, r, k))
    hull = Polyhedron.hull(points, rays, lines)
    everything = np.vstack([points, points[0] + rays, points[0] + lines, points[0] - 10 * lines])
    assert all(hull.contains(w, 1e-7) for w in everything)
    found = hull.generators
    assert are_equal(Polyhedron.hull(found.points, found.rays, found.lines), hull, 1e-7)
    assert hull.dimension == np.linalg.matrix_rank(np.vstack([points - points[0], rays, lines]), 1e-9)
    assert found.is_bounded == hull.is_bounded == (not np.any(rays) and not np.any(lines))
    for d in directions(rng, n, 6):
        bounded = np.all(rays @ d <= 1e-9) and np.all(np.abs(lines @ d) <= 1e-9)
        assert support(hull, d) == (pytest.approx(np.max(points @ d), abs=1e-6) if bounded else np.inf)


@settings(max_examples=25, deadline=None)
@given(seeds, st.integers(2, 5), st.integers(1, 7), st.booleans())
def test_projection_is_the_hull_of_the_projected_vertices(seed, n, m, flat):
    rng = np.random.default_rng(seed)
    p = random_polytope(rng, n, m)
    if flat:
        row = rng.normal(size=n)
        p = p.with_rows([row, -row], np.array([1, -1]) * (row @ p.ball.centre))
    kept = rng.permutation(n)[: rng.integers(1, n)]
    shadow = p.project(kept.tolist())
    assert are_equal(shadow, Polyhedron.hull(p.vertices[:, kept]), 1e-6)


def test_projection_of_an_unbounded_set():
    wedge = Polyhedron([[1.0, -1.0, 0.0], [-1.0, 0.0, 1.0]], [0.0, 0.0])  # z <= x <= y
    assert wedge.project([0, 1]).m == 1
    assert wedge.project([1]).m == 0
    assert are_equal(wedge.project([2, 1]), Polyhedron([[1.0, -1.0]], [0.0]))


@settings(max_examples=15, deadline=None)
@given(seeds, st.integers(1, 6), st.integers(0, 5))
def test_support_of_a_sum_is_the_sum_of_supports(seed, n, m):
    rng = np.random.default_rng(seed)
    p, q = random_polytope(rng, n, m), random_polytope(rng, n, 1)
    if n > 4:
        p, q = Polyhedron.box(-rng.random(n), rng.random(n)), Polyhedron.box(-rng.random(n), rng.random(n))
    total = minkowski_sum(p, q)
    for d in np.vstack([directions(rng, n, 6), total.A]):
        assert support(total, d) == pytest.approx(support(p, d) + support(q, d), rel=1e-6, abs=1e-6)


@settings(max_examples=15, deadline=None)
@given(seeds, st.integers(1, 4), st.integers(0, 6))
def test_difference_of_a_sum_gives_the_set_back(seed, n, m):
    rng = np.random.default_rng(seed)
    p, q = random_polytope(rng, n, m), random_polytope(rng, n, 2)
    assert are_equal(pontryagin_difference(minkowski_sum(p, q), q), p, 1e-6)


def test_pontryagin_difference_with_an_unbounded_set_is_empty():
    assert pontryagin_difference(Polyhedron.box([0, 0], [1, 1]), Polyhedron([[1.0, 0.0]], [0.0])).is_empty


@settings(max_examples=15, deadline=None)
@given(seeds, st.integers(1, 4))
def test_image_and_preimage_belong_together(seed, n):
    rng = np.random.default_rng(seed)
    p = random_polytope(rng, n, 3)
    M, t = rng.normal(size=(rng.integers(1, n + 2), n)), rng.normal()
    image = p.image(M, t)
    for d in directions(rng, len(M), 6):
        assert support(image, d) == pytest.approx(support(p, M.T @ d) + t * d.sum(), rel=1e-6, abs=1e-6)
    assert includes(image.preimage(M, t), p, 1e-6)


@settings(max_examples=10, deadline=None)
@given(seeds, st.integers(1, 3), st.integers(1, 3))
def test_volumes_of_a_difference_add_up(seed, n, count):
    rng = np.random.default_rng(seed)
    p, others = random_polytope(rng, n, 2), [random_polytope(rng, n, 2) for _ in range(count)]
    left = difference(p, others)
    taken = PolyhedralUnion(tuple(p & other for other in others))
    assert sum(part.volume for part in left) + taken.volume == pytest.approx(p.volume, rel=1e-6)
    for i, part in enumerate(left):
        assert all((part & other).dimension < n for other in (*left[i + 1 :], *others))
    for w in rng.uniform(-4, 4, size=(50, n)):
        inside = p.contains(w) and not any(other.contains(w) for other in others)
        assert inside <= any(part.contains(w, 1e-7) for part in left)


@settings(max_examples=15, deadline=None)
@given(seeds, st.integers(1, 3))
def test_pieces_of_a_polytope_are_merged_again(seed, n):
    rng = np.random.default_rng(seed)
    p = random_polytope(rng, n, 2)
    row = rng.normal(size=n)
    side = row @ p.ball.centre
    pieces = PolyhedralUnion((p.with_rows(row, side), p.with_rows(-row, -side)))
    assert pieces.is_convex
    assert pieces.is_connected
    joined = pieces.merged().parts
    assert len(joined) == 1
    assert are_equal(joined[0], p, 1e-6)


def test_union_that_is_not_convex():
    corner = PolyhedralUnion((Polyhedron.box([0, 0], [2, 1]), Polyhedron.box([0, 0], [1, 2])))
    assert not corner.is_convex
    assert corner.volume == pytest.approx(3)
    assert corner.covers(Polyhedron.box([0, 0], [1.9, 0.9]))
    assert not corner.covers(Polyhedron.box([0, 0], [1.1, 1.1]))
    assert len(corner.merged().parts) == 2
    assert len(PolyhedralUnion((*corner.parts, Polyhedron.box([0, 0], [1, 1]))).reduced().parts) == 2


@pytest.mark.parametrize(
    ("low", "high", "dimension"), [([0, 0], [0, 0], 0), ([0, 0], [0, 1], 1), ([0, 0], [1, 1], 2), ([1, 0], [0, 1], -1)]
)
def test_dimension(low, high, dimension):
    box = Polyhedron.box(low, high)
    assert box.dimension == dimension
    assert len(box.vertices) == (0 if dimension < 0 else 2**dimension)


def test_long_thin_box_keeps_its_corners():
    box = Polyhedron.box([0, 0, 0], [1e-5, 1.0, 1e6])
    np.testing.assert_allclose(np.unique(box.vertices[:, 0]), [0, 1e-5], atol=1e-15)
    assert box.volume == pytest.approx(10.0)


def test_facets_and_neighbours():
    left, right = Polyhedron.box([0, 0], [1, 1]), Polyhedron.box([1, 0], [2, 1])
    assert common_facet(left, right) == (0, 2)
    assert common_facet(left, Polyhedron.box([1, 0.5], [2, 1])) is None
    assert share_boundary(left, Polyhedron.box([1, 0.5], [2, 1]))
    assert not share_boundary(left, Polyhedron.box([1, 1], [2, 2]))
    assert left.facet(0).relative_ball.radius == pytest.approx(0.5)


def test_wrong_arguments_say_what_was_expected():
    box = Polyhedron.box([0, 0], [1, 1])
    with pytest.raises(ArgumentError, match="numbered from 0 to 1"):
        box.project([2])
    with pytest.raises(ArgumentError, match="kept once"):
        box.project([0, 0])
    with pytest.raises(ArgumentError, match="use generators"):
        _ = Polyhedron([[1.0, 0.0]], [1.0]).vertices
    with pytest.raises(ArgumentError, match="at least one point"):
        Polyhedron.hull(np.zeros((0, 2)))
    with pytest.raises(ArgumentError, match="same number of coordinates"):
        minkowski_sum(box, Polyhedron.box([0], [1]))
    with pytest.raises(ArgumentError, match="2 columns"):
        box.image(np.eye(3))
    with pytest.raises(ArgumentError, match="at least one polyhedron"):
        PolyhedralUnion(())
