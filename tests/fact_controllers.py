"""Checks of facts about controllers and simulations."""

from __future__ import annotations

import numpy as np
from fact_explicit import soft_state, terminal_penalty
from fact_tools import Fact, NotSupported, close
from pwa_form import Box, Mode, mld_of_modes
from scipy.linalg import expm, solve_discrete_are

from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import MoveStatus

TIGHT = {"gap_rel": 1e-9, "gap_abs": 1e-8}


# ------------------------------------------------------------------ predictive control of piecewise affine systems


def pwa_mpc_cost(fact: Fact) -> str:
    p = fact["problem"]
    return pendulum(fact) if "K" in p else sampled_costs(fact)


def modes_of(p: Fact) -> list[Mode]:
    return [
        Mode(*(np.array(m[key], dtype=float) for key in ("A", "B", "f", "guardX", "guardU", "guardC")))
        for m in p["modes"]
    ]


def state_box(p: Fact, C: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Declared range of the state: its own limits, or those of outputs that are the states."""
    if p["xmin"] is not None:
        return np.array(p["xmin"], dtype=float), np.array(p["xmax"], dtype=float)
    if not np.array_equal(C, np.eye(len(C))):
        raise NotSupported("states without limits")
    return np.array(p["ymin"], dtype=float), np.array(p["ymax"], dtype=float)


def sampled_costs(fact: Fact) -> str:
    """Costs at given states, whose own weight |Q x_0| the controller leaves out."""
    mpc, weight = sampled_controller(fact["problem"])
    for sample in fact["expected"]["samples"]:
        compare_sample(mpc, sample, weight, fact["tolerance"])
    return f"{len(fact['expected']['samples'])} states"


def sampled_controller(p: Fact) -> tuple[HybridMpc, tuple[np.ndarray, float]]:
    """The controller, and the weight and norm of the measured state."""
    first = p["modes"][0]
    if any(m[key] != first[key] for m in p["modes"] for key in "CDg"):
        raise NotSupported("outputs that differ between modes")
    C, D, g = (np.array(first[key], dtype=float) for key in "CDg")
    u = np.array(p["umin"], dtype=float), np.array(p["umax"], dtype=float)
    mld = mld_of_modes(modes_of(p), Box(state_box(p, C), u, tuple(p["binary_inputs_0based"])), C, D, g)
    norm = float(p["norm"])
    Q, R, P = (np.array(p[key], dtype=float) for key in ("Q", "R", "P_N"))
    limits = Limits(y={v.name: ends for v, *ends in zip(mld.y, p["ymin"], p["ymax"], strict=True)})
    return HybridMpc(mld, p["N"], Cost(x=Q, u=R, terminal=P, norm=norm), limits, **TIGHT), (Q, norm)


def own_cost(x, weight):
    Q, norm = weight
    return x @ Q @ x if norm == 2 else np.linalg.norm(Q @ x, norm)


def compare_sample(mpc, sample, weight, tolerance):
    x = np.array(sample["x"], dtype=float)
    move = mpc.solve(x, warm=False)
    if not sample["feasible"]:
        assert move.status is MoveStatus.INFEASIBLE, f"at {x}: {move.message}, expected infeasible"
        return
    assert move.ok, f"at {x}: {move.message}"
    close(move.cost + own_cost(x, weight), sample["J"], tolerance, f"cost at {x}")


def pendulum(fact: Fact) -> str:
    """The cost is halved, the modes are boxes, the last state lies in a polytope."""
    p, tolerance = fact["problem"], fact["tolerance"]
    low, high = (np.array([m[end] for m in p["modes"]], dtype=float) for end in ("lb", "ub"))
    eye, none = np.vstack([np.eye(2), -np.eye(2)]), np.zeros((4, 1))
    modes = [
        Mode(np.array(m["A"]), np.array(m["B"]), np.array(m["c"], dtype=float), eye, none, np.concatenate([b, -a]))
        for m, a, b in zip(p["modes"], low, high, strict=True)
    ]
    u = np.array(p["umin"], dtype=float), np.array(p["umax"], dtype=float)
    mld = mld_of_modes(modes, Box((low.min(axis=0), high.max(axis=0)), u), np.eye(2), np.zeros((2, 1)), np.zeros(2))
    terminal = np.array(p["terminal_set"]["H"]), np.array(p["terminal_set"]["h"])
    Q, R, P = (np.array(p[key], dtype=float) for key in "QRP")
    mpc = HybridMpc(mld, p["N"], Cost(x=Q, u=R, terminal=P), Limits(terminal=terminal), **TIGHT)
    states = {"at_0_06": [0, 0.6], "at_0_08": [0, 0.8], "at_009_02": [0.09, 0.2]}
    for name, x in states.items():
        compare_pendulum(mpc.solve(x, warm=False), np.array(x), Q, fact["expected"][name], tolerance)
    return f"{len(states)} states"


def compare_pendulum(move, x, Q, expected, tolerance):
    assert move.ok, f"at {x}: {move.message}"
    close((move.cost + x @ Q @ x) / 2, expected["V"], tolerance, f"cost at {x}")
    u = expected.get("u", [expected["u0"]] if "u0" in expected else [])
    close(move.predicted.u[: len(u), 0], u, 20 * tolerance, f"inputs at {x}")
    if "mode_sequence" in expected:
        found = move.predicted.d.argmax(axis=1).tolist()
        assert found == expected["mode_sequence"], f"modes {found}, expected {expected['mode_sequence']}"


# ------------------------------------------------------------------ single controllers


def box_of(p: Fact, nx: int, nu: int, wide: float = 1e3) -> Box:
    ends = {key: np.full(n, sign * wide) for key, n, sign in
            (("xmin", nx, -1), ("xmax", nx, 1), ("umin", nu, -1), ("umax", nu, 1))}  # fmt: skip
    given = {key: np.array(p[key], dtype=float) for key in ends if p.get(key) is not None}
    ends |= given
    return Box((ends["xmin"], ends["xmax"]), (ends["umin"], ends["umax"]))


def linear_mld(p: Fact, box: Box):
    A, B = np.array(p["A"], dtype=float), np.array(p["B"], dtype=float)
    nx, nu = B.shape
    mode = Mode(A, B, np.zeros(nx), np.zeros((0, nx)), np.zeros((0, nu)), np.zeros(0))
    return mld_of_modes([mode], box, np.eye(nx), np.zeros((nx, nu)), np.zeros(nx))


def mpc_eval(fact: Fact) -> str:
    p = fact["problem"]
    if p.get("u_binary"):
        return binary_input(fact)
    if "soft" in p:
        return soft_state(fact)
    return quadratic_controller(fact)


def binary_input(fact: Fact) -> str:
    """The cost is the sum of |x_k| + r |u_k| over k < N: the last state has no weight."""
    p, expected = fact["problem"], fact["expected"]
    box = box_of(p, 1, 1)
    mld = linear_mld(p, Box(box.x, (np.zeros(1), np.ones(1)), (0,)))
    price = p.get("price", 0.1)
    mpc = HybridMpc(mld, p["N"], Cost(x=[1.0], u=[price], terminal={}, norm=1), **TIGHT)
    move = mpc.solve(p["x0"])
    close(move.cost + np.abs(p["x0"]).sum(), expected["cost"], fact["tolerance"], "cost")
    close(move.predicted.u[:, 0], expected["U"], fact["tolerance"], "inputs")
    return "cost and inputs"


def quadratic_controller(fact: Fact) -> str:
    p, expected, tolerance = fact["problem"], fact["expected"], fact["tolerance"]
    A, B, Q, R = (np.array(p[key], dtype=float) for key in "ABQR")
    P = solve_discrete_are(A, B, Q, R)
    close(P, expected["P"], tolerance, "Riccati matrix")
    box = p.get("terminal_set")
    terminal = {f"x{i + 1}": ends for i, ends in enumerate(zip(box["lb"], box["ub"], strict=True))} if box else {}
    if "block_zero_based" not in p and box is None:
        terminal_penalty(fact)
    held = [{}] if "block_zero_based" not in p else [{"control_horizon": p["block_zero_based"][0] + 1}]
    for blocks in held:
        mpc = HybridMpc(
            linear_mld(p, box_of(p, *B.shape)), p["N"], Cost(x=Q, u=R, terminal=P), Limits(terminal=terminal),
            **blocks, **TIGHT,
        )  # fmt: skip
        move, x0 = mpc.solve(p["x0"]), np.array(p["x0"], dtype=float)
        assert move.ok, move.message
        u = np.array(expected.get("U", [expected.get("u0")]))
        close(move.predicted.u[: len(u), 0], u, 10 * tolerance, "inputs")
        if "cost" in expected:
            close(move.cost + x0 @ Q @ x0, expected["cost"], tolerance, "cost")
    return "inputs and cost"


def simulate(fact: Fact) -> str:
    p, expected = fact["problem"], fact["expected"]
    if "X" not in expected:
        return controllability(fact)
    mld = linear_mld(p, box_of(p, *np.array(p["B"]).shape))
    run = mld.simulate(p["x0"], np.array(p["U"], dtype=float).reshape(len(p["U"]), -1))
    close(run.x[:, 0], expected["X"], fact["tolerance"], "states")
    if "y_at_third_update" in expected:
        close(run.x[2] @ np.array(p["C"]).T, [expected["y_at_third_update"]], fact["tolerance"], "output")
    return f"{run.steps} steps"


def controllability(fact: Fact) -> str:
    """Rank of [B, AB, ...] of the sampled system: whether any state can be steered to any other."""
    p, expected = fact["problem"], fact["expected"]
    A = np.array(p["A"], dtype=float)
    for name in ("ok", "bad"):
        B = np.array(p[f"B_{name}"], dtype=float)
        held = expm(p["h"] * np.block([[A, B], [np.zeros((B.shape[1], len(A) + B.shape[1]))]]))
        Ad, Bd = held[: len(A), : len(A)], held[: len(A), len(A) :]
        reach = [Bd]
        for _ in A[1:]:
            reach.append(Ad @ reach[-1])
        found = np.linalg.matrix_rank(np.hstack(reach)) == len(A)
        assert found == expected[f"controllable_{name}"], f"controllable is {found} for B_{name}"
    return "2 input matrices"
