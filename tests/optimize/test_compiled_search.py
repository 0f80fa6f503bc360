"""The compiled loop: its certificates against the vectorised ones, its answers whatever the slices and the help."""

from dataclasses import replace

import numpy as np
import pytest

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.optimize import compiled_search, workspace
from hysdel_py.optimize.certificate import Certifier
from hysdel_py.optimize.compiled_search import CompiledSearch
from hysdel_py.optimize.dense import DenseSettings, dense_solver
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels import tree
from hysdel_py.optimize.kernels.certificate import bound_below, excess, farkas_bound
from hysdel_py.optimize.miqp import MiqpSettings, MiqpSolver, MiqpStatus, solve_miqp
from hysdel_py.optimize.mixed_integer import NodeFate
from hysdel_py.optimize.node_log import NodeLog
from hysdel_py.optimize.qp import violation
from hysdel_py.optimize.workspace import Workspace

COUNT = 40


def kernel_problem(miqp):
    dense = dense_solver(miqp, "dense")
    qp = miqp.qp
    vectors = (np.array(v) for v in (qp.q, qp.l, qp.u))
    q, l, u = vectors  # noqa: E741
    return (dense.P, q, dense.rows, l, u, dense.integer), (np.array(qp.lb), np.array(qp.ub))


@pytest.mark.parametrize("seed", range(COUNT))
def test_certificates_are_those_of_the_vectorised_form(small_problem, seed):
    miqp = small_problem(seed)
    qp, certifier = miqp.qp, Certifier.of(miqp.qp)
    problem, box = kernel_problem(miqp)
    rng = np.random.default_rng(seed)
    x, y = rng.normal(size=qp.n), rng.normal(size=qp.m)
    known = (qp.constant, np.zeros(qp.n), certifier.rounding)
    assert bound_below(problem, box, x, y, known) == pytest.approx(certifier.dual_bound(qp, x, y), rel=1e-12, abs=1e-12)
    assert farkas_bound(problem, box, y, certifier.rounding) == pytest.approx(certifier.farkas_bound(qp, y), rel=1e-12)
    assert excess(problem, box, x) == pytest.approx(violation(qp, x), rel=1e-12, abs=1e-15)


def test_a_certificate_in_nothing_but_numbers_that_are_none(small_problem):
    miqp = small_problem(3)
    problem, box = kernel_problem(miqp)
    nothing = np.full(miqp.qp.n, np.nan)
    known = (0.0, np.zeros(miqp.qp.n), 1e-14)
    assert bound_below(problem, box, nothing, np.zeros(miqp.qp.m), known) == -np.inf
    assert excess(problem, box, nothing) == np.inf


def test_curvature_bounds_a_free_variable():
    from hysdel_py.optimize.mixed_integer import Miqp
    from hysdel_py.optimize.qp import Qp

    qp = Qp([[2.0]], [-2.0], np.zeros((0, 1)), [], [], [-np.inf], [np.inf])
    problem, box = kernel_problem(Miqp(qp, []))
    at, none = np.array([0.9]), np.zeros(0)
    assert bound_below(problem, box, at, none, (0.0, np.zeros(1), 1e-15)) == -np.inf
    curved = bound_below(problem, box, at, none, (0.0, np.array([1.0]), 1e-15))
    assert curved <= -1.0
    assert curved == pytest.approx(Certifier.of(qp, np.array([1.0])).dual_bound(qp, at, none), rel=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_slices_do_not_change_the_search(small_problem, seed):
    miqp = small_problem(500 + seed)
    settings = MiqpSettings(backend="dense", rounding=0)
    whole, seen = solve_miqp(miqp, settings), []
    sliced = solve_miqp(miqp, settings, progress=seen.append)
    assert (sliced.status, sliced.nodes, sliced.qps) == (whole.status, whole.nodes, whole.qps)
    assert sliced.objective == whole.objective
    assert len(seen) == sliced.nodes


@pytest.mark.parametrize("seed", range(24))
def test_what_the_loop_hands_back_is_settled_by_other_means(small_problem, oracle, seed):
    miqp = small_problem(seed)
    solver = MiqpSolver(miqp, MiqpSettings(backend="dense"))
    solver.verified.dense.settings = DenseSettings(largest=0)
    solver.workspace = Workspace(
        miqp, solver.settings, solver.verified.dense, solver.workspace.columns
    )  # fmt: skip
    result = solver.solve()
    expected = oracle(seed)
    if expected == np.inf:
        assert result.status is MiqpStatus.INFEASIBLE
    else:
        assert result.status is MiqpStatus.OPTIMAL
        assert result.objective == pytest.approx(expected, abs=1e-5 * (1 + abs(expected)))


def test_the_tree_grows(two_mode_problem, monkeypatch):
    settings = MiqpSettings(backend="dense", rounding=0)
    wide = solve_miqp(two_mode_problem(horizon=6), settings)
    monkeypatch.setattr(workspace, "ROOM", 2)
    narrow = solve_miqp(two_mode_problem(horizon=6), settings)
    assert wide.nodes > 5
    assert (narrow.objective, narrow.nodes, narrow.bound) == (wide.objective, wide.nodes, wide.bound)


@pytest.mark.parametrize("is_late", [False, True])
def test_a_probing_that_would_not_end_in_time_is_put_off(two_mode_problem, monkeypatch, is_late):
    miqp = two_mode_problem(horizon=6)
    monkeypatch.setattr(compiled_search, "AS_LONG_AS", np.inf if is_late else 0)
    solver = MiqpSolver(miqp, MiqpSettings(backend="dense", rounding=0, probing=2, time_limit=1e3))
    result, counters = solver.solve(), solver.workspace.state[its.COUNTERS]
    assert result.nodes > 2
    assert (counters[tree.PROBING] >= 2 * 4) is not is_late
    assert result.objective == pytest.approx(solve_miqp(miqp).objective, abs=1e-5)


def test_the_drivers_of_the_solution_give_the_solution(two_mode_problem):
    miqp = two_mode_problem(horizon=6)
    solver = MiqpSolver(miqp, MiqpSettings(backend="dense", rounding=0, node_limit=1))
    best = solve_miqp(miqp, MiqpSettings(backend="dense"))
    again = solver.solve(point=best.x, active=best.active)
    assert again.objective == pytest.approx(best.objective, rel=1e-6)
    without = solver.solve()
    assert without.x is None or without.objective >= again.objective - 1e-9


def test_bounds_of_a_stopped_search_are_valid(two_mode_problem):
    miqp = two_mode_problem()
    best = solve_miqp(miqp, MiqpSettings(backend="dense")).objective
    for nodes in (1, 2, 5, 10):
        result = solve_miqp(miqp, MiqpSettings(backend="dense", node_limit=nodes))
        assert result.bound <= best + 1e-6
        assert result.objective >= best - 1e-5
        assert result.nodes <= nodes


def test_warming_up_leaves_nothing_to_compile(two_mode_problem):
    from hysdel_py.optimize.kernels import search as kernel
    from hysdel_py.optimize.warm_up import warm_up

    assert warm_up() >= 0.0
    if kernels_are_compiled():
        before = len(kernel.run.entry.signatures), len(kernel.start.entry.signatures)
        best = solve_miqp(two_mode_problem(horizon=4), MiqpSettings(backend="dense"))
        solver = MiqpSolver(two_mode_problem(horizon=4), MiqpSettings(backend="dense"))
        solver.solve(point=best.x, active=best.active, incumbent=best.x)
        assert (len(kernel.run.entry.signatures), len(kernel.start.entry.signatures)) == before


@pytest.mark.skipif(not kernels_are_compiled(), reason="nothing to rehearse without numba")
def test_a_program_that_is_empty_without_the_numbers_of_a_call_is_rehearsed_all_the_same(two_mode_problem, monkeypatch):
    miqp, entered = two_mode_problem(horizon=2), []
    loop = CompiledSearch._loop
    monkeypatch.setattr(CompiledSearch, "_loop", lambda self, nodes: entered.append(nodes) or loop(self, nodes))
    MiqpSolver(replace(miqp, qp=miqp.qp.with_vectors(l=miqp.qp.u + 1.0)), MiqpSettings(backend="dense"))
    assert entered == [0]


@pytest.mark.parametrize("seed", range(12))
def test_each_node_is_recorded_below_its_parent(small_problem, seed):
    log = NodeLog()
    result = solve_miqp(small_problem(seed), MiqpSettings(backend="dense"), progress=log)
    records = [entry.node for entry in log.entries]
    assert [record.number for record in records] == list(range(1, result.nodes + 1))
    if records:
        assert (records[0].parent, records[0].variable) == (0, -1)
    by_number = {record.number: record for record in records}
    for record in records[1:]:
        parent = by_number[record.parent]
        assert parent.fate is NodeFate.SPLIT
        assert record.variable in small_problem(seed).binaries
        assert record.value in (0.0, 1.0)
        assert record.bound >= parent.bound
    ways = [(record.parent, record.variable, record.value) for record in records]
    assert len(set(ways)) == len(ways)
    assert all((record.fate is NodeFate.INFEASIBLE) == (record.bound == np.inf) for record in records)


def test_a_node_that_needs_help_is_recorded_with_its_way(small_problem):
    """A loop that may solve nothing hands every node to the search in Python."""
    log = NodeLog()
    solver = MiqpSolver(small_problem(21), MiqpSettings(backend="dense", rounding=0))
    gaps, dense, *rest = solver.workspace.settings
    solver.workspace.settings = (gaps, (*dense[:-1], -1), *rest)
    result = solver.solve(progress=log)
    records = [entry.node for entry in log.entries]
    assert [record.number for record in records] == list(range(1, result.nodes + 1))
    assert len(records) > 5
    assert all(record.parent in {r.number for r in records if r.fate is NodeFate.SPLIT} for record in records[1:])
    assert all(record.variable >= 0 for record in records[1:])
