"""Narrowing by the cost and probing: no point is lost that a search may not lose, against points found elsewhere."""

import numpy as np
import pytest
from pwa_enumeration import random_problem
from scipy.optimize import Bounds, LinearConstraint, milp

import hysdel_py as hys
from hysdel_py.optimize.binary_squares import without_binary_squares
from hysdel_py.optimize.certificate import diagonal_curvature
from hysdel_py.optimize.kernels.cutoff import narrow_by_cost, where_below
from hysdel_py.optimize.kernels.probing import probe
from hysdel_py.optimize.kernels.propagation import propagate
from hysdel_py.optimize.miqp import MiqpSettings, MiqpSolver, MiqpStatus, solve_miqp
from hysdel_py.optimize.mixed_integer import Miqp
from hysdel_py.optimize.qp import Qp, objective_value

TOLERANCE = 1e-6
"""Of HiGHS for rows and binaries."""


def kernel_data(miqp):
    """What the kernels are told of a problem, their settings of propagation, and the propagated box."""
    solver = MiqpSolver(miqp, MiqpSettings(backend="dense", gap_abs=1e-5, gap_rel=1e-4))
    data, settings = solver.workspace.data(miqp.qp, None), solver.workspace.settings[2]
    box = data[3][0].copy(), data[3][1].copy()
    sides, queued = (data[0][3], data[0][4]), np.ones(miqp.qp.m, dtype=bool)
    conflict, _ = propagate(data[0][2], data[2], data[0][5], box, sides, queued, settings)
    return data, settings, box, conflict < 0


def corners(miqp, count, seed):
    """Integer points of a problem from HiGHS, each least in a random direction."""
    qp, rng = miqp.qp, np.random.default_rng(seed)
    kinds = np.zeros(qp.n)
    kinds[miqp.binaries] = 1
    for _ in range(count):
        found = milp(
            rng.normal(size=qp.n), integrality=kinds, bounds=Bounds(qp.lb, qp.ub),
            constraints=LinearConstraint(qp.A, qp.l, qp.u),
        )  # fmt: skip
        if found.x is not None:
            yield found.x


def is_inside(box, x):
    return (x >= box[0] - TOLERANCE * (1 + abs(x))).all() and (x <= box[1] + TOLERANCE * (1 + abs(x))).all()


def hybrid_problem(seed):
    problem = random_problem(seed, 2)
    return problem.controller().problem(problem.x0)


def curved(seed, n=5):
    """A problem with curvature in some variables, rows that leave room, and no binaries."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(2, n)) * (rng.random(n) < 0.5)
    P = np.diag(rng.choice([0.0, 1.0, 30.0], n)) + root.T @ root
    A = rng.normal(size=(4, n))
    middle = A @ rng.uniform(-1, 1, n)
    return Miqp(Qp(P, rng.normal(size=n), A, middle - 1, middle + 1, np.full(n, -2.0), np.full(n, 2.0)), [])


@pytest.mark.parametrize("seed", range(30))
def test_no_point_below_the_cutoff_is_cut_off(seed):
    miqp = curved(seed)
    rng = np.random.default_rng(seed)
    best = solve_miqp(miqp, MiqpSettings(backend="piqp"))
    assert best.status is MiqpStatus.OPTIMAL
    qp = miqp.qp
    points = best.x + rng.normal(size=(400, qp.n)) * rng.choice([0.01, 0.1, 1.0], (400, 1))
    fits = [x for x in points if (abs(x) <= 2).all() and (qp.A @ x <= qp.u).all() and (qp.A @ x >= qp.l).all()]
    for _ in range(4):
        data, settings, box, _ = kernel_data(miqp)
        x = best.x + rng.normal(size=qp.n) * rng.choice([0.0, 0.1])  # the bound holds for any point and multipliers
        y = rng.normal(size=qp.m) * rng.choice([0.0, 0.1])
        cutoff = best.objective + rng.choice([0.05, 0.5, 3.0])
        bound, _, left = narrow_by_cost(data, box, x, y, cutoff, settings)
        assert bound <= best.objective + 1e-7
        assert left
        assert all(is_inside(box, w) for w in fits if objective_value(qp, w) < cutoff)
        assert is_inside(box, best.x)
    assert len(fits) > 5


def test_a_signal_whose_square_is_weighed_stays_near():
    """Of 4 (w - 1)^2 + 3 d <= 1 with -10 <= w <= 10: w is within a half of 1, and d is 0."""
    qp = Qp(np.diag([8.0, 0.0]), [-8.0, 3.0], np.zeros((0, 2)), [], [], [-10, 0], [10, 1], constant=4.0)
    data, settings, box, _ = kernel_data(Miqp(qp, [1]))
    bound, moved, left = narrow_by_cost(data, box, np.array([1.0, 0.0]), np.zeros(0), 1.0, settings)
    assert (bound, moved, left) == (pytest.approx(0.0, abs=1e-9), 3, True)
    assert box[0].tolist() == pytest.approx([0.5, 0.0], abs=1e-6)
    assert box[1].tolist() == pytest.approx([1.5, 0.0], abs=1e-6)


def test_a_cutoff_below_the_optimum_leaves_nothing_or_says_so():
    miqp = curved(3)
    best = solve_miqp(miqp, MiqpSettings(backend="piqp"))
    data, settings, box, _ = kernel_data(miqp)
    bound, _, left = narrow_by_cost(data, box, best.x, np.zeros(miqp.qp.m), -1e3, settings)
    assert bound >= -1e3 or not left


@pytest.mark.parametrize(
    ("slope", "curvature", "level"),
    [(0, 2, 1), (3, 2, 1), (-3, 2, 1), (1, 0, 2), (-1, 0, 2), (1e8, 1e-8, 1), (2, 4, -0.4)],
)
def test_ends_of_a_parabola_below_a_level(slope, curvature, level):
    low, high = where_below(float(slope), float(curvature), float(level))
    for t in (low, high):
        if np.isfinite(t):
            size = abs(slope * t) + curvature / 2 * t * t
            assert slope * t + curvature / 2 * t * t == pytest.approx(level, abs=1e-12 * size)
    assert low <= high


def test_a_parabola_above_a_level_leaves_nothing():
    low, high = where_below(1.0, 2.0, -1.0)
    assert low > high


@pytest.mark.parametrize("seed", range(40))
def test_probing_loses_no_integer_point_of_a_hybrid_system(seed):
    miqp = hybrid_problem(seed)
    data, settings, box, feasible = kernel_data(miqp)
    width = (box[1] - box[0]).sum()
    left, changes = probe(data, box, settings) if feasible else (False, 0)
    found = list(corners(miqp, 6, seed))
    assert left or not found
    start, column, value = data[0][2]
    for x in found:
        assert is_inside(box, x)
        for row in range(miqp.qp.m):
            at = slice(start[row], start[row + 1])
            total, size = value[at] @ x[column[at]], 1 + abs(value[at]) @ abs(x[column[at]])
            assert data[0][3][row] - TOLERANCE * size <= total <= data[0][4][row] + TOLERANCE * size
    assert (box[1] - box[0]).sum() <= width + 1e-9
    assert changes >= 0


def test_probing_finds_something():
    """Of x <= 10 d, x <= 3 and x + y >= 4 with y <= 2: d is 1; the constant of z <= 50 e is that of its range."""
    A = [[1, 0, -10, 0, 0], [1, 1, 0, 0, 0], [0, 0, 0, 1, -50], [0, -3, 0, 1, 0]]
    inf = np.inf
    qp = Qp(np.zeros((5, 5)), np.ones(5), A, [-inf, 4, -inf, -inf], [0, inf, 0, 0], np.zeros(5), [3, 2, 1, 100, 1])
    data, settings, box, _ = kernel_data(Miqp(qp, [2, 4]))
    left, changes = probe(data, box, settings)
    assert left
    assert changes
    assert box[0][2] == 1.0
    assert data[0][2][2][data[0][2][0][2] + 1] == pytest.approx(-6, rel=1e-6)


def test_a_problem_that_probing_proves_empty():
    """Two binaries, of which exactly one is 1 and both are equal."""
    qp = Qp(np.zeros((2, 2)), np.ones(2), [[1, 1], [1, -1]], [1, 0], [1, 0], np.zeros(2), np.ones(2))
    data, settings, box, _ = kernel_data(Miqp(qp, [0, 1]))
    assert not probe(data, box, settings)[0]


@pytest.mark.parametrize("seed", range(20))
def test_a_search_that_probes_at_once_finds_the_same(small_problem, oracle, seed):
    result, expected = solve_miqp(small_problem(seed), MiqpSettings(backend="dense", probing=1)), oracle(seed)
    assert (result.status is MiqpStatus.INFEASIBLE) == (expected == np.inf)
    if expected < np.inf:
        assert result.status is MiqpStatus.OPTIMAL
        assert result.objective == pytest.approx(expected, abs=1e-5 * (1 + abs(expected)))
        assert result.bound <= expected + 1e-7 * (1 + abs(expected))


def test_curvature_of_single_variables_leaves_the_rest_semidefinite():
    for seed in range(20):
        P = curved(seed).qp.P
        rest = P.toarray() - np.diag(diagonal_curvature(P))
        assert np.linalg.eigvalsh(rest)[0] >= -1e-9
        assert (diagonal_curvature(P) >= 0).all()


def test_units_that_differ_by_much_do_not_stop_the_dense_solver():
    """Flows of two_tanks are of the size of 1e-4, its levels of 1: nodes are certified, the cost proves the rest."""
    mpc = hys.HybridMpc(hys.load("two_tanks"), 6, hys.Cost(y={"level2": 100.0}, u={"valve": 0.001}), backend="dense")
    move = mpc.solve({"h1": 0.1, "h2": 0.4}, {"level2": 0.2})
    assert move.status is hys.MoveStatus.OPTIMAL
    assert move.nodes <= 20


@pytest.mark.parametrize("seed", range(20))
def test_squares_of_binaries_become_linear_and_nothing_else_changes(small_problem, seed):
    miqp = small_problem(seed)
    P = miqp.qp.P + np.diag(np.where(np.arange(miqp.qp.n) % 2, 3.0, 0.0))
    miqp = Miqp(Qp(P, miqp.qp.q, miqp.qp.A, miqp.qp.l, miqp.qp.u, miqp.qp.lb, miqp.qp.ub, 0.5), miqp.binaries)
    program, shift = without_binary_squares(miqp)
    rng = np.random.default_rng(seed)
    assert np.linalg.eigvalsh(program.qp.P.toarray())[0] >= -1e-9
    for _ in range(5):
        x = rng.normal(size=miqp.qp.n)
        x[miqp.binaries] = rng.integers(0, 2, len(miqp.binaries))
        assert objective_value(program.qp, x) == pytest.approx(objective_value(miqp.qp, x), abs=1e-12)
        x[miqp.binaries] = 0.5
        assert objective_value(program.qp, x) >= objective_value(miqp.qp, x) - 1e-12
    assert (shift >= 0).all()


def test_vectors_of_a_call_get_the_same_linear_terms():
    """Least (d - 1)^2 + x with x >= d / 2 in a call whose slope is not that of the constructor."""
    qp = Qp(np.diag([2.0, 0.0]), [0.0, 0.0], [[-0.5, 1.0]], [0], [np.inf], np.zeros(2), np.ones(2), constant=1.0)
    solver = MiqpSolver(Miqp(qp, [0]), MiqpSettings(backend="piqp"))
    assert solver.solve().objective == pytest.approx(1.0)
    result = solver.solve(q=[-2.0, 1.0])
    assert result.objective == pytest.approx(0.5)
    assert result.x == pytest.approx([1.0, 0.5], abs=1e-6)
