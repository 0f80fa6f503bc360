"""The tree of the last step, one step later: its answers are those of a cold search and of enumeration."""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np
import pytest
from pwa_enumeration import optimum, random_problem

import hysdel_py as hys
from hysdel_py.control.move import MoveStatus
from hysdel_py.control.prediction import shifted_cover
from hysdel_py.optimize.binary_squares import without_binary_squares
from hysdel_py.optimize.kernels.cover import inherited
from hysdel_py.optimize.mixed_integer import MiqpSettings

STEPS = 5
CLOSE = 1e-5
OPTIONS = {"backend": "dense"}


def same(a, b):
    return a == b if not (np.isfinite(a) and np.isfinite(b)) else abs(a - b) <= CLOSE * max(1.0, abs(a), abs(b))


def agrees(move, expected):
    """Status, cost and bound of an answer that was not limited."""
    assert move.status in (MoveStatus.OPTIMAL, MoveStatus.INFEASIBLE)
    assert same(move.cost, expected)
    assert move.bound <= expected + CLOSE * max(1.0, abs(expected))


def plant_step(problem, x, u, rng):
    """The next state by the modes, beside it by a little, inside the box."""
    for mode in problem.modes:
        if (mode.G @ x + mode.H @ u <= mode.g + 1e-9).all():
            after = mode.A @ x + mode.B @ u + mode.f
            return np.clip(after + rng.normal(size=len(x)) * 0.05, *problem.box.x)
    raise AssertionError


@pytest.mark.parametrize("leaves", [2, 3, 64])
@pytest.mark.parametrize("seed", range(12))
def test_in_a_closed_loop_warm_answers_are_those_of_enumeration(seed, leaves):
    problem, rng = random_problem(seed, 2.0), np.random.default_rng(seed)
    warm = problem.controller(leaves=leaves, **OPTIONS)
    x = problem.x0
    for _ in range(STEPS):
        expected = optimum(replace(problem, x0=x))
        move = warm.solve(x)
        agrees(move, expected)
        agrees(warm.solve(x, warm=False), expected)
        u = np.where(np.isfinite(problem.box.u[0]), problem.box.u[1], 0.0) if move.u is None else move.u
        x = plant_step(problem, x, u, rng)


def switched(**options):
    """Two masses with a switching spring, where a search has some tens of nodes."""
    model = hys.load("""
SYSTEM spring {
INTERFACE {
  STATE { REAL p [-10, 10]; REAL v [-10, 10]; }
  INPUT { REAL f [-2, 2]; BOOL brake; }
  PARAMETER { REAL h = 0.5; }
}
IMPLEMENTATION {
  AUX { BOOL far, fast; REAL pull, drag; }
  AD { far = p >= 1; fast = v >= 0.5; }
  DA { pull = {IF far THEN -p ELSE 0.2*p}; drag = {IF brake & fast THEN -0.8*v ELSE 0}; }
  CONTINUOUS { p = p + h*v; v = v + h*(f + pull + drag); }
} }
""")
    cost = hys.Cost(x={"p": 3, "v": 1}, u={"f": 0.3, "brake": 0.1})
    limits = hys.Limits(x={"v": (-4, 4)}, u={"f": (-2, 2)})
    return hys.HybridMpc(model, 5, cost, limits, **{"gap_rel": 1e-7, "gap_abs": 1e-7, **OPTIONS} | options)


@pytest.fixture(scope="module")
def controllers():
    return switched(), switched(leaves=0)


STATES = [(2.0, 1.0), (1.6, 0.4), (-3.0, 2.0), (2.5, 0.0), (2.4, 0.3), (2.4, 0.3)]


def test_a_tree_is_carried_and_saves_nothing_but_work(controllers):
    warm, cold = controllers
    warm.reset()
    for x in STATES:
        ref, limits = {"p": x[1]}, hys.Limits(x={"v": (-2 - x[0] / 2, 3)}, u={"f": (-1.5, 1 + x[0] / 10)})
        expected = cold.solve(x, ref, warm=False, limits=limits)
        move = warm.solve(x, ref, limits=limits)
        agrees(move, expected.cost)
        assert move.bound <= expected.cost + CLOSE
    assert warm._planner._last.cover is not None
    assert cold._planner._last is None or cold._planner._last.cover is None


@pytest.mark.parametrize("nodes", [1, 2, 3, 5, 9, 20])
def test_after_a_search_that_was_cut_short_nothing_is_missing(controllers, nodes):
    limited, whole = switched(node_limit=nodes), controllers[0]
    for x in STATES:
        best = whole.solve(x, warm=False).cost
        move = limited.solve(x)
        assert move.bound <= best + CLOSE
        assert move.cost >= best - CLOSE
    exact = whole._planner
    exact._last = limited._planner._last  # a whole search begins with the ends of one that was cut short
    agrees(whole.solve(STATES[-1]), whole.solve(STATES[-1], warm=False).cost)


def words(cover, binaries):
    """How many ends hold each word."""
    place = {int(variable): i for i, variable in enumerate(binaries)}
    ends = [
        [(place[int(code) // 2], int(code) % 2) for code in way[:length]]
        for way, length in zip(cover.ways, cover.lengths, strict=True)
    ]
    # of all words, a sample that is the same at each run
    rng = np.random.default_rng(0)
    sample = rng.integers(0, 2, (400, len(binaries)))
    return [sum(all(word[i] == value for i, value in end) for end in ends) for word in sample]


@pytest.mark.parametrize(("leaves", "nodes"), list(product((2, 5, 64), (1, 4, 1000))))
def test_each_word_is_in_exactly_one_end(leaves, nodes):
    controller = switched(leaves=leaves, node_limit=nodes)
    f, planner = controller.formulation, controller._planner
    for x in STATES:
        controller.solve(x)
        last = planner._last
        if last is None or last.cover is None:
            continue
        assert 2 <= len(last.cover.lengths) <= leaves
        assert set(words(last.cover, f.binaries)) == {1}
        later = shifted_cover(f, last.cover, last.x, planner._before)
        if later is not None:
            assert set(words(later, f.binaries)) == {1}
            codes = [code for way, n in zip(later.ways, later.lengths, strict=True) for code in way[:n]]
            assert max(codes, default=0) // 2 < (f.layout.horizon - 1) * f.layout.stage_size


def least(solver, vectors, end):
    """Optimum of a part by a cold search, and its propagated bounds."""
    lb, ub = vectors.lb.copy(), vectors.ub.copy()
    for code in end:
        lb[code // 2] = ub[code // 2] = code % 2
    box = solver.propagator.propagate(lb, ub, vectors.l, vectors.u)
    return solver.solve(**vectors.as_keywords() | {"lb": lb, "ub": ub}).objective, (box.lb, box.ub)


def promises(controller, cover, x, p):
    """What the multipliers of each end promise for a problem, and the optimum of that part."""
    f, solver = controller.formulation, controller._planner.solver
    vectors = f.vectors(np.array(x), {"p": np.full(f.layout.horizon + 1, p)})
    _, shift = without_binary_squares(solver.miqp)
    qp = solver.program.qp.with_vectors(**vectors.as_keywords())
    problem, *_, known, _ = solver.workspace.data(qp.with_vectors(qp.q + shift), None)
    for way, length, *closed_with in zip(*cover.arrays(), strict=True):
        there, box = least(solver, vectors, way[:length].tolist())
        yield inherited(problem, box, *closed_with, known), there


@pytest.mark.parametrize("narrowing", [True, False])
@pytest.mark.parametrize("before", [STATES[0], STATES[2]])
def test_what_closed_an_end_never_promises_more_than_its_part_holds(before, narrowing, monkeypatch):
    monkeypatch.setattr("hysdel_py.optimize.miqp.MiqpSettings", partial(MiqpSettings, narrowing=narrowing))
    controller = switched()
    move = controller.solve(before, warm=False)
    last, layout = controller._planner._last, controller.formulation.layout
    own = list(promises(controller, last.cover, before, 0.0))
    if not narrowing:  # a narrowed box, which proves more with fewer decisions, is not handed on
        assert max(promised for promised, there in own if same(there, move.cost)) == pytest.approx(move.cost, rel=1e-5)
    later = shifted_cover(controller.formulation, last.cover, last.x, controller._planner._before)
    after = layout.split(last.x, np.array(before)).x[1]
    for x, p in [(after, 0.0), (after, 0.7), (-after, -0.2)]:
        own += [] if later is None else promises(controller, later, x, p)
    assert all(promised <= there + CLOSE * max(1.0, abs(there)) for promised, there in own)


def test_an_infeasible_step_does_not_spoil_the_next(controllers):
    warm, cold = controllers
    warm.reset()
    assert warm.solve((2.0, 1.0)).ok
    assert warm.solve((9.9, 9.9)).status is MoveStatus.INFEASIBLE
    agrees(warm.solve((2.0, 1.0)), cold.solve((2.0, 1.0), warm=False).cost)
