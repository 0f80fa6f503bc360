"""Linear predictive control against independent answers: simulation and SLSQP, closed forms, other forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov
from scipy.optimize import LinearConstraint, minimize

import hysdel_py as hys
from hysdel_py.control.admissible_set import maximal_admissible_set
from hysdel_py.control.lqr import is_stabilisable, lqr
from hysdel_py.geometry.polyhedron import Polyhedron

INTEGRATOR = hys.Lti([[1, 1], [0, 1]], [[1], [0.5]])
MoveStatus = hys.MoveStatus


# ------------------------------------------------------------------ an independent program


class ByHand:
    """The problem of a controller as plain simulation: cost and limits of a plan, nothing eliminated."""

    def __init__(self, mpc, x, ref, last):
        self.mpc, self.x0, self.ref, self.last = mpc, x, ref, last
        self.h, self.w, self.lti = mpc.horizons, mpc.weights, mpc.lti
        self.soft = np.isfinite(mpc.limits.rho) and bool(mpc.limits.of("y"))
        self.size = self.h.moves * self.lti.nu + self.soft

    def run(self, v):
        lti, moves = self.lti, v[: self.h.moves * self.lti.nu].reshape(self.h.moves, -1)
        x, last, rows = self.x0, self.last, []
        for k in range(self.h.steps + 1):
            free = k < self.h.moves
            rest = last if self.mpc.tracks else self.w.gain() @ x
            u = (self.mpc.tracks * last + moves[k]) if free else rest
            rows.append((x, u, lti.C @ x + lti.D @ u + lti.g, u - last))
            x, last = lti.A @ x + lti.B @ u + lti.f, u
        return rows

    def cost(self, v):
        rows, total = self.run(v), 0.0
        for k, (x, u, y, du) in enumerate(rows[:-1]):
            if self.mpc.tracks:
                total += (y - self.ref) @ self.w.S[k] @ (y - self.ref) + du @ self.w.T[k] @ du
            else:
                total += x @ self.w.Q[k] @ x + u @ self.w.R[k] @ u
        last = rows[-1][0]
        total += 0.0 if self.mpc.tracks else last @ self.w.P @ last
        return total + (self.mpc.limits.rho * v[-1] ** 2 if self.soft else 0.0)

    def room(self, v):
        """What is left to each limit; nowhere negative for an admissible plan."""
        rows, eps, found = self.run(v), v[-1] if self.soft else 0.0, []
        signals = {"y": 2, "u": 1, "du": 3, "x": 0}
        for band in self.mpc.limits.bands:
            outputs = band.group in ("y", "x")
            for k in self.h.output_times if outputs else self.h.input_times:
                value = rows[k][signals[band.group]][band.column]
                low, high = band.at(k)
                found += [value - low + eps * outputs, high - value + eps * outputs]
        return np.array([entry for entry in found if np.isfinite(entry)])

    def solve(self):
        """SLSQP, with gradients from the linearity of the rows and the squares of the cost."""
        n, zero = self.size, np.zeros(self.size)
        base = self.room(zero)
        J = np.array([self.room(e) - base for e in np.eye(n)]).T.reshape(len(base), n)
        c = self.cost(zero)
        g = np.array([(self.cost(e) - self.cost(-e)) / 2 for e in np.eye(n)])
        H = np.array([[self.cost(a + b) - self.cost(a) - self.cost(b) + c for b in np.eye(n)] for a in np.eye(n)])
        return minimize(
            lambda v: 0.5 * v @ H @ v + g @ v, zero, jac=lambda v: H @ v + g, method="SLSQP",
            constraints=LinearConstraint(J, -base, np.inf) if len(base) else (),
            options={"ftol": 1e-14, "maxiter": 500},
        )  # fmt: skip


def random_controller(seed):
    rng = np.random.default_rng(seed)
    nx, nu, ny = (int(n) for n in (rng.integers(1, 4), rng.integers(1, 3), rng.integers(1, 3)))
    A = rng.normal(size=(nx, nx))
    A *= rng.uniform(0.4, 1.2) / np.abs(np.linalg.eigvals(A)).max()
    tracks = bool(seed % 2)
    D = rng.normal(size=(ny, nu)) * (seed % 3 == 0)
    lti = hys.Lti(A, rng.normal(size=(nx, nu)), rng.normal(size=(ny, nx)), D,
                  f=0.1 * tracks * rng.normal(size=nx), g=0.1 * tracks * rng.normal(size=ny))  # fmt: skip
    N = int(rng.integers(1, 5))
    limits = hys.LinearLimits(
        u=(-1.0, 1.0), du=(-0.6, 0.6), y=(-1.5, 1.5), rho=float(rng.choice([10.0, 1e3])) if seed % 5 else np.inf
    )
    mpc = hys.LinearMpc(
        lti, "track" if tracks else "regulator", N, limits=limits, control_horizon=int(rng.integers(1, N + 1)),
        output_constraint_horizon=int(rng.integers(0, N + 1)), input_constraint_horizon=int(rng.integers(0, N + 1)),
    )  # fmt: skip
    point = rng.normal(size=nx), rng.normal(size=ny) if tracks else None, rng.uniform(-0.5, 0.5, nu)
    return mpc, point


@pytest.mark.parametrize("seed", range(40))
def test_random_controllers_against_simulation_and_slsqp(seed):
    mpc, (x, ref, last) = random_controller(seed)
    move = mpc.solve(x, ref, last)
    problem = ByHand(mpc, x, ref, last)
    answer = problem.solve()
    if not move.ok:
        assert move.status is MoveStatus.INFEASIBLE
        assert problem.room(answer.x).min() < -1e-7
        return
    assert move.residual < 1e-6
    assert move.cost == pytest.approx(problem.cost(answer.x), rel=1e-5, abs=1e-6)
    assert move.cost <= problem.cost(answer.x) * (1 + 1e-6) + 1e-7
    assert move.u == pytest.approx(problem.run(answer.x)[0][1], abs=2e-3)
    assert move.bound <= move.cost + 1e-9


@pytest.mark.parametrize("backend", ["dense", "piqp", "osqp"])
def test_back_ends_agree(backend):
    limits = hys.LinearLimits(u=(-1, 1), y=(-5, 5))
    answers = [
        hys.LinearMpc(INTEGRATOR, "regulator", 5, limits=limits, backend=name).solve([-4.5, 1.0])
        for name in ("auto", backend)
    ]
    assert answers[0].u == pytest.approx(answers[1].u, abs=1e-6)
    assert answers[0].cost == pytest.approx(answers[1].cost, rel=1e-8)


# ------------------------------------------------------------------ closed forms


def riccati_by_iteration(A, B, Q, R):
    P = Q.copy()
    for _ in range(5000):
        K = -np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
        P = A.T @ P @ (A + B @ K) + Q
    return K, P


@pytest.mark.parametrize("seed", range(6))
def test_without_limits_the_regulator_is_the_optimal_gain(seed):
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(3, 3)), rng.normal(size=(3, 2))
    K, P = riccati_by_iteration(A, B, np.eye(3), 0.1 * np.eye(2))
    N = seed + 1
    mpc = hys.LinearMpc(hys.Lti(A, B), "regulator", N, control_horizon=max(1, N // 2))
    for x in rng.normal(size=(5, 3)):
        move = mpc.solve(x)
        assert move.u == pytest.approx(K @ x, rel=1e-6, abs=1e-8)
        assert move.cost == pytest.approx(x @ P @ x, rel=1e-8)


def test_far_inside_the_limits_the_constrained_regulator_is_the_optimal_gain():
    mpc = hys.LinearMpc(INTEGRATOR, "regulator", 4, limits=hys.LinearLimits(u=(-1, 1), y=(-5, 5)))
    x = np.array([0.05, -0.02])
    assert mpc.solve(x).u == pytest.approx(mpc.weights.gain() @ x, abs=1e-8)


def test_lyapunov_terminal_cost_is_the_sum_over_the_rest_of_time():
    A, B = np.array([[0.9, 0.2], [0.0, 0.7]]), np.array([[0.0], [1.0]])
    mpc = hys.LinearMpc(hys.Lti(A, B), "regulator", 2, hys.LinearCost(terminal="lyap"))
    x, total = np.array([1.0, -2.0]), 0.0
    for _ in range(400):
        total += x @ x
        x = A @ x
    start = np.array([1.0, -2.0])
    assert start @ mpc.weights.P @ start == pytest.approx(total)
    assert not mpc.weights.gain().any()
    K = np.array([[-0.1, -0.2]])
    own = hys.LinearMpc(hys.Lti(A, B), "regulator", 2, hys.LinearCost(terminal="lyap", gain=K)).weights.P
    expected = solve_discrete_lyapunov((A + B @ K).T, np.eye(2) + 0.1 * K.T @ K)
    np.testing.assert_allclose(own, expected)


def test_tracking_settles_on_its_reference():
    lti = hys.Lti([[0.9]], [[0.2]], x=("level",), u=("flow",))
    mpc = hys.LinearMpc(lti, "track", 10, limits=hys.LinearLimits(du=(-0.5, 0.5), u=(0, 3)))
    run = hys.closed_loop(lti, mpc, [0.0], 60, {"level": 1.0}, last_input=[0.0])
    assert run["level"][-1] == pytest.approx(1.0, abs=1e-3)
    assert np.abs(np.diff(run["flow"])).max() <= 0.5 + 1e-9
    assert not run.messages


# ------------------------------------------------------------------ horizons, stages, slacks


def test_defaults():
    mpc = hys.LinearMpc(INTEGRATOR, "regulator")
    h = mpc.horizons
    assert (h.steps, h.moves, h.outputs, h.inputs, h.first_output) == (2, 2, 1, 1, 1)
    assert (mpc.weights.Q[0, 0, 0], mpc.weights.R[0, 0, 0]) == (1.0, 0.1)
    track = hys.LinearMpc(INTEGRATOR, "track", 7, control_horizon=3)
    assert (track.horizons.outputs, track.horizons.inputs) == (6, 2)
    assert (track.weights.S[0, 0, 0], track.weights.T[0, 0, 0]) == (1.0, 0.1)
    assert track.limits.rho == 1e4


def test_limits_count_at_their_times_only():
    limits = hys.LinearLimits(u=(-1, 1), y=(-5, 5), rho=np.inf)
    times = {"output_constraint_horizon": 3, "input_constraint_horizon": 1}
    rows = hys.LinearMpc(INTEGRATOR, "regulator", 4, limits=limits, **times).program.rows
    assert {row.time for row in rows if row.group == "y"} == {1, 2, 3}
    assert {row.time for row in rows if row.group == "u"} == {0, 1}
    now = hys.LinearMpc(INTEGRATOR, "regulator", 4, limits=limits, constrain_first_output=True, **times)
    assert {row.time for row in now.program.rows if row.group == "y"} == {0, 1, 2, 3}
    assert now.solve([6, 0]).status is MoveStatus.INFEASIBLE


def test_the_gain_takes_over_after_the_last_free_input():
    mpc = hys.LinearMpc(INTEGRATOR, "regulator", 5, control_horizon=2)
    predicted = mpc.solve([1.0, -0.5]).predicted
    K = mpc.weights.gain()
    assert predicted.u[2:] == pytest.approx(predicted.x[2:-1] @ K.T)


def test_weights_models_and_limits_per_stage():
    models = [hys.Lti([[a]], [[1.0]]) for a in (0.5, 1.5, 1.0)]
    weights = np.array([[[1.0]], [[2.0]], [[3.0]]])
    limits = hys.LinearLimits(u={"u1": ([-1, -0.2, -0.1], 1)})
    mpc = hys.LinearMpc(models, "regulator", 3, hys.LinearCost(x=weights, u=1.0, terminal=[[4.0]]), limits)
    move = mpc.solve([2.0])
    x, u = move.predicted.x[:, 0], move.predicted.u[:, 0]
    assert x[1:] == pytest.approx(np.array([0.5, 1.5, 1.0]) * x[:-1] + u)
    assert move.cost == pytest.approx(x[:3] ** 2 @ [1, 2, 3] + u @ u + 4 * x[3] ** 2)
    assert (u >= np.array([-1, -0.2, -0.1]) - 1e-8).all()
    assert u[1] == pytest.approx(-0.2, abs=1e-7)


def test_references_known_in_advance():
    lti = hys.Lti([[1.0]], [[1.0]])
    mpc = hys.LinearMpc(lti, "track", 4, hys.LinearCost(du=0.01))
    ahead = mpc.solve([0.0], {"x1": [0, 0, 1, 1]}, [0.0])
    assert ahead.u != pytest.approx(mpc.solve([0.0], {"x1": 0}, [0.0]).u)
    assert ahead.predicted.y[:, 0] == pytest.approx([0, 0, 1, 1], abs=0.1)


def test_one_slack_or_many():
    lti = hys.Lti(np.diag([0.9, 0.8]), np.eye(2))
    for slack, count in (("all", 1), ("signal", 2), ("stage", 4)):
        limits = hys.LinearLimits(u=(-0.1, 0.1), y=(-1, 1), slack=slack, rho=100.0)
        mpc = hys.LinearMpc(lti, "regulator", 3, limits=limits)
        move = mpc.solve([3.0, 0.2])
        assert len(move.slack) == count
        exceeded = np.abs(move.predicted.y[1:3]).max(axis=0) - 1
        assert max(move.slack.values()) == pytest.approx(exceeded[0], abs=1e-6)
        assert "softened limits exceeded" in move.message
    assert move.slack["y.x2(1)"] == pytest.approx(0.0, abs=1e-9)


def test_a_linear_price_keeps_limits_that_can_be_kept():
    lti = hys.Lti([[1.0]], [[1.0]])
    weak = {"y": (-1, 0.5), "rho": 1.0}
    cost = hys.LinearCost(y=1.0, du=0.01)
    soft = hys.LinearMpc(lti, "track", 4, cost, hys.LinearLimits(**weak)).solve([0.0], [2.0], [0.0])
    exact = hys.LinearMpc(lti, "track", 4, cost, hys.LinearLimits(**weak, rho_linear=100.0)).solve([0.0], [2.0], [0.0])
    assert soft.slack["limits"] > 0.1
    assert exact.slack["limits"] == pytest.approx(0.0, abs=1e-7)


def test_ranges_of_inputs_are_limits():
    source = (
        "SYSTEM t { INTERFACE { STATE { REAL x [-9, 9]; } INPUT { REAL u [-1, 2]; } } "
        "IMPLEMENTATION { CONTINUOUS { x = x + u; } } }"
    )
    mpc = hys.LinearMpc(hys.load(source), "regulator", 2, limits=hys.LinearLimits(u=(-5, 1)))
    assert mpc.solve([9.0]).u == pytest.approx([-1.0])
    assert mpc.solve([-9.0]).u == pytest.approx([1.0])


# ------------------------------------------------------------------ invariant sets


def test_the_invariant_set_is_the_greatest():
    K, _ = lqr(INTEGRATOR.A, INTEGRATOR.B, np.eye(2), 0.1 * np.eye(1))
    closed = INTEGRATOR.A + INTEGRATOR.B @ K
    limits = Polyhedron(np.vstack([K, -K, np.eye(2), -np.eye(2)]), [1, 1, 5, 5, 5, 5])
    found = maximal_admissible_set(closed, limits)
    rng = np.random.default_rng(0)
    inside = 0
    for x in rng.uniform(-5, 5, (400, 2)):
        steps, state = [], x
        for _ in range(60):
            steps.append(np.max(limits.A @ state - limits.b))
            state = closed @ state
        assert found.contains(x, 1e-9) == (max(steps) <= 1e-9)
        inside += found.contains(x)
    assert 20 < inside < 380


def test_the_terminal_set_makes_the_loop_keep_its_hard_limits():
    limits = hys.LinearLimits(u=(-1, 1), y=(-5, 5), terminal="invariant", rho=np.inf)
    mpc = hys.LinearMpc(INTEGRATOR, "regulator", 4, limits=limits)
    run = hys.closed_loop(INTEGRATOR, mpc, [4.0, -0.5], 30)
    assert run.steps == 30
    assert not run.messages
    assert np.abs(run.x).max() <= 5 + 1e-9
    assert np.abs(run.x[-1]).max() < 1e-3
    assert mpc.solve([4, 4]).status is MoveStatus.INFEASIBLE


def test_terminal_limits_by_name_and_as_rows():
    by_name = hys.LinearLimits(terminal={"x1": (-0.1, 0.1)})
    as_rows = hys.LinearLimits(terminal=([[1, 0], [-1, 0]], [0.1, 0.1]))
    moves = [hys.LinearMpc(INTEGRATOR, "regulator", 3, limits=limits).solve([4, 0]) for limits in (by_name, as_rows)]
    assert moves[0].u == pytest.approx(moves[1].u)
    assert abs(moves[0].predicted.x[-1, 0]) <= 0.1 + 1e-7


# ------------------------------------------------------------------ without a plan


HARD = hys.LinearLimits(u=(-1, 1), y=(-1, 1), rho=np.inf)


def test_an_infeasible_problem_is_proven_and_says_which_limits():
    move = hys.LinearMpc(INTEGRATOR, "regulator", 3, limits=HARD).solve([4, 0])
    assert (move.status, move.u) == (MoveStatus.INFEASIBLE, None)
    assert "y x1, y x2, u u1" in move.message


def test_fallback_softens():
    move = hys.LinearMpc(INTEGRATOR, "regulator", 3, limits=HARD, fallback="soft").solve([4, 0])
    assert (move.status, move.cause) == (MoveStatus.FALLBACK, MoveStatus.INFEASIBLE)
    assert move.u == pytest.approx([-1.0])
    assert "limits by" in move.message
    terminal = hys.LinearLimits(u=(-1, 1), y=(-9, 9), terminal="invariant", rho=np.inf)
    assert hys.LinearMpc(INTEGRATOR, "regulator", 2, limits=terminal, fallback="soft").solve([8, 0]).ok


def test_fallback_takes_the_rest_of_the_last_plan():
    mpc = hys.LinearMpc(INTEGRATOR, "regulator", 3, limits=HARD, fallback="last_plan")
    plan = mpc.solve([0.5, 0.2]).predicted.u
    assert mpc.solve([4, 0]).u == pytest.approx(plan[1])
    assert mpc.solve([4, 0]).u == pytest.approx(plan[2])
    assert mpc.solve([4, 0]).status is MoveStatus.INFEASIBLE
    mpc.solve([0.5, 0.2])
    mpc.reset()
    assert not mpc.solve([4, 0]).ok


def test_fallback_asks():
    mpc = hys.LinearMpc(INTEGRATOR, "regulator", 3, limits=HARD, fallback=lambda x, move: [-0.25 * np.sign(x[0])])
    assert mpc.solve([4, 0]).u == pytest.approx([-0.25])


def test_a_cost_without_curvature_is_unbounded_or_solved():
    """A direction without weight and limit leaves the plan open, never wrong."""
    lti = hys.Lti([[1.0]], [[1.0, 1.0]])
    move = hys.LinearMpc(lti, "track", 2, hys.LinearCost(du=0.0)).solve([1.0], [2.0], [0.0, 0.0])
    assert move.ok
    assert move.predicted.y[1] == pytest.approx([2.0], abs=1e-5)


# ------------------------------------------------------------------ arguments


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: hys.LinearMpc(INTEGRATOR, "follow"), "kind is 'follow'"),
        (lambda: hys.LinearMpc("plant", "track"), "system is a str"),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", 0), "horizon is 0"),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", 2, control_horizon=3), "control_horizon is 3"),
        (
            lambda: hys.LinearMpc(INTEGRATOR, "track", 2, output_constraint_horizon=-1),
            "output_constraint_horizon is -1",
        ),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", 2, input_constraint_horizon=True), "input_constraint_horizon is T"),
        (lambda: hys.LinearMpc([INTEGRATOR], "track", 2), "model has 1 entries: 2 were expected"),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", backend="gurobi"), "backend is 'gurobi'"),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", cost=hys.Cost()), "cost is a Cost: a LinearCost"),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", cost=hys.LinearCost(x=1.0)), "the cost gives x"),
        (lambda: hys.LinearMpc(INTEGRATOR, "regulator", cost=hys.LinearCost(du=1.0)), "the cost gives du"),
        (
            lambda: hys.LinearMpc(INTEGRATOR, "regulator", cost=hys.LinearCost(x=[1, 2, 3])),
            r"weight x has shape \(3,\)",
        ),
        (lambda: hys.LinearMpc(INTEGRATOR, "regulator", cost=hys.LinearCost(x=-1.0)), "at least 0 was expected"),
        (lambda: hys.LinearMpc(INTEGRATOR, "regulator", cost=hys.LinearCost(x=np.zeros((3, 2, 2)))), "has 3 matrices"),
        (lambda: hys.LinearMpc(INTEGRATOR, "regulator", cost=hys.LinearCost(terminal="dare")), "terminal is 'dare'"),
        (lambda: hys.LinearMpc(INTEGRATOR, "regulator", cost=hys.LinearCost(u=0.0)), "not positive definite"),
        (
            lambda: hys.LinearMpc(INTEGRATOR, "regulator", cost=hys.LinearCost(terminal="lyap")),
            r"A is not stable \(spectral radius 1\)",
        ),
        (
            lambda: hys.LinearMpc(hys.Lti([[2.0]], [[0.0]]), "regulator"),
            "do not reach the unstable mode with the eigenvalue 2",
        ),
        (
            lambda: hys.LinearMpc(hys.Lti([[0.5]], [[1.0]], f=[1.0]), "regulator"),
            "it does not rest at the origin",
        ),
        (
            lambda: hys.LinearMpc(
                INTEGRATOR, "regulator", 3, hys.LinearCost(terminal=np.eye(2), gain=[[1.0]]), control_horizon=1
            ),
            r"gain has shape \(1, 1\)",
        ),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", limits=hys.LinearLimits(u=(1, -1))), r"limit u of u1 is \[1, -1\]"),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", limits=hys.LinearLimits(u={"v": (0, 1)})), "no signal named v"),
        (
            lambda: hys.LinearMpc(INTEGRATOR, "track", limits=hys.LinearLimits(y=([0, 0, 0], 1))),
            "no vector of 2 numbers",
        ),
        (
            lambda: hys.LinearMpc(INTEGRATOR, "track", limits=hys.LinearLimits(u="low")),
            r"or \(low, high\) was expected",
        ),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", limits=hys.LinearLimits(rho=0)), "rho is 0: a positive number"),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", limits=hys.LinearLimits(slack="each")), "slack is 'each'"),
        (
            lambda: hys.LinearMpc(INTEGRATOR, "track", limits=hys.LinearLimits(terminal={"x1": (0, 1)})),
            "a terminal set belongs to a regulator",
        ),
        (
            lambda: hys.LinearMpc(INTEGRATOR, "regulator", limits=hys.LinearLimits(y=(1, 2), terminal="invariant")),
            "the origin is not strictly inside the limits",
        ),
        (lambda: hys.LinearMpc(INTEGRATOR, "track", fallback="soft"), "no limit of a state or output is given"),
    ],
)
def test_wrong_arguments(make, message):
    with pytest.raises(hys.ArgumentError, match=message):
        make()


def test_a_gain_that_nothing_needs_is_not_asked_for():
    stuck = hys.Lti([[2.0]], [[0.0]])
    assert not is_stabilisable(stuck.A, stuck.B)
    assert hys.LinearMpc(stuck, "regulator", 2, hys.LinearCost(terminal=1.0)).solve([1.0]).ok


def test_wrong_calls():
    mpc = hys.LinearMpc(INTEGRATOR, "track", references=("x1",))
    with pytest.raises(hys.ArgumentError, match=r"last_input is missing.*\(u1\)"):
        mpc.solve([0, 0], [1.0])
    with pytest.raises(hys.ArgumentError, match="no reference for x1"):
        mpc.solve([0, 0], None, [0.0])
    with pytest.raises(hys.ArgumentError, match="state x2 is nan"):
        mpc.solve([0, np.nan], [1.0], [0.0])
    with pytest.raises(hys.ArgumentError, match=r"the state has shape \(3,\)"):
        mpc.solve([0, 0, 0], [1.0], [0.0])


@pytest.mark.parametrize(
    ("horizon", "free", "limits", "start"),
    [(5, 2, {"u": (-0.4, 0.4), "y": (-5, 5)}, (-4, 4)), (4, None, {"u": (-1, 1), "du": (-0.3, 0.3)}, (-5, 5))],
)
def test_with_an_invariant_set_every_later_step_has_a_plan(horizon, free, limits, start):
    terminal = hys.LinearLimits(**limits, terminal="invariant", rho=np.inf)
    mpc = hys.LinearMpc(INTEGRATOR, "regulator", horizon, limits=terminal, control_horizon=free)
    assert mpc.horizons.inputs == horizon - (0 if "du" in limits else 1)
    with_plan = 0
    for pos in np.linspace(*start, 9):
        for vel in np.linspace(-1.2, 1.2, 5):
            x, move = np.array([pos, vel]), mpc.solve([pos, vel], None, [0.0])
            with_plan += move.ok
            for _ in range(4 * move.ok):
                x = INTEGRATOR.A @ x + INTEGRATOR.B @ move.u
                move = mpc.solve(x, None, move.u)
                assert move.ok, move.message
    assert with_plan > 5


@pytest.mark.parametrize("gain", [[1.0], [[np.nan, 1.0]]])
def test_a_wrong_gain_is_refused_where_no_plan_uses_it(gain):
    with pytest.raises(hys.ArgumentError, match="gain has shape"):
        hys.LinearMpc(INTEGRATOR, "regulator", 3, hys.LinearCost(gain=gain))
