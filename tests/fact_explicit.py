"""Checks of facts about explicit laws: the program as it is stated, and the controller behind it where it is known."""

from __future__ import annotations

import numpy as np
from fact_tools import Fact, NotSupported, array, close

from hysdel_py.control.explicit import explicit
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.linear_cost import LinearCost
from hysdel_py.control.linear_limits import LinearLimits
from hysdel_py.control.linear_mpc import LinearMpc
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.mpqp import MpQp, solve_mpqp
from hysdel_py.systems.lti import Lti

FAR = 1e4
"""Size of the box of parameters where a fact gives none."""


def mpqp_regions(fact: Fact) -> str:
    law = stated_law(fact)
    compare(law, fact, values=("J", "V", "z_objective"))
    system = fact["problem"].get("system")
    if system is None:
        return f"{law.count} regions"
    compare(clutch_law(system) if "Ts" in system else regulator_law(fact["problem"]), fact)
    return f"{law.count} regions, stated and from the controller"


# ------------------------------------------------------------------ the program as it is stated


def stated_law(fact: Fact) -> ExplicitLaw:
    problem = inner_product(fact["problem"]) if "A_u" in fact["problem"] else with_matrices(fact["problem"])
    solution = solve_mpqp(problem)
    assert solution.complete, "the map is not complete"
    return ExplicitLaw.of(solution)


def with_matrices(p: Fact) -> MpQp:
    """``min 1/2 z'Hz + (F x)'z + f'z`` with ``G z <= W + E x``; where Y is missing, F is stated for x'F z."""
    G, E = array(p["G"]), array(p["E"])
    n, q = G.shape[1], E.shape[1]
    H, F = array(p.get("H", np.zeros((n, n)))), array(p.get("F", np.zeros((q, n))))
    F = F.T if "Y" not in p else F
    theta = Polyhedron(array(p["xA"]), array(p["xb"]))
    return MpQp(H, array(p.get("f", np.zeros(n))), F, G, array(p["W"]), E, theta, Y=p.get("Y"))


def inner_product(p: Fact) -> MpQp:
    """``min 1/2 u'u`` with ``A_u u + A_x x <= b``; rows without u bound the parameter."""
    A_u, A_x, b = array(p["A_u"]), array(p["A_x"]), array(p["b"])
    own = ~A_u.any(axis=1)
    theta = Polyhedron(A_x[own], b[own])
    n, q = A_u.shape[1], A_x.shape[1]
    return MpQp(np.eye(n), np.zeros(n), np.zeros((n, q)), A_u[~own], b[~own], -A_x[~own], theta)


# ------------------------------------------------------------------ the controllers behind the programs


def regulator_law(p: Fact) -> ExplicitLaw:
    """The regulator of a fact, over the same box as its program."""
    system = p["system"]
    A, B, Q, R = (array(system[key]) for key in "ABQR")
    N = system.get("N", len(p["G"][0]))
    lti = Lti(A, B, system.get("C"))
    if "umin" not in system:
        return explicit(weighted_from_one(lti, N, Q, R), parameters_of(p))
    ends = [system.get(f"y{end}", system.get(f"x{end}")) for end in ("min", "max")]
    limits = {"u": (system["umin"], system["umax"]), "y": tuple(ends), "rho": np.inf}
    if "terminal_set" in system:
        terminal = "lqr" if system["P_N"] is None else array(system["P_N"])
        cost, limits["terminal"], last = LinearCost(x=Q, u=R, terminal=terminal, gain="lqr"), "invariant", N - 1
    else:
        cost, last = LinearCost(x=Q, u=R, terminal=np.zeros_like(Q)), N
    mpc = LinearMpc(
        lti, "regulator", N, cost, LinearLimits(**limits), output_constraint_horizon=last, constrain_first_output=True
    )
    return explicit(mpc, parameters_of(p))


def parameters_of(p: Fact) -> Polyhedron:
    """The box of the program with its rows that hold no variable: some originals bound the state beyond its limits."""
    own = ~array(p["G"]).any(axis=1)
    return Polyhedron(array(p["xA"]), array(p["xb"])).with_rows(-array(p["E"])[own], array(p["W"])[own])


def weighted_from_one(lti: Lti, N: int, Q: np.ndarray, R: np.ndarray) -> LinearMpc:
    """The measured state has no weight, the last one that of the others; |x| <= 10 and |u| <= 5."""
    cost = LinearCost(x=np.array([0.0 * Q, *[Q] * (N - 1)]), u=R, terminal=Q)
    limits = LinearLimits(u=(-5, 5), y=(-10, 10), rho=np.inf)
    return LinearMpc(lti, "regulator", N, cost, limits, output_constraint_horizon=N, constrain_first_output=True)


def clutch_law(system: Fact) -> ExplicitLaw:
    """Tracking of engine speed and slip by increments of the clutch force."""
    lti = Lti.sampled(system["A_continuous"], system["B_continuous"], system["C"], ts=system["Ts"])
    close(lti.A, system["A"], 1e-12, "A")
    close(lti.B, system["B"], 1e-12, "B")
    box = {"x": ([80, 0, 50], [150, 150, 150]), "u": (0, 180), "r": ([90, 0], [140, 1])}
    plain = clutch_controller(lti, 1.0)
    return explicit(clutch_controller(lti, 1e4 * plain.program.H[0, 0] / 2), box)


def clutch_controller(lti: Lti, rho: float) -> LinearMpc:
    limits = LinearLimits(du=(-8, 8), u=(0, 180), y=([80, 0], [150, 150]), rho=rho)
    cost = LinearCost(y=[1, 20], du=0)
    return LinearMpc(
        lti, "track", 10, cost, limits,
        control_horizon=1, output_constraint_horizon=2, input_constraint_horizon=1,
    )  # fmt: skip


# ------------------------------------------------------------------ comparison


def compare(law: ExplicitLaw, fact: Fact, values: tuple[str, ...] = ("J", "V")) -> None:
    """Regions, moves and values; a value without the terms of the parameters alone is that of the stated program."""
    expected, tolerance = fact["expected"], fact["tolerance"]
    assert law.complete, "the map is not complete"
    assert law.count == expected["n_regions"], f"{law.count} regions, expected {expected['n_regions']}"
    for point in (*expected.get("evaluations", ()), *expected.get("u0_at", ()), *expected.get("at", ())):
        compare_point(law, point, tolerance, values)
    table = np.column_stack([law.K[:, 0], law.k[:, 0]])
    for published in expected.get("laws_du", ()):
        row = np.array([*published["F"], published["g"]])
        gap = np.abs(table - row) / np.maximum(1.0, np.abs(row))
        assert gap.max(axis=1).min() <= tolerance, f"no region has the law {row.tolist()}"


def compare_point(law: ExplicitLaw, point: Fact, tolerance: float, values: tuple[str, ...]) -> None:
    theta = np.atleast_1d(array(point["x"]))
    z = law.solution(theta)
    first = point.get("u0", point.get("u", 0.0))
    if first is None:
        assert z is None, f"at {theta} there is {z}, nothing was expected"
        return
    assert z is not None, f"at {theta} there is nothing, {first} was expected"
    if "u0" in point or "u" in point:
        close(z[:1], np.atleast_1d(first)[:1], 10 * tolerance, f"first move at {theta}")
    if "z" in point:
        close(z, point["z"], 10 * tolerance, f"moves at {theta}")
    for key in values:
        if point.get(key) is not None:
            close(law.value(theta), point[key], tolerance, f"value at {theta}")


# ------------------------------------------------------------------ linear programs


def mplp_regions(fact: Fact) -> str:
    law = stated_law(fact)
    compare(law, fact)
    return f"{law.count} regions"


def mplp_param_cost(fact: Fact) -> str:
    """``min x1 - 2 x2 t + t`` with ``x1 - x2 >= t, x1 >= 0, x2 >= 0`` for t in [-1, 1]."""
    problem = MpQp(
        H=np.zeros((2, 2)), f=[1.0, 0.0], F=[[0.0], [-2.0]], G=[[-1.0, 1.0], [-1.0, 0.0], [0.0, -1.0]],
        w=[0.0, 0.0, 0.0], S=[[-1.0], [0.0], [0.0]], theta=Polyhedron.box([-1.0], [1.0]), y=[1.0],
    )  # fmt: skip
    law = ExplicitLaw.of(solve_mpqp(problem), names=("t",))
    expected = fact["expected"]
    assert law.count == expected["n_regions"], f"{law.count} regions, expected {expected['n_regions']}"
    for entry in expected["values"]:
        close(law.value([entry["th"]]), entry["J"], fact["tolerance"], f"value at {entry['th']}")
    assert law([0.6]) is None, "the program is unbounded above 0.5"
    return f"{law.count} regions"


# ------------------------------------------------------------------ single controllers


def soft_state(fact: Fact) -> str:
    """Each time has its own slack with a linear price, time 0 included; the measured state pays for its own."""
    p, expected, tolerance = fact["problem"], fact["expected"], fact["tolerance"]
    if "x_k<=1+s_k" not in p["soft"].replace(" ", ""):
        raise NotSupported("another form of soft limits")
    cost = LinearCost(x=p["Q"], u=p["R"], terminal=[[0.0]])
    limits = LinearLimits(x=(-1, 1), rho=0.0, rho_linear=1e4, slack="stage")
    mpc = LinearMpc(Lti(p["A"], p["B"], p["C"]), "regulator", p["N"], cost, limits, constrain_first_output=True)
    move = mpc.solve(p["x0"])
    assert move.ok, move.message
    close(move.predicted.u[:, 0], expected["U"], 10 * tolerance, "inputs")
    close(move.cost, expected["cost"], tolerance, "cost")
    return "inputs and cost"


def terminal_penalty(fact: Fact) -> None:
    """The plan of a regulator whose last state costs what the optimal gain would make it cost."""
    p, expected, tolerance = fact["problem"], fact["expected"], fact["tolerance"]
    mpc = LinearMpc(Lti(p["A"], p["B"]), "regulator", p["N"], LinearCost(x=p["Q"], u=p["R"]))
    close(mpc.weights.P, expected["P"], tolerance, "Riccati matrix")
    close(mpc.solve(p["x0"]).u[0], expected["u0"], 10 * tolerance, "first input")
