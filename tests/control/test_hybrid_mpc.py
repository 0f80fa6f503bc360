from __future__ import annotations

import itertools

import numpy as np
import piqp
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import MoveStatus

RNG_STATES = np.random.default_rng(5).uniform(-6, 6, 4)


# An independent optimum: every sequence of binaries, and a dense QP each that is built from the definitions only.


def quadratic(value, n):
    """Hessian, gradient and constant of a quadratic function, from its values."""
    unit, zero = np.eye(n), np.zeros(n)
    c = value(zero)
    single = np.array([value(e) for e in unit])
    double = np.array([[value(a + b) for a in unit] for b in unit])
    P = double - single[:, None] - single[None, :] + c
    return P, single - c - np.diag(P) / 2, c


def dense_qp(P, q, G, h, A, b):
    solver = piqp.DenseSolver()
    solver.settings.eps_abs, solver.settings.eps_rel = 1e-10, 1e-10
    free = np.full(len(h), -np.inf)
    solver.setup(P, q, A, b, G, free, h)
    if solver.solve().name != "PIQP_SOLVED":
        return np.inf
    return float(solver.result.info.primal_obj)


def stages(mld, N, x0, v):
    """Yield x, u, d, z, x1 of each stage of a stacked vector [u, d, z, x1] x N."""
    size = mld.nu + mld.nd + mld.nz + mld.nx
    x = x0
    for k in range(N):
        u, d, z, x1 = np.split(v[k * size : (k + 1) * size], np.cumsum([mld.nu, mld.nd, mld.nz]))
        yield x, u, d, z, x1
        x = x1


def model_rows(mld, N, x0, v, extra):
    """Values that must be 0 and values that must not be positive."""
    equal, below = [], []
    for x, u, d, z, x1 in stages(mld, N, x0, v):
        equal += list(mld.A @ x + mld.B1 @ u + mld.B2 @ d + mld.B3 @ z + mld.B5 - x1)
        below += list(mld.E2 @ d + mld.E3 @ z - mld.E1 @ u - mld.E4 @ x - mld.E5)
        for values, variables in ((u, mld.u), (d, mld.d), (z, mld.z), (x1, mld.x)):
            for value, var in zip(values, variables, strict=True):
                below += [value - var.high, var.low - value]
        below += extra(x, u, d, z, x1)
    return np.array(equal), np.array(below)


def enumerated_optimum(mld, N, x0, stage_cost, final_cost, extra=lambda *_: []):
    size = mld.nu + mld.nd + mld.nz + mld.nx
    n = N * size
    booleans = [i for i, var in enumerate((*mld.u, *mld.d, *mld.z, *mld.x)) if var.is_bool and i < mld.nu + mld.nd]

    def total(v):
        every = list(stages(mld, N, x0, v))
        return sum(stage_cost(k, *s[:4]) for k, s in enumerate(every)) + final_cost(every[-1][4])

    P, q, c = quadratic(total, n)
    zero = np.zeros(n)
    e0, g0 = model_rows(mld, N, x0, zero, extra)
    E = np.column_stack([model_rows(mld, N, x0, e, extra)[0] - e0 for e in np.eye(n)])
    G = np.column_stack([model_rows(mld, N, x0, e, extra)[1] - g0 for e in np.eye(n)])
    best = np.inf
    for word in itertools.product([0.0, 1.0], repeat=len(booleans) * N):
        columns = [k * size + i for k in range(N) for i in booleans]
        fixed = np.eye(n)[columns]
        value = dense_qp(P, q, G, -g0, np.vstack([E, fixed]), np.concatenate([-e0, word]))
        best = min(best, value + c)
    return best


@pytest.mark.parametrize("backend", ["dense", "piqp", "osqp"])
@pytest.mark.parametrize("x0", RNG_STATES)
def test_fold_equals_enumeration(systems, x0, backend):
    mld = systems.fold()
    mpc = HybridMpc(mld, 4, Cost(y={"seen": 1}, u={"push": 0.1}, terminal={"x": 3}), backend=backend, gap_rel=1e-6)
    move = mpc.solve([x0], {"seen": 1.0, "push": 0.2})
    expected = enumerated_optimum(
        mld, 4, np.array([x0]),
        lambda k, x, u, d, z: (x[0] - 1) ** 2 + 0.1 * (u[0] - 0.2) ** 2,
        lambda x: 3 * x[0] ** 2,
    )  # fmt: skip
    assert move.status is MoveStatus.OPTIMAL
    assert move.cost == pytest.approx(expected, rel=1e-5, abs=1e-5)
    assert move.bound <= expected + 1e-5
    assert move.gap == pytest.approx(move.cost - move.bound, abs=1e-9)


@settings(max_examples=15, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    x0=st.floats(-9, 9), right=st.floats(-0.9, 0.9), left=st.floats(-0.9, 0.9), target=st.floats(-5, 5),
    weights=st.tuples(st.floats(0, 3), st.floats(0.01, 3), st.floats(0, 3)), horizon=st.integers(1, 3),
)  # fmt: skip
def test_any_fold_equals_enumeration(systems, x0, right, left, target, weights, horizon):
    mld, (wx, wu, wz) = systems.fold(right, left), weights
    mpc = HybridMpc(mld, horizon, Cost(x={"x": wx}, u=[wu], z={"part": wz}, terminal={"x": 2.0}))
    move = mpc.solve([x0], {"x": target, "part": 0.5})
    expected = enumerated_optimum(
        mld, horizon, np.array([x0]),
        lambda k, x, u, d, z: (wx * (x[0] - target) ** 2 if k else 0) + wu * u[0] ** 2 + wz * (z[0] - 0.5) ** 2,
        lambda x: 2 * (x[0] - target) ** 2,
    )  # fmt: skip
    if move.status is MoveStatus.INFEASIBLE:  # the state lies in the gap of width epsilon below zero
        assert np.isinf(expected)
        return
    assert move.cost == pytest.approx(expected, rel=1e-4, abs=1e-4)
    for k in range(horizon):
        x1 = systems.fold_step(right, left)(move.predicted.x[k], move.predicted.u[k])[0]
        near_the_edge = abs(move.predicted.x[k, 0]) < 1e-5
        assert near_the_edge or x1 == pytest.approx(move.predicted.x[k + 1], abs=1e-5)


@pytest.mark.parametrize("on", [0.0, 1.0])
@pytest.mark.parametrize("temperature", [0.0, 9.0])
def test_heater_equals_enumeration_with_preview_and_limits(systems, temperature, on):
    mld, ref = systems.heater(), [4.0, 8.0, 2.0]
    cost = Cost(y={"felt": 2}, u={"switch": 0.3}, d={"heat": 0.5})
    mpc = HybridMpc(mld, 3, cost, Limits(y={"felt": (-1, 10)}), references=("felt",), gap_rel=1e-6)
    move = mpc.solve([temperature, on], {"felt": ref})
    expected = enumerated_optimum(
        mld, 3, np.array([temperature, on]),
        lambda k, x, u, d, z: 2 * (x[0] + 0.5 * u[0] - ref[k]) ** 2 + 0.3 * u[1] ** 2 + 0.5 * d[0] ** 2,
        lambda x: 0.0,
        extra=lambda x, u, d, z, x1: [x[0] + 0.5 * u[0] - 10, -1 - x[0] - 0.5 * u[0]],
    )  # fmt: skip
    assert np.isfinite(expected)
    assert move.cost == pytest.approx(expected, rel=1e-5, abs=1e-5)
    assert set(move.u[1:]) <= {0.0, 1.0}


def test_prediction_satisfies_the_model(systems):
    mld = systems.fold()
    p = HybridMpc(mld, 6, Cost(y={"seen": 1})).solve([-5.0], {"seen": 2.0}).predicted
    assert (p.x.shape, p.u.shape, p.y.shape, p.d.shape, p.z.shape) == ((7, 1), (6, 1), (6, 1), (6, 1), (6, 1))
    for k in range(6):
        x, u, d, z = p.x[k], p.u[k], p.d[k], p.z[k]
        assert mld.A @ x + mld.B1 @ u + mld.B2 @ d + mld.B3 @ z + mld.B5 == pytest.approx(p.x[k + 1], abs=1e-6)
        assert (mld.E2 @ d + mld.E3 @ z - mld.E1 @ u - mld.E4 @ x - mld.E5).max() < 1e-6
        assert p.y[k] == pytest.approx(p.x[k])
        assert set(d) <= {0.0, 1.0}
    assert p.names["z"] == ("part",)


def test_warm_and_cold_cost_agree(systems):
    step = systems.fold_step()
    warm, cold = (HybridMpc(systems.fold(), 5, Cost(y={"seen": 1}, u={"push": 0.05}), gap_rel=1e-6) for _ in range(2))
    x = np.array([8.0])
    for _ in range(6):
        a, b = warm.solve(x, {"seen": -3.0}), cold.solve(x, {"seen": -3.0}, warm=False)
        assert a.cost == pytest.approx(b.cost, rel=1e-5, abs=1e-6)
        x = step(x, a.u)[0]


def test_reset_forgets_the_plan(systems):
    mpc = HybridMpc(systems.fold(), 3, Cost(y={"seen": 1}))
    first = mpc.solve([4.0])
    mpc.solve([-4.0])
    mpc.reset()
    again = mpc.solve([4.0])
    assert again.cost == pytest.approx(first.cost, rel=1e-7)
    assert (again.nodes, again.qps) == (first.nodes, first.qps)


def test_hard_limits_hold(systems):
    mpc = HybridMpc(systems.fold(), 5, Cost(y={"seen": 1}), Limits(x={"x": (-10, 1.5)}, u={"push": (-0.7, 0.7)}))
    move = mpc.solve([-2.0], {"seen": 9.0})
    assert move.predicted.x[1:].max() <= 1.5 + 1e-6
    assert np.abs(move.predicted.u).max() <= 0.7


def test_infeasible_hard_limit_names_it_and_the_soft_one_costs_its_price(systems):
    limits = {"x": {"x": (-1, 1)}}
    hard = HybridMpc(systems.fold(), 3, Cost(y={"seen": 1}), Limits(**limits)).solve([-10.0])
    assert hard.status is MoveStatus.INFEASIBLE
    assert hard.u is None
    assert hard.predicted is None
    assert not hard.ok
    assert "x x in [-1, 1]" in hard.message
    assert "soft" in hard.message
    mpc = HybridMpc(systems.fold(), 3, Cost(), Limits(**limits, soft=True, rho=100.0))
    soft = mpc.solve([-10.0])
    assert soft.status is MoveStatus.OPTIMAL
    assert soft.slack["x"] == pytest.approx(6.0, abs=1e-4)  # -0.8 * 10 + 1 = -7 at best after one step
    assert soft.cost == pytest.approx(3600.0, rel=1e-4)


def test_terminal_polytope_holds_and_softens(systems):
    wall = ([[-1.0]], [0.5])  # -x_N <= 0.5
    hard = HybridMpc(systems.fold(), 2, Cost(y={"seen": 1}), Limits(terminal=wall)).solve([-2.0], {"seen": -9.0})
    assert hard.predicted.x[-1, 0] >= -0.5 - 1e-6
    far = HybridMpc(systems.fold(), 2, Cost(), Limits(terminal=wall)).solve([-10.0])
    assert far.status is MoveStatus.INFEASIBLE
    assert "terminal polytope" in far.message
    soft = HybridMpc(systems.fold(), 2, Cost(), Limits(terminal=wall, soft=("terminal",))).solve([-10.0])
    assert soft.slack["terminal"] == pytest.approx(4.1, abs=1e-4)  # x_2 = -0.8 * 7 + 1 = -4.6


def test_output_that_no_input_moves_now_is_reported_but_does_not_block(systems):
    mpc = HybridMpc(systems.fold(), 3, Cost(y={"seen": 1}), Limits(y={"seen": (-6, 6)}))
    move = mpc.solve([-8.0])
    assert move.status is MoveStatus.OPTIMAL or move.status is MoveStatus.INFEASIBLE
    assert move.ok
    assert "seen = -8 is outside its limit [-6, 6] now" in move.message


def test_output_limit_that_an_input_moves_holds_at_once(systems):
    mpc = HybridMpc(systems.heater(), 2, Cost(y={"felt": 1}), Limits(y={"felt": (-9, 9)}))
    move = mpc.solve([9.3, 0.0], {"felt": 50.0})
    assert move.predicted.y[0, 0] <= 9 + 1e-6
    blocked = mpc.solve([9.6, 0.0])
    assert blocked.status is MoveStatus.INFEASIBLE


@pytest.mark.parametrize("x", [10.01, -10.01])
def test_state_outside_its_range_is_refused_with_its_name(systems, x):
    move = HybridMpc(systems.fold(), 3, Cost()).solve([x])
    assert move.status is MoveStatus.INFEASIBLE
    assert move.u is None
    assert f"x = {x:g} is outside its range [-10, 10]" in move.message


def test_state_outside_by_less_than_the_tolerance_is_moved_onto_its_range(systems):
    move = HybridMpc(systems.fold(), 3, Cost(y={"seen": 1})).solve([10.0 + 1e-7])
    assert move.status is MoveStatus.OPTIMAL
    assert move.predicted.x[0, 0] == 10.0


def test_requirement_broken_by_the_measured_state_is_named(systems):
    must = systems.origin(line=31, text="MUST x <= 5;")
    rows = [([], [], [0], [-1], 5, must)]
    v, kinds = systems.variable, systems.fold()
    mld = systems.assemble(
        "must", (v("x", kinds.x[0].kind, -10, 10),), (v("u", kinds.u[0].kind, -1, 1),), (), (), (),
        ([[1]], [[1]], [], [], [0]), ([], [], [], [], []), rows,
    )  # fmt: skip
    mpc = HybridMpc(mld, 2, Cost(x={"x": 1}))
    assert mpc.solve([5.0]).ok
    move = mpc.solve([6.0])
    assert move.status is MoveStatus.INFEASIBLE
    assert "MUST x <= 5; (line 31)" in move.message


def test_node_limit_gives_the_best_plan_and_a_valid_gap(systems):
    def solve(**limit):
        mpc = HybridMpc(systems.heater(), 6, Cost(y={"felt": 1}, d={"heat": 3}), **limit)
        return mpc.solve([3.0, 1.0], {"felt": 6.1})

    best, capped = solve().cost, solve(node_limit=1)
    assert capped.status is MoveStatus.FEASIBLE
    assert capped.bound - 1e-6 <= best <= capped.cost + 1e-6
    assert capped.gap == pytest.approx(capped.cost - capped.bound)
    assert capped.gap > 0
    assert "node limit" in capped.message


def test_references_by_order_by_name_and_over_the_horizon_agree(systems):
    def cost(ref):
        mpc = HybridMpc(systems.heater(), 3, Cost(y={"felt": 1, "hot": 2}), references=("hot", "felt"))
        return mpc.solve([1.0, 1.0], ref).cost

    expected = cost({"felt": 3.0, "hot": 1.0})
    assert cost([1.0, 3.0]) == pytest.approx(expected)
    assert cost({"felt": [3.0] * 3, "hot": [1.0] * 4}) == pytest.approx(expected)
    assert cost({"felt": [3.0, 0.0, 3.0], "hot": 1.0}) > expected + 0.1


def test_model_with_an_mld_is_accepted(systems):
    class Model:
        mld = systems.fold()

    assert HybridMpc(Model(), 2, Cost(y={"seen": 1})).solve({"x": 1.0}).ok


def test_the_same_call_gives_the_same_answer(systems):
    moves = [HybridMpc(systems.heater(), 4, Cost(y={"felt": 1})).solve([3.0, 0.0], {"felt": 7.0}) for _ in range(2)]
    assert moves[0].cost == moves[1].cost
    assert np.array_equal(moves[0].predicted.u, moves[1].predicted.u)
