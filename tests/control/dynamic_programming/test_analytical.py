"""Analytical dynamic programming against dense quadratic programs, Riccati, and its own conditions."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

import hysdel_py as hys
from hysdel_py.control.dynamic_programming.analytical import AnalyticalDp
from hysdel_py.demos.upshift import Upshift
from hysdel_py.errors import ArgumentError


def dense_inputs(program, x0):
    """The inputs from the conditions of the whole program at once, states eliminated."""
    A, B, d, N = program.A, program.B, program.d, program.stages
    nx, nu = B.shape
    n = N * nu
    G, g = np.zeros((N + 1, nx, n)), np.zeros((N + 1, nx))
    g[0] = x0
    H, h = np.zeros((n, n)), np.zeros(n)
    for k in range(N):
        U = np.zeros((nu, n))
        U[:, k * nu : (k + 1) * nu] = np.eye(nu)
        H += G[k].T @ program.Q @ G[k] + U.T @ program.R @ U + G[k].T @ program.S @ U + U.T @ program.S.T @ G[k]
        h += G[k].T @ (program.Q @ g[k] + program.q) + U.T @ (program.r + program.S.T @ g[k])
        G[k + 1], g[k + 1] = A @ G[k] + B @ U, A @ g[k] + d
    H += G[N].T @ program.P @ G[N]
    h += G[N].T @ (program.P @ g[N] + program.p)
    C, c = program.C @ G[N], program.C @ g[N] + program.c
    m = len(c)
    scale = np.abs(H).max()
    system = np.block([[H / scale, C.T], [C, np.zeros((m, m))]])
    return np.linalg.solve(system, np.concatenate([-h / scale, -c]))[:n].reshape(N, nu)


def random_program(seed, rows, stages=8, nx=4, nu=2):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(nx + nu, nx + nu))
    W = root @ root.T + 0.1 * np.eye(nx + nu)
    end = rng.normal(size=(nx, nx))
    return AnalyticalDp(
        rng.normal(size=(nx, nx)) / 2, rng.normal(size=(nx, nu)), stages, d=rng.normal(size=nx),
        Q=W[:nx, :nx], S=W[:nx, nx:], R=W[nx:, nx:], q=rng.normal(size=nx), r=rng.normal(size=nu),
        P=end @ end.T, p=rng.normal(size=nx), C=rng.normal(size=(rows, nx)), c=rng.normal(size=rows),
    ), rng.normal(size=nx)  # fmt: skip


def cost_of(program, x, u):
    total = 0.5 * x[-1] @ program.P @ x[-1] + program.p @ x[-1]
    for state, given in zip(x, u, strict=False):
        total += 0.5 * state @ program.Q @ state + state @ program.S @ given + 0.5 * given @ program.R @ given
        total += program.q @ state + program.r @ given
    return total


@pytest.mark.parametrize("rows", [0, 1, 2, 3])
@pytest.mark.parametrize("seed", range(5))
def test_equals_the_dense_program(rows, seed):
    """With more equalities than inputs they pass on to the stage before."""
    program, x0 = random_program(seed, rows)
    feedback = program.solve()
    run = feedback.simulate(x0)
    np.testing.assert_allclose(run.u, dense_inputs(program, x0), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(program.C @ run.x[-1] + program.c, 0, atol=1e-9)
    np.testing.assert_allclose(feedback.value(x0), cost_of(program, run.x, run.u), rtol=1e-9)


def test_the_gain_tends_to_that_of_riccati():
    rng = np.random.default_rng(1)
    A, B, Q, R = rng.normal(size=(3, 3)) / 2, rng.normal(size=(3, 2)), np.eye(3), 0.5 * np.eye(2)
    P = solve_discrete_are(A, B, Q, R)
    gain = -np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
    errors = [np.abs(AnalyticalDp(A, B, N, Q, R).solve().K[0] - gain).max() for N in (2, 5, 40)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 1e-9


def test_a_scalar_input_meets_the_equality_in_the_last_step():
    """For one input and one equality the last law is the one given by M. Haj-Fraj and F. Pfeiffer."""
    program, _ = random_program(3, 1, nu=1)
    feedback = program.solve()
    CB = program.C @ program.B
    np.testing.assert_allclose(feedback.K[-1], -(program.C @ program.A) / CB, rtol=1e-9)
    np.testing.assert_allclose(feedback.k[-1], -(program.C @ program.d + program.c) / CB[0], rtol=1e-9)


def test_a_cost_without_minimum_is_refused_with_its_stage():
    with pytest.raises(ArgumentError, match=r"no unique minimum: at stage 1 .* eigenvalue -1"):
        AnalyticalDp([[1.0]], [[1.0]], 2, Q=[[0.0]], R=[[-1.0]]).solve()
    with pytest.raises(ArgumentError, match="positive one was expected"):
        AnalyticalDp([[1.0]], [[1.0, 1.0]], 2, Q=[[1.0]], R=np.zeros((2, 2)), P=[[1.0]]).solve()


def test_an_indefinite_weight_is_fine_where_the_equality_leaves_no_freedom():
    feedback = AnalyticalDp([[1.0]], [[1.0]], 1, Q=[[0.0]], R=[[-1.0]], C=[[1.0]], c=[-3.0]).solve()
    np.testing.assert_allclose(feedback([1.0]), [2.0])


def test_what_the_inputs_cannot_reach_is_told():
    feedback = AnalyticalDp(np.eye(2), [[1.0], [0.0]], 3, np.eye(2), [[1.0]], C=[[0.0, 1.0]], c=[-1.0]).solve()
    assert feedback.value([0.0, 0.0]) == np.inf
    assert np.isfinite(feedback.value([0.0, 1.0]))
    with pytest.raises(ArgumentError, match="cannot be met in 3 steps"):
        feedback.simulate([0.0, 0.0])


def test_the_upshift_ends_in_step_and_without_jerk():
    shift = Upshift()
    program = shift.program()
    feedback = program.solve()
    run = feedback.simulate(shift.start)
    np.testing.assert_allclose(run.u, dense_inputs(program, shift.start), rtol=1e-6, atol=1e-6)
    assert abs(shift.relative_speed @ run.x[-1]) < 1e-9
    row, number = shift.acceleration
    changes = np.diff(run.x @ row + number)
    dull = np.tile(shift.first_inputs, (shift.stages, 1))
    x = [shift.start]
    for u in dull:
        x.append(program.A @ x[-1] + program.B @ u + program.d)
    assert np.abs(changes).max() < 0.2
    assert abs(shift.relative_speed @ x[-1]) > 10
    assert run["we"][-1] < run["we"][0]


def test_feedback_beats_feedforward_under_disturbances():
    shift = Upshift()
    program, rng = shift.program(), np.random.default_rng(0)
    feedback = program.solve()
    planned = feedback.simulate(shift.start).u
    closed, opened = [], []
    for _ in range(20):
        noise = rng.normal(size=(shift.stages, 5)) * [0.05, 0.05, 0, 0.005, 0]
        closed.append(shift.relative_speed @ feedback.simulate(shift.start, noise).x[-1])
        x = shift.start
        for u, w in zip(planned, noise, strict=True):
            x = program.A @ x + program.B @ u + program.d + w
        opened.append(shift.relative_speed @ x)
    assert 3 * np.sqrt(np.mean(np.square(closed))) < np.sqrt(np.mean(np.square(opened)))


def test_in_a_closed_loop():
    program, x0 = random_program(2, 1)
    feedback = program.solve()
    plant = lambda x, u: program.A @ x + program.B @ u + program.d  # noqa: E731
    run = hys.closed_loop(plant, feedback.controller(), x0, program.stages + 2)
    assert run.steps == program.stages
    np.testing.assert_allclose(run.x, feedback.simulate(x0).x, atol=1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"Q": [[1.0, 2.0], [0.0, 1.0]]}, "Q is not symmetric"),
        ({"Q": [[np.nan, 0], [0, 1]]}, "finite"),
        ({"d": [1.0]}, "d has shape"),
        ({"stages": 0}, "stages is 0"),
        ({"B": [1.0, 2.0]}, "B"),
    ],
)
def test_wrong_arguments(changes, message):
    arguments = {"A": np.eye(2), "B": np.eye(2), "stages": 3, "Q": np.eye(2), "R": np.eye(2)} | changes
    with pytest.raises(ArgumentError, match=message):
        AnalyticalDp(**arguments)
