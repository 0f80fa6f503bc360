"""Maps of critical regions: counts of others, enumeration, coincidences, limits, executors."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from degenerate import KINDS, swept
from problems import EXPECTED, FACTS, benchmark, boxed, fact, of_random_numbers, of_small_integers

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.mpqp import MpQp, MpQpSettings, solve_mpqp
from hysdel_py.optimize.parametric import exploration

QUICK = ("a_di_N2", "a_di_N3", "a_di_N5", "c_pend_N3", "d_afti_N2", "e_rnd0_z3t2", "e_rnd1_z4t2", "f_thesis",
         "g_ahmadi_ex2", "g_bemporad02")  # fmt: skip
EYE = np.eye(2)


@pytest.mark.parametrize("name", QUICK)
def test_region_counts_of_benchmark_problems(name):
    solution = solve_mpqp(benchmark(name)[0])
    assert len(solution.regions) == EXPECTED[name]
    assert solution.complete


@pytest.mark.parametrize("name", ["a_di_N3", "e_rnd0_z3t2", "f_thesis"])
def test_a_thorough_look_beyond_every_facet_finds_nothing_more(name):
    solution = solve_mpqp(benchmark(name)[0], MpQpSettings(thorough=True))
    assert len(solution.regions) == EXPECTED[name]
    assert solution.complete


def test_a_region_that_exchange_misses_is_found_beyond_a_facet(monkeypatch):
    whole = exploration.explore_chunk

    def without_candidates(*arguments):
        batch = whole(*arguments)
        batch.kinds[:, 2] = 0
        return replace(batch, candidates=batch.candidates[:0])

    monkeypatch.setattr(exploration, "explore_chunk", without_candidates)
    solution = solve_mpqp(benchmark("a_di_N3")[0], MpQpSettings(thorough=True))
    assert len(solution.regions) == EXPECTED["a_di_N3"]
    assert solution.complete


@pytest.mark.parametrize("name", sorted(FACTS))
def test_facts_of_other_toolboxes(name):
    expected = FACTS[name]
    solution = solve_mpqp(fact(name))
    assert len(solution.regions) == expected["regions"]
    assert solution.complete
    law = ExplicitLaw.of(solution)
    for point in expected["evaluations"]:
        compare(law, point)


def compare(law, point):
    theta = np.array(point["x"])
    z = law.solution(theta)
    if point.get("u0", 0) is None:
        assert z is None
        return
    assert z is not None
    for key, own in (("u0", z[: law.moves][:1]), ("z", z)):
        if key in point:
            assert own == pytest.approx(point[key], abs=1e-6)
    for key in ("J", "z_objective"):
        if key in point:
            assert law.value(theta) == pytest.approx(point[key], rel=1e-6, abs=1e-6)


def test_the_published_laws_of_the_linear_clutch():
    law = ExplicitLaw.of(solve_mpqp(fact("thesis_L_clutch21")), moves=1)
    table = np.column_stack([law.K[:, 0], law.k[:, 0]])
    for published in FACTS["thesis_L_clutch21"]["laws"]:
        row = np.array([*published["F"], published["g"]])
        assert min(np.max(np.abs(table - row) / np.maximum(0.1, np.abs(row)), axis=1)) < 2e-3


def test_a_linear_program_whose_cost_depends_on_the_parameter():
    problem = MpQp(np.zeros((2, 2)), [1, 0], [[0], [-2]], [[-1, 1], [-1, 0], [0, -1]], [0, 0, 0], [[-1], [0], [0]],
                   Polyhedron.box([-1], [1]), y=[1])  # fmt: skip
    solution = solve_mpqp(problem)
    law = ExplicitLaw.of(solution)
    assert len(solution.regions) == 2
    for theta, value in ((-1, -1), (-0.5, -0.5), (-0.1, -0.1), (0.25, 0.5), (0.5, 1.0)):
        assert law.value([theta]) == pytest.approx(value)
    assert law([0.6]) is None


@pytest.mark.parametrize("seed", range(4))
def test_regions_are_those_of_enumeration(seed):
    problem = of_random_numbers(seed)
    solution = solve_mpqp(problem)
    assert solution.complete
    assert {region.active for region in solution.regions} == enumerated(problem)


def enumerated(problem):
    """Active sets whose region holds a ball, by the optimality conditions alone."""
    found = set()
    inverse = np.linalg.inv(problem.H)
    for size in range(problem.n + 1):
        for active in map(list, combinations(range(problem.m), size)):
            G = problem.G[active]
            gram = G @ inverse @ G.T
            right_K = problem.S[active] + G @ inverse @ problem.F
            right_k = problem.w[active] + G @ inverse @ problem.f
            L, ell = -np.linalg.solve(gram, right_K), -np.linalg.solve(gram, right_k)
            K = -inverse @ (problem.F + G.T @ L)
            k = -inverse @ (problem.f + G.T @ ell)
            A = np.vstack([-L, problem.G @ K - problem.S, problem.theta.A])
            b = np.concatenate([ell, problem.w - problem.G @ k, problem.theta.b])
            real = np.linalg.norm(A, axis=1) > 1e-9
            if np.all(b[~real] >= -1e-9) and Polyhedron(A[real], b[real]).ball.radius > 1e-6:
                found.add(tuple(active))
    return found


COINCIDENCES = {
    "a third row through a corner": (boxed(EYE, -EYE, [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1]], [1, 1, 1, 1, 2]), 9),
    "four rows through an apex": (
        boxed(np.eye(3), -np.eye(3), [[1, 0, 1], [-1, 0, 1], [0, 1, 1], [0, -1, 1], [0, 0, -1]], [1, 1, 1, 1, 1]), 20),
    "a row twice": (boxed(EYE, -EYE, [[1, 0], [2, 0], [-1, 0], [0, 1], [0, -1]], [1, 2, 1, 1, 1]), 9),
    "an equality as two rows": (boxed(EYE, -EYE, [[1, 1], [-1, -1], [1, 0], [-1, 0]], [0, 0, 1, 1]), 3),
    "an equality": (boxed(EYE, -EYE, [[1, 0], [-1, 0]], [1, 1], E=[[1, 1]], e=[0], D=[[0, 0]]), 3),
    "a row that is always weakly active": (
        boxed(EYE, [[-1, 0], [0, 0]], [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1]], [1, 1, 0, 1, 1]), 3),
    "an absolute value as cost": (
        boxed(np.diag([1.0, 0]), [[-1, 0], [0, 0]], [[1, -1], [-1, -1], [1, 0], [-1, 0]], [0, 0, 1, 1],
              [[0, 1], [0, -1], [0, 0], [0, 0]], f=[0, 1]), 7),
    "a linear program with many solutions": (
        boxed(np.zeros((2, 2)), np.zeros((2, 2)), [[1, -1], [-1, -1], [1, 0], [-1, 0]], [0, 0, 1, 1],
              [[1, 1], [-1, -1], [0, 0], [0, 0]], f=[0, 1]), 3),
    "one row on everything": (boxed(np.eye(1), [[0.0]], [[1.0]], [5.0]), 1),
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(COINCIDENCES))
def test_coincidences(name):
    problem, count = COINCIDENCES[name]
    solution = solve_mpqp(problem)
    assert solution.complete
    assert len(solution.regions) == count
    assert ExplicitLaw.of(solution).certificate(problem, 40).holds()


@pytest.mark.parametrize("kind", ["definite", "semidefinite", "linear"])
@pytest.mark.parametrize("seed", [0, 3, 8, 25])
def test_random_problems_full_of_coincidences(kind, seed):
    problem = of_small_integers(seed, kind)
    solution = solve_mpqp(problem)
    assert solution.complete
    assert ExplicitLaw.of(solution).certificate(problem, 30, seed).holds()


def test_more_rows_than_bits_of_a_word():
    problem, _ = benchmark("e_rnd0_z3t2")
    rng = np.random.default_rng(0)
    weak = rng.uniform(1.0, 2.0, (200, 1)) * problem.G[rng.integers(0, problem.m, 200)]
    far = MpQp(problem.H, problem.f, problem.F, np.vstack([problem.G, weak, np.tile(rng.normal(size=(150, 3)), 1)]),
               np.concatenate([problem.w, np.full(200, 1e3), np.full(150, 30.0)]),
               np.vstack([problem.S, np.zeros((350, 2))]), problem.theta)  # fmt: skip
    solution = solve_mpqp(far)
    assert far.m > 256
    assert [region.active for region in solution.regions] == [region.active for region in solve_mpqp(problem).regions]


def test_many_rows_that_all_matter():
    angles = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    solution = solve_mpqp(boxed(EYE, -EYE, circle, np.ones(200), size=2.0))
    assert solution.complete
    assert len(solution.regions) == 401


@pytest.mark.parametrize("kind", KINDS)
def test_a_sweep_over_degenerate_problems_finds_nothing_wrong(kind):
    counts = swept(kind, range(100, 108), 20)
    assert counts.clean, counts
    assert counts.regions > 8


def test_an_infeasible_problem_has_an_empty_map():
    solution = solve_mpqp(boxed(EYE, -EYE, [[1, 0], [-1, 0]], [-1, -1]))
    assert solution.regions == ()
    assert solution.complete


def theta_of(A, b):
    return MpQp(EYE, [0, 0], -EYE, [[1, 0]], [1], [[0, 0]], Polyhedron(A, b))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: theta_of([[1, 0], [-1, 0], [0, 1]], [1, 1, 1]), "unbounded in coordinate 1"),
        (lambda: theta_of([[1, 0], [-1, 0], [0, 1], [0, -1]], [1, 1, 1, -1]), "flat in coordinate 1"),
        (lambda: theta_of([[1, 0], [-1, 0], [0, 1], [0, -1]], [1, 1, 1, -2]), "is empty"),
        (lambda: theta_of([[1, 1], [-1, -1], [1, -1], [-1, 1]], [0, 0, 1, 1]), "is flat"),
        (lambda: boxed(-EYE, -EYE, [[1, 0]], [1]), "eigenvalue -1"),
        (lambda: boxed([[1, 1], [0, 1]], -EYE, [[1, 0]], [1]), "not symmetric"),
        (lambda: boxed(EYE, -EYE, [[1, 0]], [1, 2]), r"G has shape \(1, 2\): \(2, 2\) was expected"),
        (lambda: boxed(EYE, -EYE, [[1, 0]], [np.nan]), "w has an entry that is not finite"),
        (lambda: boxed(EYE, -EYE, [[1, 0], [-1, 0]] * 2, [0] * 4, [[1, 0], [-1, 0], [0, 0], [0, 0]]), "subspace"),
        (lambda: boxed(EYE, -EYE, [[1, 0], [0, 0], [0, 0]], [1, 0, 0], [[0, 0], [1, 1], [-1, -1]]), "in a subspace"),
        (lambda: boxed(EYE, -EYE, [[1, 0]], [1], E=[[1, 0], [1, 0]], e=[0, 0], D=[[1, 0], [0, 0]]), "to a subspace"),
    ],
)
def test_what_cannot_be_solved_is_refused_by_name(make, message):
    with pytest.raises(ArgumentError, match=message):
        solve_mpqp(make())


def test_settings_are_checked():
    with pytest.raises(ArgumentError, match="radius is -1"):
        MpQpSettings(radius=-1)


PRINT = """
import numpy as np, problems
from hysdel_py.optimize.mpqp import solve_mpqp
for name in ("f_thesis", "e_rnd0_z3t2"):
    for r in solve_mpqp(problems.benchmark(name)[0]).regions:
        print(r.active, len(r.b), *(format(x, ".6e") for x in np.round(r.K.ravel(), 7) + 0.0))
"""


@pytest.mark.skipif(not kernels_are_compiled(), reason="numba is not installed")
def test_compiled_and_plain_kernels_give_the_same_map():
    def run(disabled):
        here = str(Path(__file__).parent)
        path = os.pathsep.join([here, str(Path(__file__).parents[3])])
        env = os.environ | {"NUMBA_DISABLE_JIT": disabled, "PYTHONPATH": path}
        return subprocess.run([sys.executable, "-c", PRINT], env=env, capture_output=True, text=True, check=True).stdout

    assert run("0") == run("1") != ""
