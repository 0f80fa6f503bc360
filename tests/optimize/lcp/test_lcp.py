"""Every method against an enumeration written here, on regular, degenerate, infeasible and ambiguous problems."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear
from scipy.sparse import csr_array, diags_array

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.lcp.problem import Lcp, residual
from hysdel_py.optimize.lcp.solve import LcpSettings, LcpStatus, solve_boxed_lcp, solve_lcp, solve_problem

METHODS = ("auto", "enumerative", "lemke", "pgs", "newton")


def solutions(M, q, lo, hi, tolerance=1e-9):
    """All solutions with a regular mode, by brute force."""
    n, found = len(q), []
    for mode in map(np.array, product((-1, 0, 1), repeat=n)):
        z = np.where(mode < 0, lo, np.where(mode > 0, hi, 0.0))
        free = mode == 0
        if not np.isfinite(z).all() or (free.any() and np.linalg.matrix_rank(M[np.ix_(free, free)]) < free.sum()):
            continue
        z[free] = np.linalg.solve(M[np.ix_(free, free)], -(q + M @ z)[free])
        w = M @ z + q
        signs = np.where(mode < 0, w >= -tolerance, np.where(mode > 0, w <= tolerance, True))
        if np.all(signs & (z >= lo - tolerance) & (z <= hi + tolerance)):
            found.append(z)
    return found


def is_solution(M, q, z, lo=0.0, hi=np.inf, tolerance=1e-7):
    w = M @ z + q
    inside = np.all((z >= lo - tolerance) & (z <= hi + tolerance))
    return inside and np.abs(z - np.clip(z - w, lo, hi)).max() < tolerance


def positive_definite(rng, n):
    root = rng.normal(size=(n, n))
    return root @ root.T + 0.1 * np.eye(n)


def friction_form(G, c, limit):
    """The one-sided form with two unknowns per contact."""
    identity = np.eye(len(c))
    return np.block([[G, identity], [-identity, 0 * G]]), np.concatenate([c - G @ limit, 2 * limit])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("seed", range(15))
def test_positive_definite_problems_have_one_solution(method, seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))
    M, q = positive_definite(rng, n), rng.normal(size=n)
    answer = solve_lcp(M, q, method)
    assert answer.solved, answer.message
    (expected,) = solutions(M, q, np.zeros(n), np.full(n, np.inf))
    np.testing.assert_allclose(answer.z, expected, atol=1e-6)
    np.testing.assert_allclose(answer.w, M @ answer.z + q)
    assert np.array_equal(answer.mode == 0, expected > 1e-9)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("seed", range(15))
def test_boxes_of_friction(method, seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 5))
    G, c, limit = positive_definite(rng, n), rng.normal(size=n), 0.3 * rng.random(n)
    answer = solve_boxed_lcp(G, c, -limit, limit, method)
    assert answer.solved, answer.message
    np.testing.assert_allclose(answer.z, solutions(G, c, -limit, limit)[0], atol=1e-7)


@pytest.mark.parametrize("method", ["auto", "enumerative", "lemke", "newton"])
@pytest.mark.parametrize("seed", range(10))
def test_the_one_sided_form_of_friction(method, seed):
    rng = np.random.default_rng(seed)
    G, c, limit = positive_definite(rng, 3), rng.normal(size=3), rng.random(3)
    answer = solve_lcp(*friction_form(G, c, limit), method)
    assert answer.solved, answer.message
    impulse = limit - answer.z[:3]
    boxed = solve_boxed_lcp(G, c, -limit, limit, "enumerative")
    np.testing.assert_allclose(-impulse, boxed.z, atol=1e-7)


@pytest.mark.parametrize("method", ["auto", "lemke", "newton", "pgs"])
@pytest.mark.parametrize("scale", [1.0, 1e-7, 1e7])
@pytest.mark.parametrize("kind", ["duplicated", "zero force", "rest", "ties", "at the limit"])
def test_degenerate_friction(method, scale, kind):
    """Against least squares with bounds, which minimises the same quadratic function."""
    rng = np.random.default_rng(7)
    W = rng.integers(-2, 3, (6, 8)).astype(float)
    limit, c = rng.integers(1, 3, 8).astype(float), None
    match kind:
        case "duplicated":
            W[:, 4:] = W[:, :4]
        case "zero force":
            limit[::2] = 0.0
        case "rest":
            c = np.zeros(8)
        case "ties":
            c = np.round(W.T @ np.ones(6))
        case "at the limit":
            c = -W.T @ (W @ limit)
    c = W.T @ rng.normal(size=6) if c is None else c
    answer = solve_boxed_lcp(W.T @ W, c * scale, -limit * scale, limit * scale, method)
    assert answer.solved, answer.message
    root = -np.linalg.lstsq(W.T, c, rcond=None)[0]
    tight = np.maximum(limit, 1e-300)
    oracle = lsq_linear(W, root, (-tight, tight), method="bvls")
    np.testing.assert_allclose(W @ answer.z, scale * (W @ oracle.x), atol=1e-6 * scale)


@pytest.mark.parametrize("method", ["enumerative", "lemke", "auto"])
def test_infeasible_problems_are_proven_so(method):
    M, q = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([-1.0, -1.0])  # rows sum to w1 + w2 = -2
    answer = solve_lcp(M, q, method)
    assert answer.status is LcpStatus.NO_SOLUTION
    assert not answer.solved


@pytest.mark.parametrize("method", ["pgs", "newton"])
def test_methods_without_a_proof_do_not_claim_one(method):
    answer = solve_lcp([[1.0, -1.0], [-1.0, 1.0]], [-1.0, -1.0], method)
    assert answer.status in (LcpStatus.ITERATION_LIMIT, LcpStatus.SINGULAR)


def test_a_ray_is_no_proof_for_a_general_matrix():
    """M is copositive but not copositive plus; z = (1, 1) is a solution that Lemke's path misses."""
    M, q = np.array([[0.0, 1.0], [1.0, 0.0]]), np.array([-1.0, -1.0])
    ray = solve_lcp(M, q, "lemke")
    assert ray.status is LcpStatus.RAY
    assert "another method" in ray.message
    np.testing.assert_allclose(solve_lcp(M, q).z, [1, 1])


@pytest.mark.parametrize("seed", range(60))
def test_general_matrices(seed):
    """Solved, proven unsolvable, or an honest ray: never in contradiction with brute force."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 5))
    M, q = rng.normal(size=(n, n)), rng.normal(size=n)
    expected = solutions(M, q, np.zeros(n), np.full(n, np.inf))
    for method in METHODS:
        answer = solve_lcp(M, q, method)
        if answer.solved:
            assert is_solution(M, q, answer.z)
        if answer.status is LcpStatus.NO_SOLUTION:
            assert not expected
        if method in ("auto", "enumerative"):
            assert answer.solved == bool(expected)


def test_of_several_solutions_the_guess_chooses():
    ambiguous = [[1.0, 2.0], [2.0, 1.0]], [-2.0, -2.0]
    first = solve_lcp(*ambiguous, "enumerative", warm=[2.0, 0.0])
    second = solve_lcp(*ambiguous, "enumerative", warm=[0.0, 2.0])
    np.testing.assert_allclose(first.z, [2, 0])
    np.testing.assert_allclose(second.z, [0, 2])
    assert first.iterations == second.iterations == 1


def test_a_singular_mode_is_settled_by_a_linear_program():
    """The only solutions lie on a ray of a mode whose block has rank one."""
    M, q = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([-1.0, 1.0])
    answer = solve_lcp(M, q, "enumerative")
    assert answer.solved
    assert is_solution(M, q, answer.z)


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 4), st.integers(0, 10**6), st.floats(-8, 8), st.sampled_from(["enumerative", "lemke", "newton"]))
def test_units_do_not_matter(n, seed, power, method):
    """Rescaled unknowns and lengths give the rescaled answer."""
    rng = np.random.default_rng(seed)
    M, q, d = positive_definite(rng, n), rng.normal(size=n), 10.0 ** rng.uniform(-4, 4, n)
    plain = solve_lcp(M, q, method)
    scaled = solve_lcp(M / np.outer(d, d), q / d * 10.0**power, method)
    assert plain.solved
    assert scaled.solved
    np.testing.assert_allclose(scaled.z / d / 10.0**power, plain.z, atol=1e-6 * max(1, np.abs(plain.z).max()))


@pytest.mark.parametrize("method", ["enumerative", "lemke", "newton"])
def test_a_warm_start_from_the_right_mode_is_one_step(method):
    rng = np.random.default_rng(3)
    M, q = positive_definite(rng, 6), rng.normal(size=6)
    cold = solve_lcp(M, q, method)
    warm = solve_lcp(M, q + 1e-6, method, warm=cold)
    assert warm.solved
    assert warm.iterations <= 1


@pytest.mark.parametrize("method", ["lemke", "newton"])
@pytest.mark.parametrize("seed", range(10))
def test_a_wrong_guess_does_no_harm(method, seed):
    rng = np.random.default_rng(seed)
    M, q = positive_definite(rng, 5), rng.normal(size=5)
    answer = solve_lcp(M, q, method, warm=5 * rng.normal(size=5))
    np.testing.assert_allclose(answer.z, solve_lcp(M, q, "enumerative").z, atol=1e-6)


def chain(n, half=1):
    e = np.ones(n)
    M = diags_array([2.2 * e, -e[1:], -e[1:]], offsets=[0, 1, -1]).tolil()
    if half > 1:
        M[0, n - 1] = M[n - 1, 0] = -0.1  # no longer banded
    return csr_array(M)


@pytest.mark.parametrize("half", [1, 30])
@pytest.mark.parametrize("method", ["newton", "pgs", "auto"])
def test_sparse_chains(method, half):
    rng = np.random.default_rng(0)
    M, c = chain(60, half), rng.normal(size=60)
    sparse = solve_boxed_lcp(M, c, -0.4, 0.4, method)
    dense = solve_boxed_lcp(M.toarray(), c, -0.4, 0.4, "lemke")
    assert sparse.solved
    np.testing.assert_allclose(sparse.z, dense.z, atol=1e-7)


def test_newton_takes_few_steps_on_a_long_chain():
    c = np.random.default_rng(1).normal(size=3000)
    answer = solve_boxed_lcp(chain(3000), c, -0.4, 0.4, "newton")
    assert answer.solved
    assert answer.iterations < 15


def test_one_matrix_many_vectors():
    rng = np.random.default_rng(2)
    G, limit = positive_definite(rng, 3), np.full(3, 0.2)
    prepared = Lcp(G, np.zeros(3), -limit, limit)
    for _ in range(5):
        c = rng.normal(size=3)
        again = solve_problem(prepared.with_vectors(c, -2 * limit, 2 * limit), "newton")
        np.testing.assert_allclose(again.z, solve_boxed_lcp(G, c, -2 * limit, 2 * limit).z, atol=1e-9)


def test_a_zero_diagonal_excludes_gauss_seidel():
    answer = solve_lcp(*friction_form(np.eye(2), np.ones(2), np.ones(2)), "pgs")
    assert answer.status is LcpStatus.SINGULAR
    assert "lemke" in answer.message


def test_diverging_sweeps_end():
    answer = solve_lcp([[1.0, 9.0], [9.0, 1.0]], [-1.0, -1.1], "pgs")
    assert answer.solved == is_solution(np.array([[1.0, 9.0], [9.0, 1.0]]), np.array([-1.0, -1.1]), answer.z)
    skew = solve_lcp([[1.0, 9.0], [-9.0, 1.0]], [-1.0, 20.0], "pgs")
    assert np.isfinite(skew.z).all()


def test_limits_of_effort_are_told():
    rng = np.random.default_rng(0)
    M, q = positive_definite(rng, 6), -rng.random(6)
    for method, limit in (("lemke", {"pivots": 1}), ("pgs", {"sweeps": 1}), ("enumerative", {"modes": 1})):
        answer = solve_lcp(M, q, method, settings=LcpSettings(**limit))
        assert answer.status is LcpStatus.ITERATION_LIMIT
        assert answer.residual > 1e-9


def test_without_unknowns_or_with_free_ones():
    assert solve_lcp(np.zeros((0, 0)), []).solved
    free = solve_boxed_lcp([[2.0, 1.0], [1.0, 2.0]], [1.0, -1.0], [-np.inf, 0], np.inf, "newton")
    np.testing.assert_allclose(free.z, [-1, 1], atol=1e-9)
    with pytest.raises(ArgumentError, match="no finite bound"):
        solve_boxed_lcp([[1.0]], [1.0], -np.inf, np.inf, "lemke")


def test_upper_bounds_alone():
    for method in METHODS:
        answer = solve_boxed_lcp([[2.0]], [-6.0], -np.inf, 1.0, method)
        np.testing.assert_allclose(answer.z, [1.0])
        assert answer.w[0] <= 0


def test_the_residual_tells_solutions_apart():
    problem = Lcp([[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0], 0.0, np.inf)
    assert residual(problem, np.array([4, 7]) / 3) < 1e-15
    assert residual(problem, np.array([1.4, 2.3])) > 1e-3
    assert residual(problem, np.array([np.nan, 0])) == np.inf


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[1.0, 2.0]], [1.0]), "M has shape"),
        (([[np.nan]], [1.0]), "finite"),
        (([[1.0]], [np.inf]), r"q\[0\]"),
        (([[1.0]], [1.0], "simplex"), "method is 'simplex'"),
        (([[1.0]], [1.0], "newton", [1.0, 2.0]), "warm has shape"),
        (([["x"]], [1.0]), "M is no array of numbers"),
        (([[1.0]], "x"), "q is no array of numbers"),
        (([[1j]], [1.0]), "M is no array of numbers"),
        (([[1.0]], [1.0], "newton", "x"), "warm is no array of numbers"),
    ],
)
def test_wrong_arguments(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        solve_lcp(*arguments)


def test_wrong_settings():
    with pytest.raises(ArgumentError, match="tolerance is 'x'"):
        LcpSettings(tolerance="x")


def test_wrong_bounds():
    with pytest.raises(ArgumentError, match="lies above"):
        solve_boxed_lcp([[1.0]], [1.0], 2.0, 1.0)
    with pytest.raises(ArgumentError, match="hi has shape"):
        solve_boxed_lcp([[1.0]], [1.0], 0.0, [1.0, 2.0])
    with pytest.raises(ArgumentError, match="no number keeps"):
        solve_boxed_lcp([[1.0]], [1.0], np.inf, np.inf)


@pytest.mark.parametrize("method", ["auto", "enumerative", "lemke", "pgs", "newton"])
@pytest.mark.parametrize("far", [1e6, 1e12, 1e20])
def test_a_far_bound_is_no_unit_of_length(method, far):
    """A bound that stands for none must not make every point look like a solution."""
    answer = solve_boxed_lcp([[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0], [0.0, -far], [np.inf, far], method)
    assert answer.solved
    np.testing.assert_allclose(answer.z, [4 / 3, 7 / 3], rtol=1e-8)


def test_a_far_bound_does_not_hide_a_wrong_point():
    problem = Lcp(np.eye(2), [-1.0, -1.0], 0.0, 1e12)
    assert residual(problem, np.zeros(2)) == 1.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[1, 2], [3]], [1, 2]), "M is no array of numbers"),
        (([[1.0]], ["a"]), "q is no array of numbers"),
        (([[1j]], [1.0]), "M is no array of numbers"),
    ],
)
def test_what_is_no_number_is_told_by_name(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        solve_lcp(*arguments)


def test_wrong_guesses_and_settings_are_told():
    with pytest.raises(ArgumentError, match="warm is no array of numbers"):
        solve_lcp([[1.0]], [1.0], warm=["a"])
    with pytest.raises(ArgumentError, match="tolerance is None"):
        LcpSettings(tolerance=None)
