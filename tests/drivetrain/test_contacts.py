"""The contact problem alone: the compiled solver, the decompositions, and the prox iterations."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hysdel_py.drivetrain.decomposition import ContactSolver, friction_lcp, torques_from
from hysdel_py.drivetrain.kernels.box import solve_box
from hysdel_py.drivetrain.kernels.forces import coefficient
from hysdel_py.drivetrain.kernels.prox import SEIDEL, solve_prox
from hysdel_py.drivetrain.kernels.rows import rows_of
from hysdel_py.drivetrain.laws import Coulomb, Stribeck
from hysdel_py.drivetrain.structure import delassus_of_matrix
from hysdel_py.optimize.lcp.solve import solve_boxed_lcp, solve_lcp

KINDS = ("", "doubled", "contradicting", "open", "rest", "small")


def problem(seed, n, kind):
    """A chain with masses over four decades; `kind` makes it degenerate."""
    random = np.random.default_rng(seed)
    m = 10 ** random.uniform(-2, 2, n + 1)
    W = np.eye(n + 1, n) - np.eye(n + 1, n, -1)
    if kind in ("doubled", "contradicting"):
        W[:, -1] = W[:, 0]
    G = W.T @ (W / m[:, None])
    c = W.T @ random.normal(0, 10, n + 1)
    F = 10 ** random.uniform(-2, 2, n) * (random.random(n) > 0.3 if kind == "open" else 1.0)
    if kind == "contradicting":  # given speeds: first and last stick at different ones, and cannot both
        c += random.normal(0, 10, n)
    if kind == "rest":
        c = np.zeros(n)
    if kind == "small":
        c, F = 1e-7 * c, 1e-7 * F
    return G, c, -F, F


def excess(G, c, lo, hi, P):
    """The natural residual, relative to what the limits can move."""
    slip = G @ P + c
    d = np.diag(G)
    return np.max(np.abs(P - np.clip(P - slip / d, lo, hi)) * d) / max(
        1e-300, np.max(np.abs(c)) + np.max(np.abs(G) @ hi)
    )


@given(st.integers(0, 10**6), st.integers(1, 6), st.sampled_from(KINDS))
@settings(max_examples=80, deadline=None)
def test_the_compiled_solver_solves_degenerate_problems(seed, n, kind):
    G, c, lo, hi = problem(seed, n, kind)
    for start in (np.zeros(n), hi, lo, 0.5 * hi):
        P = start.copy()
        assert solve_box(delassus_of_matrix(G), c, lo, hi, P) >= 0
        assert np.all((lo <= P) & (hi >= P))
        assert excess(G, c, lo, hi, P) < 1e-11


@given(st.integers(0, 10**6), st.integers(1, 4))
@settings(max_examples=25, deadline=None)
def test_all_solvers_and_decompositions_agree(seed, n):
    G, c, lo, hi = problem(seed, n, "")
    P = np.zeros(n)
    solve_box(delassus_of_matrix(G), c, lo, hi, P)
    for decomposition in ("leine-nijmeijer", "pfeiffer-glocker"):
        answer = solve_lcp(*friction_lcp(decomposition, G, c, lo, hi), "lemke")
        assert answer.solved
        np.testing.assert_allclose(torques_from(decomposition, answer.z, hi), P, atol=1e-7 * np.max(hi))
    np.testing.assert_allclose(solve_boxed_lcp(G, c, lo, hi).z, P, atol=1e-7 * np.max(hi))
    Q = np.zeros(n)
    assert solve_prox(delassus_of_matrix(G), rows_of(G), c, lo, hi, Q, (SEIDEL, 1.0, 1e-14, 10.0**6), 1.0) > 0
    np.testing.assert_allclose(G @ Q, G @ P, atol=1e-6 * np.max(np.abs(G) @ hi))


@pytest.mark.parametrize(
    "law", [Coulomb(0.8, 0.4), Coulomb(0.3), Stribeck(0.8, 0.4, 0.5, 2.0), Stribeck(1.0, 0.5, 2.0)]
)
def test_kernels_know_the_laws(law):
    for speed in (-3.0, 1e-9, 0.2, 7.0):
        assert coefficient(np.array(law.parameters), speed) == pytest.approx(law.sliding(speed), rel=1e-14)
    assert law.sliding(0.0) == law.static


@pytest.mark.parametrize("decomposition", ["leine-nijmeijer", "pfeiffer-glocker", "boxed"])
@pytest.mark.parametrize("method", ["auto", "lemke"])
def test_a_contact_solver_is_right_from_any_answer_before(decomposition, method):
    solver = ContactSolver(decomposition, method)
    for seed in range(10):
        G, c, lo, hi = problem(seed, 2, "open" if seed % 3 == 0 else "")
        assert excess(G, c, lo, hi, solver(G, c, lo, hi)) < 1e-8
    assert solver.solves == 10


def test_the_document_s_wrong_order_of_limits_would_be_seen():
    """Limits 5 and 50, slips 30 and -20 before friction: the document's order of rows exceeds a limit."""
    G, c, F = np.array([[35.7692, 51.1538], [51.1538, 74.2308]]), np.array([30.0, -20.0]), np.array([5.0, 50.0])
    P = np.zeros(2)
    solve_box(delassus_of_matrix(G), c, -F, F, P)
    np.testing.assert_allclose(P, [-5.0, 3.715], atol=1e-3)
