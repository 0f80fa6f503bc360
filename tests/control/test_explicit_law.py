"""Explicit laws: evaluation, hysteresis, tree, merging, slices, certificates, files, text."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from hysdel_py.control.explicit_certificate import OnlineProblem, random_points
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_tree import build_tree, same_moves
from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.mpqp import MpQpSettings, solve_mpqp

sys.path.insert(0, str(Path(__file__).parents[1] / "optimize" / "parametric"))
from problems import benchmark, boxed


@cache
def solved(name="a_di_N3"):
    problem, moves = benchmark(name)
    return problem, ExplicitLaw.of(solve_mpqp(problem), moves, tuple(f"x{j}" for j in range(problem.p)))


def points(law, count=60, seed=0):
    return random_points(law, count, np.random.default_rng(seed))


def saturation():
    """``u = max(-1, min(1, -x))`` for x in [-3, 3]: three regions that anyone can draw."""
    problem = boxed(np.eye(1), [[1.0]], [[1.0], [-1.0]], [1.0, 1.0])
    return problem, ExplicitLaw.of(solve_mpqp(problem), names=("x",))


def test_a_saturated_law():
    _, law = saturation()
    assert law.count == 3
    for x, u in ((-3.0, 1.0), (-1.0, 1.0), (0.25, -0.25), (2.0, -1.0)):
        assert law([x]) == pytest.approx([u])
        assert law.value([x]) == pytest.approx(0.5 * u * u + u * x)
    assert law([3.1]) is None
    assert law.value([3.1]) == np.inf
    assert law.locate([3.1]) == -1


def test_the_value_keeps_its_digits_in_a_thin_region():
    problem, law = solved("b_ms2_N5")
    region = int(np.argmax(np.abs(law.P).max(axis=(1, 2))))
    centre = law.polyhedron(region).ball.centre
    _, _, value = OnlineProblem(problem).solve(centre)
    assert law.value(centre) == pytest.approx(value, rel=1e-9)
    assert replace(law, objective=None).value(centre) != pytest.approx(value, rel=1e-9)


def test_the_last_region_is_kept_on_its_boundary():
    _, law = saturation()
    inner, outer = law.locate([0.0]), law.locate([2.0])
    assert law.locate([1.0], inner) == inner
    assert law.locate([1.0], outer) == outer
    assert law.locate([1.001], inner) == outer


@pytest.mark.parametrize("name", ["a_di_N3", "f_thesis", "c_pend_N3", "e_rnd0_z3t2"])
def test_a_law_agrees_with_the_problem_online(name):
    problem, law = solved(name)
    certificate = law.certificate(problem, 60)
    assert certificate.holds()
    assert certificate.feasible > 10
    assert certificate.undecided == 0
    assert certificate.samples == 60


def test_the_certificate_notices_a_missing_region_a_wrong_law_and_an_overlap():
    problem, law = solved("e_rnd0_z3t2")
    region = law.locate(points(law, 1)[0])
    assert not replace(law, k=law.k + 1e-3).certificate(problem, 40).holds()
    assert not replace(law, r=law.r + 1e-3).certificate(problem, 40).holds()
    shrunk = law.b - np.where(np.arange(len(law.b)) == law.starts[region], 0.5, 0.0)
    assert law.certificate(problem, 200).missing == 0
    assert replace(law, b=shrunk).certificate(problem, 200).missing > 0
    wide = law.b + np.where(np.arange(len(law.b)) == law.starts[region], 0.5, 0.0)
    assert replace(law, b=wide).certificate(problem, 200).overlaps > 0


@pytest.mark.parametrize("name", ["a_di_N3", "e_rnd0_z3t2", "g_bemporad02"])
def test_the_search_tree_finds_the_same_moves(name):
    _, law = solved(name)
    by_moves = build_tree(law, same_moves(law))
    assert law.tree.tree.depth <= law.count
    for point in points(law):
        move = law(point)
        if move is None:
            assert law(point, tree=True) is None
            continue
        assert law.tree.locate(point) >= 0
        assert law._holds(law.tree.locate(point), point)
        assert law(point, tree=True) == pytest.approx(move, abs=1e-7)
        leaf = by_moves.locate(point)
        assert law.K[leaf, : law.moves] @ point + law.k[leaf, : law.moves] == pytest.approx(move, abs=1e-6)
    assert by_moves.tree.size <= law.tree.tree.size


def test_merging_keeps_the_moves():
    problem, law = solved("g_bemporad02")
    merged = law.merged()
    assert merged.count == 7 < law.count == 9
    assert merged.certificate(problem, 40).holds()
    for point in points(law):
        assert merged(point) == pytest.approx(law(point), abs=1e-8)
    with pytest.raises(ArgumentError, match="no value function"):
        merged.value(points(law, 1)[0])


def test_merging_does_not_fill_a_dent():
    _, law = solved("a_di_N3")
    merged = law.merged()
    outside = [point for point in points(law, 200) if law.locate(point) == -1]
    assert outside
    assert all(merged.locate(point) == -1 for point in outside)


def test_a_slice_is_the_law_with_numbers_put_in():
    _, law = solved("f_thesis")
    centre = law.domain.ball.centre
    sliced = law.fixed({"x0": centre[0], 3: centre[3]})
    assert sliced.names == ("x1", "x2", "x4", "x5")
    assert sliced.domain.n == 4
    hits = 0
    for rest in points(sliced, 40):
        full = np.array([centre[0], rest[0], rest[1], centre[3], rest[2], rest[3]])
        a, b = law(full), sliced(rest)
        assert (a is None) == (b is None)
        if a is not None:
            hits += 1
            assert b == pytest.approx(a, abs=1e-6)
            assert sliced.value(rest) == pytest.approx(law.value(full), rel=1e-6)
    assert hits > 5


def test_a_law_read_back_is_the_same(tmp_path):
    _, law = solved()
    for number, each in enumerate((law, law.merged())):
        path = tmp_path / f"{number}.npz"
        each.save(path)
        other = ExplicitLaw.load(path)
        assert other.describe() == each.describe()
        assert other.A.tobytes() == each.A.tobytes()
        assert other.active == each.active
        assert (other.moves, other.names, other.complete) == (each.moves, each.names, each.complete)
        assert other.domain.b.tolist() == each.domain.b.tolist()
        assert other.has_value == each.has_value
        assert not each.has_value or other.value(np.full(law.p, 0.1)) == each.value(np.full(law.p, 0.1))
    path.write_text("nothing")
    with pytest.raises(ArgumentError, match=r"is not an \.npz file"):
        ExplicitLaw.load(path)
    np.savez(tmp_path / "other.npz", a=np.ones(2))
    with pytest.raises(ArgumentError, match="no explicit law of format 1"):
        ExplicitLaw.load(tmp_path / "other.npz")


def test_the_text_of_a_law():
    _, law = saturation()
    assert law.describe() == (
        "explicit law: 3 regions, 6 rows, 1 parameters (x), 1 moves\n"
        "complete\n"
        "region 0, active rows: none\n"
        "  -x <= 1\n  x <= 1\n  move 0 = -x\n"
        "region 1, active rows: 0\n"
        "  x <= -1\n  -x <= 3\n  move 0 = 1\n"
        "region 2, active rows: 1\n"
        "  -x <= -1\n  x <= 3\n  move 0 = -1\n"
    )


def test_an_incomplete_law_says_so():
    law = ExplicitLaw.of(solve_mpqp(benchmark("e_rnd0_z3t2")[0], MpQpSettings(regions=3)))
    assert "incomplete" in law.describe()
    assert law.count == 3


def test_an_empty_law_has_no_move():
    law = ExplicitLaw.of(solve_mpqp(boxed(np.eye(2), -np.eye(2), [[1, 0], [-1, 0]], [-1, -1])))
    assert law.count == 0
    assert law([0.0, 0.0]) is None


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda law: law([1.0]), r"zeta has shape \(1,\): \(2,\) was expected, x0, x1"),
        (lambda law: law([1.0, np.nan]), "x1 is not a finite number"),
        (lambda law: law.fixed({"y": 1.0}), "'y' is no parameter"),
        (lambda law: law.fixed({0: "a"}), "0 is 'a': a finite number"),
        (lambda law: law.fixed({0: np.nan}), "0 is nan: a finite number"),
        (lambda law: law.fixed([1.0]), "a mapping of parameters to numbers"),
        (lambda law: law.fixed({0: 1e3}), "lies outside the box of the law"),
        (lambda law: law({"y": 1.0}), "numbers were expected"),
        (lambda law: law.fixed({0: 1.0, 1: 0.0}), "all parameters are given"),
        (lambda law: replace(law, moves=9), "moves is 9: a number from 1 to 3"),
        (lambda law: replace(law, names=("a",)), "1 names were given for 2 parameters"),
    ],
)
def test_wrong_questions_are_named(ask, message):
    with pytest.raises(ArgumentError, match=message):
        ask(solved()[1])
