"""Large plants: the banded form against the dense one, against other solvers, and against closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve
from scipy.sparse import csr_array

import hysdel_py as hys
from hysdel_py.drivetrain import structure
from hysdel_py.drivetrain.kernels.box import free_step, solve_box
from hysdel_py.drivetrain.kernels.delassus import is_dense, pushed, respond, slips
from hysdel_py.drivetrain.structure import delassus_of, delassus_of_matrix, dense_delassus
from hysdel_py.optimize.lcp.solve import solve_boxed_lcp

FIXED = (
    hys.Moreau(dt=2e-3),
    hys.Moreau(dt=2e-3, theta=None),
    hys.AugmentedLagrangian(dt=2e-3),
    hys.WaitState(dt=2e-3),
    hys.SwitchModel(dt=2e-3),
    hys.Karnopp(dt=2e-3),
)


def plant(seed, n, doubled=0, springs=True):
    """A chain of n + 1 shafts in shuffled order: N, W; some have a second contact, with one of the next two shafts."""
    random = np.random.default_rng(seed)
    place = random.permutation(n + 1)
    pairs = [(i, i + 1) for i in range(n)]
    pairs += [(i, i + 1 + int(random.integers(2))) for i in random.integers(0, n - 1, doubled)]
    W = np.zeros((n + 1, len(pairs)))
    for column, (a, b) in enumerate(pairs):
        W[place[a], column], W[place[b], column] = 1.0, -float(random.choice([1.0, 1.5]))
    N = np.diag(10 ** random.uniform(-1, 1, n + 1))
    if springs:
        B = np.zeros((n + 1, n // 2))
        for column in range(n // 2):
            B[place[2 * column], column], B[place[2 * column + 1], column] = 1.0, -1.0
        N = N + B @ np.diag(10 ** random.uniform(-2, 1, n // 2)) @ B.T
    return N, W, random


@given(st.integers(0, 10**6), st.integers(20, 60), st.integers(0, 4), st.booleans())
@settings(max_examples=25, deadline=None)
def test_the_band_is_the_matrix(seed, n, doubled, springs):
    N, W, random = plant(seed, n, doubled, springs)
    G = delassus_of(N, W)
    assert not is_dense(G)
    assert G.band.entries.shape[1] <= 1 + structure.WIDEST_BAND
    matrix = W.T @ solve(N, W, assume_a="pos")
    force, P, c = random.normal(size=n + 1), random.normal(size=W.shape[1]), random.normal(size=W.shape[1])
    np.testing.assert_allclose(respond(G, force), solve(N, force, assume_a="pos"), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(pushed(G, P), solve(N, W @ P, assume_a="pos"), rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(slips(G, c, P), matrix @ P + c, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(dense_delassus(G), matrix, rtol=1e-9, atol=1e-11)


@given(st.integers(0, 10**6), st.integers(20, 60), st.integers(0, 4), st.booleans())
@settings(max_examples=25, deadline=None)
def test_the_contact_problem_is_solved_through_the_band(seed, n, doubled, contradicting):
    N, W, random = plant(seed, n, doubled)
    G = delassus_of(N, W)
    matrix = dense_delassus(G)
    count = W.shape[1]
    F = random.uniform(0, 2, count) * (random.random(count) > 0.2)
    c = matrix @ random.normal(size=count)
    if contradicting:  # given speeds at which contacts that depend on each other cannot all stick
        c += random.normal(size=count)
    for start in (np.zeros(count), F.copy(), -F, 0.3 * F):
        P, Q = start.copy(), start.copy()
        assert solve_box(G, c, -F, F, P) > 0
        assert np.all(np.abs(P) <= F)
        gamma, scale = matrix @ P + c, np.abs(matrix) @ F + np.abs(c)
        assert np.all(np.abs(P - np.clip(P - gamma / np.diag(matrix), -F, F)) * np.diag(matrix) <= 1e-10 * scale)
        assert solve_box(delassus_of_matrix(matrix), c, -F, F, Q) > 0
        np.testing.assert_allclose(
            matrix @ P, matrix @ Q, atol=1e-9 * scale.max()
        )  # slips are unique, torques need not be


def test_a_contact_that_depends_on_others_keeps_its_torque():
    N, W = np.eye(41), np.eye(41, 40) - np.eye(41, 40, -1)
    W = np.column_stack([W, W[:, 7] + W[:, 8]])  # from shaft 7 to shaft 9
    G = delassus_of(N, W)
    assert not is_dense(G)
    P = np.zeros(41)
    P[40] = 3.0
    c = W.T @ np.arange(41.0)
    step = free_step(G, c, P, np.arange(41))
    np.testing.assert_allclose(slips(G, c, P + step), 0.0, atol=1e-11)
    assert np.count_nonzero(step == 0.0) == 1


def chain(n, seed=0):
    random = np.random.default_rng(seed)
    parts = [hys.Inertia(f"J{i}", J) for i, J in enumerate(random.uniform(0.1, 1.0, n + 1))]
    parts = [parts[i] for i in random.permutation(n + 1)]
    for i in range(n):
        parts.append(hys.Clutch(f"c{i}", f"J{i}", f"J{i + 1}", float(random.uniform(0, 8))))
        if i % 4 == 1:
            parts.append(hys.SpringDamper(f"s{i}", f"J{i}", f"J{i + 1}", 200.0, 0.3))
    parts += [hys.TorqueSource(f"T{i}", f"J{i}", [(0, 12), (0.05, -12)]) for i in range(0, n + 1, 6)]
    start = {f"J{i}": float(w) for i, w in enumerate(random.choice([0.0, 0.0, 6.0], n + 1))}
    return hys.Drivetrain(*parts, hys.Load("road", f"J{n}", 0.3)), start


@pytest.mark.parametrize("scheme", FIXED, ids=lambda s: f"{type(s).__name__} {getattr(s, 'theta', '')}")
def test_band_and_matrix_give_the_same_run(scheme, monkeypatch):
    line, start = chain(30)
    banded = line.simulate(start, 0.06, scheme)
    monkeypatch.setattr(structure, "SMALLEST_BAND", 10**9)
    dense = chain(30)[0].simulate(start, 0.06, scheme)
    np.testing.assert_allclose(banded.speeds, dense.speeds, atol=1e-9)
    np.testing.assert_allclose(banded.torques, dense.torques, atol=1e-7)
    assert set("".join(banded.modes)) >= {"s", "+", "-"}


def test_schemes_agree_on_a_long_chain():
    line, start = chain(40)
    run = line.simulate(start, 0.06, hys.EventDriven(solver="active-set"), sample=0.06)
    assert run.t[-1] == 0.06
    for scheme, off in ((hys.Moreau(dt=1e-4), 2e-3), (hys.WaitState(dt=1e-4), 2e-2), (hys.Smoothing(1e4), 2e-2)):
        other = line.simulate(start, 0.06, scheme, sample=0.06)
        assert np.abs(other.speeds[-1] - run.speeds[-1]).max() < off


def test_a_step_of_a_chain_of_a_thousand_contacts_is_the_solution_of_its_contact_problem():
    n, dt = 1000, 1e-2
    random = np.random.default_rng(3)
    m, F, w = random.uniform(0.1, 1.0, n + 1), random.uniform(0, 40, n), random.normal(0, 3, n + 1)
    W = np.eye(n + 1, n) - np.eye(n + 1, n, -1)
    line = hys.Drivetrain.from_matrices(np.diag(m), W, F.tolist())
    run = line.simulate(w, dt, hys.Moreau(dt=dt))
    G = csr_array(W.T @ (W / m[:, None]))
    answer = solve_boxed_lcp(G, W.T @ w, -F * dt, F * dt, "newton")  # shares no code with the kernels
    assert answer.solved
    np.testing.assert_allclose(run.speeds[-1], w + W @ answer.z / m, atol=1e-8)
    assert 50 < run.modes[-1].count("s") < 950
    assert run.residuals[-1] < 1e-12
    assert m @ run.speeds[-1] == pytest.approx(m @ w, abs=1e-9)  # momentum


def test_everything_locks_to_the_common_speed():
    n = 300
    line = hys.Drivetrain.from_matrices(np.eye(n + 1), np.eye(n + 1, n) - np.eye(n + 1, n, -1), [5.0] * n)
    w = np.where(np.arange(n + 1) == 0, 301.0, 0.0)
    for scheme in (hys.Moreau(dt=1e4, theta=None), hys.AugmentedLagrangian(dt=1.0, iterations=3)):
        run = line.simulate(w, 1e4 if isinstance(scheme, hys.Moreau) else 1.0, scheme)
        if isinstance(scheme, hys.Moreau):
            np.testing.assert_allclose(run.speeds[-1], 1.0, atol=1e-8)
        else:
            assert run.info["failures"] == 1  # three sweeps cannot do it, and the run says so
            assert "did not converge" in run.messages[0]


def test_a_matrix_that_is_symmetric_to_rounding_only_takes_no_band():
    n = 40
    N, W = np.eye(n + 1), np.eye(n + 1, n) - np.eye(n + 1, n, -1)
    assert not is_dense(delassus_of(N, W))
    N[0, 1] = 1e-17
    assert is_dense(delassus_of(N, W))


def test_a_nonsymmetric_damping_matrix_is_refused_where_it_would_be_wrong():
    D = np.array([[0.0, -5.0], [5.0, 0.0]])
    line = hys.Drivetrain.from_matrices(np.eye(2), [[1], [0]], [0.0], D=D)
    turned = [np.cos(5.0), -np.sin(5.0)]
    for scheme, off in ((hys.EventDriven(), 1e-9), (hys.Exact(), 1e-9), (hys.Moreau(dt=1e-4, theta=None), 2e-3)):
        np.testing.assert_allclose(line.simulate([1.0, 0.0], 1.0, scheme).speeds[-1], turned, atol=off)
    for refused in (hys.Moreau(), hys.AugmentedLagrangian(), hys.VariableStepMoreau()):
        with pytest.raises(hys.ArgumentError, match="D is not symmetric"):
            line.simulate([1.0, 0.0], 1.0, refused)


@pytest.mark.parametrize(("decomposition", "most"), [("boxed", 11), ("leine-nijmeijer", 8), ("pfeiffer-glocker", 4)])
def test_enumeration_refuses_what_it_cannot_finish(decomposition, most):
    def line(n):
        W = np.eye(n + 1, n) - np.eye(n + 1, n, -1)
        return hys.Drivetrain.from_matrices(np.eye(n + 1), W, [0.0] * n)

    for scheme in (
        hys.Moreau(dt=1e-2, solver="enumerative", decomposition=decomposition),
        hys.FixedStepLcp(dt=1e-2, solver="enumerative", decomposition=decomposition, band=1.0),
    ):
        with pytest.raises(hys.ArgumentError, match=f'at most {most} contacts .*take solver="active-set"'):
            hys.Drivetrain.from_matrices(
                np.eye(most + 2), np.eye(most + 2, most + 1) - np.eye(most + 2, most + 1, -1), [1.0] * (most + 1)
            ).simulate(np.zeros(most + 2), 1e-2, scheme)
    run = line(2).simulate(np.zeros(3), 1e-2, hys.Moreau(dt=1e-2, solver="enumerative", decomposition=decomposition))
    assert run.info["failures"] == 0
