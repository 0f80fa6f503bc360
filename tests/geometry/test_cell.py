"""Cells that are cut, rows that are needed, and the tree of tests."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from hysdel_py.geometry.cell import Cell
from hysdel_py.geometry.sampling import spread_points
from hysdel_py.geometry.search_tree import NOWHERE, SearchTree, SearchTreeBuilder
from hysdel_py.geometry.solver import LpSolver

GAP = 0.8
"""So wide that a side may be empty although the other one does not fill the cell."""


def unit_box(n):
    return Cell.box(-np.ones(n), np.ones(n), tuple(f"row {k}" for k in range(2 * n)))


def has_a_point(A, b):
    return linprog(np.zeros(A.shape[1]), A, b, bounds=[(None, None)] * A.shape[1], method="highs").status == 0


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(1, 7))
def test_cuts_leave_a_cell_exactly_if_a_point_is_left(seed, n, cuts):
    rng, solver = np.random.default_rng(seed), LpSolver()
    cell = unit_box(n)
    A, b = cell.A, cell.b
    for _ in range(cuts):
        a, side = rng.normal(size=n), rng.normal()
        A, b = np.vstack([A, a]), np.append(b, side)
        cell = cell.cut(a, side, "cut", solver)
        assert (cell is not None) == has_a_point(A, b)
        if cell is None:
            return
        assert not cell.is_flat
        for point in cell.points:
            assert np.all(b - A @ point >= -1e-12)


def test_one_coordinate_and_parallel_rows_need_no_program():
    solver = LpSolver()
    cell = unit_box(3).cut(np.array([1.0, 0.0, 0.0]), -0.5, "x <= -0.5", solver)
    assert cell.cut(np.array([-2.0, 0.0, 0.0]), 0.9, "x >= -0.45", solver) is None
    slab = unit_box(3).cut(np.array([1.0, 1.0, 0.0]), 0.25, "sum", solver)
    assert slab.cut(np.array([-2.0, -2.0, 0.0]), -0.5 - 1e-6, "beyond the gap", solver) is None
    assert slab.cut(np.array([3.0, 3.0, 0.0]), 0.9, "implied", solver) is slab
    assert solver.solved == 0


def test_what_only_touches_is_flat_and_what_a_gap_parts_is_empty():
    solver = LpSolver()
    corner = unit_box(2).cut(np.array([-1.0, -1.0]), -2.0, "corner", solver)
    assert corner.is_flat
    np.testing.assert_allclose(corner.points, [[1.0, 1.0]], atol=1e-9)
    assert unit_box(2).cut(np.array([-1.0, -1.0]), -2.0 - 1e-6, "beyond", solver) is None


def test_needed_rows_and_their_tags():
    solver = LpSolver()
    cell = unit_box(2).cut(np.array([1.0, 1.0]), 0.5, "diagonal", solver).cut(np.array([1.0, 0.1]), 1.05, "far", solver)
    assert cell.minimal(solver).tags == ("row 0", "row 1", "row 2", "row 3", "diagonal")
    assert cell.minimal(solver).minimal(solver).is_minimal


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(1, 3))
def test_split_gives_what_two_cuts_give(seed, n):
    rng, solver = np.random.default_rng(seed), LpSolver()
    cell = unit_box(n).cut(rng.normal(size=n), 0.3, "first", solver)
    a, c = rng.normal(size=n), 2 * rng.normal()
    low, high = cell.split(a, c, GAP, ("low", "high"), solver)
    for part, row, side in ((low, a, -c), (high, -a, c - GAP)):
        assert (part is None) == (not has_a_point(np.vstack([cell.A, row]), np.append(cell.b, side)))
    if high is None and low is cell:
        assert c - linprog(-a, cell.A, cell.b, bounds=[(None, None)] * n).fun <= 1e-9
    if low is None and high is cell:
        assert c + linprog(a, cell.A, cell.b, bounds=[(None, None)] * n).fun >= GAP - 1e-9


def test_infinite_ends():
    cell = Cell.box(np.array([0.0, -np.inf]), np.array([np.inf, 5.0]), ("a", "b", "c", "d"))
    assert cell.tags == ("b", "c")
    assert np.all(cell.points[:, 0] > 0)
    assert cell.cut(np.array([1.0, 0.0]), -1.0, "negative", LpSolver()) is None


def test_spread_points_fill_the_box():
    points = spread_points(64, 3)
    assert np.all((points > 0) & (points < 1))
    assert {tuple(p) for p in (points > 0.5).astype(int)} == {(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)}
    np.testing.assert_array_equal(points, spread_points(64, 3))


def chain():
    """Leaf 0 for w <= 0, leaf 1 for w >= 1e-3 up to 2, a dead end beyond."""
    builder = SearchTreeBuilder(1)
    low, high = builder.test(None, np.array([1.0]), 0.0, 1e-3)
    builder.leaf(low)
    below, above = builder.test(high, np.array([1.0]), -2.0, 0.0)
    builder.leaf(below)
    builder.dead_end(above)
    return builder.build()


@pytest.mark.parametrize(
    ("w", "leaf", "in_gap"), [(-1.0, 0, False), (5e-4, -1, True), (1.0, 1, False), (3.0, 2, False)]
)
def test_walk(w, leaf, in_gap):
    place = chain().locate([w])
    assert (place.leaf, place.in_gap) == (leaf, in_gap)


def test_walk_to_the_nearest_side_and_with_tolerance():
    tree = chain()
    assert (tree.size, tree.depth) == (2, 2)
    assert tree.locate([4e-4], nearest=True).leaf == 0
    assert tree.locate([6e-4], nearest=True).leaf == 1
    assert tree.locate([1e-10], absolute=1e-9).leaf == 0
    assert SearchTree(np.zeros((0, 1)), np.zeros(0), np.zeros(0), np.zeros((0, 2), int), NOWHERE).locate([0]).leaf == -1
