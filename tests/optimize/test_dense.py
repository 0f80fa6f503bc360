"""The dense kernels against the sparse solvers, enumeration, and themselves without a compiler."""

import os
import subprocess
import sys

import numpy as np
import pytest

from hysdel_py.optimize.certificate import Certifier
from hysdel_py.optimize.compiled_propagation import CompiledPropagator
from hysdel_py.optimize.dense import dense_solver
from hysdel_py.optimize.kernels import active_set
from hysdel_py.optimize.kernels.node import typical_curvature
from hysdel_py.optimize.miqp import Miqp, MiqpSettings, solve_miqp
from hysdel_py.optimize.propagation import Propagator
from hysdel_py.optimize.qp import Qp, QpSettings, QpStatus
from hysdel_py.optimize.verified import solve_qp


def least_norm_in(N, b, f, H, wished=()):
    J, sound = active_set.inverse_factor(np.array(H))
    assert sound
    work = active_set.work_space(J)
    active_set.start_from(np.array(wished, dtype=np.int64), N, work)
    status, iterations, row = active_set.solve(active_set.nonzeros(N), b, f, work, np.inf, (1e-10, 1000))
    return status, iterations, row, work


@pytest.mark.parametrize("seed", range(40))
def test_active_set_meets_the_conditions_of_optimality(seed):
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 9)), int(rng.integers(1, 25))
    root = rng.normal(size=(n, n))
    H, f = root @ root.T + 1e-3 * np.eye(n), 3 * rng.normal(size=n)
    N = rng.normal(size=(m, n))
    N[m // 2 :] = N[: m - m // 2] if seed % 3 == 0 else N[m // 2 :]  # doubled rows
    N /= np.linalg.norm(N, axis=1)[:, None]
    b = -rng.random(m) * (-0.05 if seed % 4 == 1 else 1.0)
    status, _, row, work = least_norm_in(N, b, f, H)
    count = work[4][0]
    y = np.zeros(m)
    y[work[2][:count]] = work[3][:count]
    if status == active_set.EMPTY:
        y[row] = 1.0
        assert y.min() >= -1e-9
        assert np.abs(N.T @ y).max() < 1e-7
        assert b @ y > 0
        return
    v = work[5]
    assert status == active_set.SOLVED
    assert (b - N @ v).max() <= 1e-8
    assert y.min() >= 0
    np.testing.assert_allclose(H @ v + f, N.T @ y, atol=1e-7)
    again = least_norm_in(N, b, f, H, work[2][:count])
    assert again[1] <= 2
    np.testing.assert_allclose(again[3][5], v, atol=1e-7)


def random_node(rng):
    """Equalities, parallel pairs, fixed variables, a singular Hessian: what a node of predictive control has."""
    n, m = 8, 10
    A = rng.normal(size=(m, n)) * (rng.random((m, n)) < 0.5)
    inside = np.clip(rng.random(n), 0.0, 1.0)
    value = A @ inside
    low, high = value - rng.random(m), value + rng.random(m)
    low[:2] = high[:2] = value[:2]
    A[2], low[2], high[2] = -2 * A[3], -np.inf, -2 * value[3]
    low[3], high[3] = -np.inf, value[3]
    root = rng.normal(size=(4, n))
    lb, ub = np.zeros(n), np.ones(n)
    lb[0] = ub[0] = inside[0]
    if rng.random() < 0.3:
        high[4] = value[4] - 20.0
        low[4] = -np.inf
    return Qp(root.T @ root, rng.normal(size=n), A, low, high, lb, ub)


@pytest.mark.parametrize("seed", range(40))
def test_nodes_agree_with_the_sparse_solver(seed):
    rng = np.random.default_rng(seed)
    qp = random_node(rng)
    solver = dense_solver(Miqp(qp, []), "dense")
    answer, active = solver.solve(qp, (qp.lb, qp.ub), None, QpSettings())
    expected = solve_qp(qp)
    if expected.status is QpStatus.INFEASIBLE:
        assert answer.status is QpStatus.INFEASIBLE
        assert Certifier.of(qp).farkas_bound(qp, answer.y) > 0
        return
    assert answer.status is QpStatus.OPTIMAL
    assert answer.objective == pytest.approx(expected.objective, abs=1e-6)
    assert Certifier.of(qp).dual_bound(qp, answer.x, answer.y) >= expected.objective - 1e-5
    warm, _ = solver.solve(qp, (qp.lb, qp.ub), active, QpSettings())
    assert warm.objective == pytest.approx(answer.objective, abs=1e-7)


@pytest.mark.parametrize("seed", range(30))
def test_both_propagations_agree(seed):
    rng = np.random.default_rng(seed)
    n, m = 7, 8
    A = np.round(rng.normal(size=(m, n)), 1) * (rng.random((m, n)) < 0.5)
    lb = np.where(rng.random(n) < 0.15, -np.inf, 0.0)
    ub = np.where(rng.random(n) < 0.15, np.inf, 1.0 + rng.integers(0, 3, n))
    l = np.where(rng.random(m) < 0.5, -np.inf, -rng.random(m))  # noqa: E741
    u = np.where(rng.random(m) < 0.3, np.inf, 1.5 * rng.random(m))
    boxes = [kind(A, np.arange(3)).propagate(lb, ub, l, u) for kind in (Propagator, CompiledPropagator)]
    assert (boxes[0].conflict is None) == (boxes[1].conflict is None)
    if boxes[0].conflict is None:
        np.testing.assert_allclose(boxes[0].lb, boxes[1].lb, atol=0.03)  # both stop when little is gained
        np.testing.assert_allclose(boxes[0].ub, boxes[1].ub, atol=0.03)
        np.testing.assert_array_equal(boxes[0].lb[:3], boxes[1].lb[:3])


PLAIN = """
import numpy as np
from hysdel_py.optimize.miqp import Miqp, MiqpSettings, solve_miqp
from hysdel_py.optimize.qp import Qp
rng = np.random.default_rng(1)
root = rng.normal(size=(3, 6))
qp = Qp(root.T @ root, rng.normal(size=6), rng.normal(size=(5, 6)), -np.ones(5), np.ones(5), np.zeros(6), np.ones(6))
print(repr(solve_miqp(Miqp(qp, [0, 1, 2]), MiqpSettings(backend="dense")).objective))
"""


def test_plain_python_gives_the_same_answer():
    answers = []
    for off in ("0", "1"):
        environment = {**os.environ, "NUMBA_DISABLE_JIT": off}
        run = subprocess.run([sys.executable, "-c", PLAIN], capture_output=True, text=True, env=environment, check=True)
        answers.append(float(run.stdout))
    assert answers[0] == pytest.approx(answers[1], rel=1e-12)


@pytest.mark.parametrize("backend", ["dense", "piqp", "auto"])
def test_back_ends_agree(two_mode_problem, backend):
    problem = two_mode_problem()
    expected = solve_miqp(problem, MiqpSettings(backend="osqp")).objective
    assert solve_miqp(problem, MiqpSettings(backend=backend)).objective == pytest.approx(expected, rel=4e-6)


def test_the_price_of_a_slack_does_not_set_the_proximal_term():
    """A flat direction beside a dear slack: the proximal steps settle, and the certificate meets the point."""
    P = np.diag([2e5, 1.0, 1.0, 0.0])
    A = np.array([[1.0, 1.0, 1.0, 0.0], [0.0, 1.0, -1.0, 1.0]])
    low, high = np.array([50.0, -np.inf]), np.array([np.inf, 20.0])
    qp = Qp(P, np.array([0.0, 0.3, -0.2, -1e-3]), A, low, high, np.zeros(4), np.full(4, 200.0))
    answer, _ = dense_solver(Miqp(qp, []), "dense").solve(qp, (qp.lb, qp.ub), None, QpSettings())
    bound = Certifier.of(qp).dual_bound(qp, answer.x, answer.y)
    assert answer.objective == pytest.approx(solve_qp(qp).objective, rel=1e-6)
    assert answer.objective - bound <= 1e-8 * abs(answer.objective)


def test_typical_curvature_is_not_that_of_the_greatest():
    assert typical_curvature(np.diag([2.0, 8.0, 0.0]), np.ones(3)) == pytest.approx(4.0)
    assert typical_curvature(np.diag([2.0, 8e6]), np.array([1.0, 1e-3])) == pytest.approx(4.0)
    assert typical_curvature(np.zeros((2, 2)), np.ones(2)) == typical_curvature(np.zeros((0, 0)), np.ones(0)) == 1e-6
