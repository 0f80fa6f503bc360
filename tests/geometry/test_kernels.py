"""The kernels of the geometry against HiGHS, enumeration and closed forms, and themselves without a compiler."""

import itertools
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial import HalfspaceIntersection

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.geometry.cone import cone_of, points_and_ways
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.precision import DEFAULT_PRECISION
from hysdel_py.geometry.redundancy import irredundant_rows
from hysdel_py.geometry.small_programs import greatest_radius, greatest_values
from hysdel_py.geometry.solver import LpSolver

ROOT = Path(__file__).parents[2]
LEAST = DEFAULT_PRECISION.empty

seeds = st.integers(0, 10**6)
sizes = st.sampled_from([1e-6, 1e-3, 1.0, 1e3, 1e6])
compiled_only = pytest.mark.skipif(not kernels_are_compiled(), reason="Qhull answers where nothing is compiled")


def unit(rows):
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def drawn_program(seed, n, m, *, whole):
    """A linear program that may be infeasible, unbounded or degenerate; whole numbers make it degenerate."""
    rng = np.random.default_rng(seed)
    G = rng.integers(-2, 3, size=(m, n)).astype(float) if whole else rng.normal(size=(m, n))
    G = G[np.any(G != 0, axis=1)]
    h = rng.integers(-1, 4, size=len(G)).astype(float) if whole else rng.normal(size=len(G)) + rng.integers(3)
    c = rng.normal(size=n) * (rng.random(n) < 0.7)
    low = np.where(rng.random(n) < 0.3, -rng.random(n), -np.inf)
    high = np.where(rng.random(n) < 0.3, rng.random(n), np.inf)
    return c, G, h, low, high


@settings(max_examples=150, deadline=None)
@given(seeds, st.integers(1, 6), st.integers(0, 25), st.booleans())
def test_programs_have_the_status_and_the_value_of_highs(seed, n, m, whole):
    c, G, h, low, high = drawn_program(seed, n, m, whole=whole)
    found = greatest_values(c[None], G, h, low, high, tolerance=1e-9)
    rows = (G, h) if len(G) else (None, None)
    wanted = linprog(-c, *rows, bounds=np.column_stack([low, high]), method="highs-ds", options={"presolve": False})
    if found is None:
        return  # in doubt: another solver is asked
    assert found.is_feasible == (wanted.status != 2)
    if wanted.status == 3:
        assert found.values[0] == np.inf
    if wanted.status == 0:
        assert found.values[0] == pytest.approx(-wanted.fun, rel=1e-8, abs=1e-8)
        assert found.bounds[0] >= found.values[0] - 1e-12 * abs(found.values[0])
        assert np.all(G @ found.points[0] <= h + 1e-8)
        assert np.all(found.multipliers >= 0)


def test_programs_are_rarely_in_doubt():
    drawn = [drawn_program(seed, 1 + seed % 6, seed % 25, whole=seed % 2 == 0) for seed in range(300)]
    answers = [greatest_values(c[None], G, h, low, high, tolerance=1e-9) for c, G, h, low, high in drawn]
    assert sum(answer is None for answer in answers) <= 3


@settings(max_examples=50, deadline=None)
@given(seeds, st.integers(1, 4), st.integers(1, 12), sizes)
def test_radius_is_that_of_highs(seed, n, m, size):
    rng = np.random.default_rng(seed)
    A, b = rng.normal(size=(m, n)), (rng.normal(size=m) + 1) * size
    found = greatest_radius(A, b, 1e6, 1e-9)
    rows = np.column_stack([A, np.linalg.norm(A, axis=1)])
    bounds = [(None, None)] * n + [(-1e5, 1e5)]
    wanted = linprog(-np.eye(n + 1)[n], rows, b / size, bounds=bounds, method="highs-ds")
    if found is None:  # in doubt, which only balls without an end are; the solvers of old answer then
        assert -wanted.fun > 1e4
    elif -wanted.fun < 1e3 / max(size, 1.0):
        assert found[-1] == pytest.approx(-wanted.fun * size, rel=1e-6, abs=1e-8 * size)
        assert np.all(A @ found[:-1] + rows[:, -1] * found[-1] <= b + 1e-9 * max(size, 1.0))


def rays_by_enumeration(H):
    """Extreme rays of a pointed cone: the directions that d - 1 independent rows fix and all rows allow."""
    d, found = H.shape[1], []
    for rows in itertools.combinations(range(len(H)), d - 1):
        _, values, right = np.linalg.svd(H[list(rows)].reshape(d - 1, d))
        if d > 1 and values[-1] < 1e-9:
            continue
        for ray in (right[-1], -right[-1]):
            if np.all(H @ ray >= -1e-9) and not any(np.allclose(ray, other, atol=1e-7) for other in found):
                found.append(ray)
    return np.array(found).reshape(-1, d)


def same(found, wanted, tolerance=1e-7):
    """Whether two sets of points are the same."""
    if len(found) != len(wanted):
        return False
    apart = np.abs(found[:, None] - wanted[None]).max(axis=2, initial=0.0)
    return not len(found) or bool((apart.min(axis=0) <= tolerance).all() and (apart.min(axis=1) <= tolerance).all())


@settings(max_examples=100, deadline=None)
@given(seeds, st.integers(1, 5), st.integers(1, 11), st.booleans())
def test_extreme_rays_are_those_that_enumeration_finds(seed, d, m, whole):
    rng = np.random.default_rng(seed)
    H = rng.integers(-2, 3, size=(m, d)).astype(float) if whole else rng.normal(size=(m, d))
    H = np.vstack([H[np.any(H != 0, axis=1)], np.eye(d)[:1]])
    H = unit(H)
    cone = cone_of(H)
    assert cone is not None
    assert len(cone.lines) == d - np.linalg.matrix_rank(H)
    assert np.allclose(H @ cone.lines.T, 0.0, atol=1e-12)
    if not len(cone.lines):
        assert same(cone.rays, rays_by_enumeration(H))


@compiled_only
@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(2, 5), st.integers(0, 14), sizes, sizes)
def test_vertices_are_those_of_qhull_in_any_scale(seed, n, m, size, other):
    rng = np.random.default_rng(seed)
    A = np.vstack([unit(rng.normal(size=(m, n))), np.eye(n), -np.eye(n)])
    b = 0.5 + rng.random(len(A))
    scale = np.where(rng.random(n) < 0.5, size, other)
    found = Polyhedron(A / scale, b).vertices / scale
    wanted = HalfspaceIntersection(np.column_stack([A, -b]), np.zeros(n)).intersections
    assert same(found, np.unique(np.round(wanted, 9), axis=0), 1e-6)


@compiled_only
@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(1, 3), st.integers(1, 3), sizes)
def test_flat_sets_keep_their_vertices(seed, k, more, size):
    """A box of k dimensions, turned into a greater space: 2^k vertices."""
    rng, n = np.random.default_rng(seed), k + more
    frame = np.linalg.qr(rng.normal(size=(n, n)))[0]
    low, high = -size * (0.5 + rng.random(k)), size * (0.5 + rng.random(k))
    A = np.vstack([frame[:k], -frame[:k], frame[k:], -frame[k:]])
    flat = Polyhedron(A, np.concatenate([high, -low, np.zeros(2 * more)]))
    corners = np.array(list(itertools.product(*zip(low, high, strict=True)))) @ frame[:k]
    assert same(flat.vertices / size, corners / size)
    assert flat.volume == 0.0


@compiled_only
@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(1, 4), st.integers(1, 6), st.integers(0, 3))
def test_unbounded_sets_have_the_rays_of_their_recession_cone(seed, n, m, at):
    rng = np.random.default_rng(seed)
    A, b = unit(rng.normal(size=(m, n))), rng.random(m) * 10.0**at
    found = points_and_ways(A, b, np.zeros(n), LEAST)
    if found is None:
        return
    points, rays, lines, _ = found
    assert np.all(points @ A.T <= b + 1e-8 * 10.0**at)
    assert np.allclose(A @ lines.T, 0.0, atol=1e-9)
    if not len(lines):
        assert same(rays, rays_by_enumeration(-A))
        corners = [np.linalg.solve(A[list(rows)], b[list(rows)]) for rows in itertools.combinations(range(m), n)]
        assert same(points, np.array([w for w in corners if np.all(A @ w <= b + 1e-9)]).reshape(-1, n), 1e-6 * 10.0**at)


@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_cross_polytopes_and_boxes_are_dual(n):
    signs, axes = np.array(list(itertools.product([1.0, -1.0], repeat=n))), np.vstack([np.eye(n), -np.eye(n)])
    assert same(Polyhedron(signs, np.ones(2**n)).vertices, axes)
    assert same(Polyhedron(axes, np.ones(2 * n)).vertices, signs)
    hull = Polyhedron.hull(axes)
    assert same(hull.A / hull.b[:, None], signs)
    assert hull.volume == pytest.approx(2.0**n / np.prod(np.arange(1, n + 1)))


@pytest.mark.parametrize("sides", [3, 17, 60, 150])
def test_many_rows_through_one_vertex(sides):
    angle = 2 * np.pi * np.arange(sides) / sides
    walls = np.column_stack([np.cos(angle), np.sin(angle), np.ones(sides)])
    tent = Polyhedron(np.vstack([walls, [[0.0, 0.0, -1.0]]]), np.append(np.ones(sides), 0.0))
    assert len(tent.vertices) == sides + 1
    assert tent.volume == pytest.approx(sides * np.tan(np.pi / sides) / 3)
    assert tent.minimal().m == sides + 1
    cone = Polyhedron(walls, np.ones(sides)).generators
    assert (len(cone.points), len(cone.rays), len(cone.lines)) == (1, sides, 0)


@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(1, 4), st.integers(1, 14), st.booleans())
@example(1609, 3, 10, True)
def test_rows_that_are_needed_are_those_of_highs(seed, n, m, whole):
    rng = np.random.default_rng(seed)
    A = rng.integers(-2, 3, size=(m, n)).astype(float) if whole else rng.normal(size=(m, n))
    A = np.vstack([A, np.eye(n), -np.eye(n)])
    b = np.concatenate([0.5 + rng.integers(3, size=m) if whole else 0.3 + rng.random(m), np.full(2 * n, 1.25)])
    kept = list(irredundant_rows(A, b, np.zeros((1, n)), LpSolver()))
    for row in range(len(b)):
        rest = [i for i in kept if i != row]
        most = linprog(-A[row], A[rest], b[rest], bounds=[(None, None)] * n, method="highs-ds")
        # 0 is inside: no solution means no bound, whatever HiGHS calls it.
        cuts = most.fun is None or -most.fun > b[row] + 1e-8
        assert cuts == (row in kept)


@compiled_only
def test_signs_that_are_in_doubt_are_left_to_others():
    tip = np.array([[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0]])
    assert (
        points_and_ways(
            unit(tip), np.array([1, 1, 1, 1 + 3e-11, 0]) / np.linalg.norm(tip, axis=1), np.full(3, 0.1), LEAST
        )
        is None
    )
    assert cone_of(unit(np.array([[1.0, 0.0], [1.0, 1e-11]]))) is None


@pytest.mark.parametrize("ratio", [1e3, 1e6, 1e8])
def test_slanted_hulls_keep_their_thin_side(ratio):
    turn = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
    corners = np.array([[-ratio, -1.0], [-ratio, 1.0], [ratio, -1.0], [ratio, 1.0]]) @ turn
    hull = Polyhedron.hull(corners)
    excess = (corners @ hull.A.T - hull.b).max(axis=0)
    assert np.all(np.abs(excess) <= 1e-14 * ratio)
    assert hull.m == 4


_PROGRAM = """
import numpy as np
from hysdel_py.geometry.cone import cone_of
from hysdel_py.geometry.small_programs import greatest_values, needed_among
rng = np.random.default_rng(7)
for k in range(12):
    n = 1 + k % 3
    G, h = rng.normal(size=(6, n)), rng.random(6) + 0.1
    found = greatest_values(rng.normal(size=(2, n)), G, h, np.full(n, -9.0), np.full(n, 9.0), tolerance=1e-9)
    cone = cone_of(np.vstack([np.column_stack([h, -G]), np.eye(n + 1)[:1]]))
    print(np.round(found.values, 9) + 0.0)
    print(needed_among(G, h, np.zeros((1, n)), parallel=1e-12, margin=1e-9, tolerance=1e-9)[0])
    print(np.round(cone.rays, 9) + 0.0, cone.bits.ravel(), len(cone.lines))
"""


@compiled_only
def test_compiled_and_plain_kernels_say_the_same():
    plain = os.environ | {"PYTHONPATH": str(ROOT), "NUMBA_DISABLE_JIT": "1"}
    said = [
        subprocess.run([sys.executable, "-c", _PROGRAM], capture_output=True, text=True, check=True, env=env).stdout
        for env in (os.environ | {"PYTHONPATH": str(ROOT)}, plain)
    ]
    assert said[0] == said[1]
    assert said[0].count("\n") > 24
