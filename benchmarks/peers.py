"""Other solvers on our mixed-integer quadratic programs: the same matrices, one thread, the same gap.

Times are processor times of the search alone; building a peer's model is not counted. The constant of the cost is part
of each objective, so that a relative gap means the same everywhere. Feasibility tolerances are as tight as each solver
allows: a threshold of a hybrid model has a gap of 1e-6, and with a tolerance of the same size both of its sides pass.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np
import scip

from hysdel_py.optimize.miqp import Miqp

GAP_ABS = 1e-5
FEASIBILITY = 1e-9
SCIP_FEASIBILITY = 1e-8
"""Tighter ones make its linear programs fail."""
CPLEX_TOO_LARGE = 1016
GUROBI_TOO_LARGE = 10010


class TooLarge(Exception):  # noqa: N818  not an error: an edition that is limited in size
    """The program is larger than the installed edition of a solver accepts."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What a solver said: cost, whether proven within the gap, nodes, seconds."""

    cost: float
    proven: bool
    infeasible: bool
    nodes: int
    seconds: float


Solve = Callable[[Miqp, float, float], Answer]


def available() -> dict[str, Solve | None]:
    """The peers by name; None for those that are not installed."""
    known: dict[str, tuple[str, Solve]] = {
        "gurobi": ("gurobipy", gurobi), "cplex": ("cplex", cplex), "scip": ("pyscipopt", solve_scip),
    }  # fmt: skip
    return {name: solve if find_spec(module) else None for name, (module, solve) in known.items()}


def solve_scip(miqp: Miqp, gap: float, seconds: float) -> Answer:
    """SCIP; its relative gap alone ends the search."""
    found = scip.solve(miqp, gap_rel=gap, time_limit=seconds, feasibility=SCIP_FEASIBILITY)
    proven = found.status in ("optimal", "gaplimit")
    return Answer(found.cost, proven, found.status == "infeasible", found.nodes, found.processor)


def gurobi(miqp: Miqp, gap: float, seconds: float) -> Answer:
    """Gurobi through gurobipy; the edition of the package index takes 2,000 variables and rows, 200 when quadratic."""
    import gurobipy as grb

    qp = miqp.qp
    with grb.Env(params={"OutputFlag": 0}) as environment, grb.Model(env=environment) as model:
        parameters = {
            "Threads": 1, "MIPGap": gap, "MIPGapAbs": GAP_ABS, "TimeLimit": seconds,
            "FeasibilityTol": FEASIBILITY, "IntFeasTol": FEASIBILITY, "OptimalityTol": FEASIBILITY,
        }  # fmt: skip
        for name, value in parameters.items():
            model.setParam(name, value)
        kinds = np.full(qp.n, grb.GRB.CONTINUOUS)
        kinds[miqp.binaries] = grb.GRB.BINARY
        v = model.addMVar(qp.n, lb=qp.lb, ub=qp.ub, vtype=kinds)
        A, above, below = qp.A.tocsr(), np.isfinite(qp.u), np.isfinite(qp.l)
        model.addConstr(A[above] @ v <= qp.u[above])
        model.addConstr(A[below] @ v >= qp.l[below])
        model.setObjective(0.5 * (v @ qp.P @ v) + qp.q @ v + qp.constant)
        start = time.process_time()
        try:
            model.optimize()
        except grb.GurobiError as error:
            if error.errno == GUROBI_TOO_LARGE:
                raise TooLarge from None
            raise
        took = time.process_time() - start
        cost = model.ObjVal if model.SolCount else np.inf
        infeasible = model.Status in (grb.GRB.INFEASIBLE, grb.GRB.INF_OR_UNBD)
        return Answer(cost, model.Status == grb.GRB.OPTIMAL, infeasible, int(model.NodeCount), took)


def cplex(miqp: Miqp, gap: float, seconds: float) -> Answer:
    """CPLEX; the edition of the package index takes 1,000 variables and rows."""
    import cplex as cpx

    with cpx.Cplex() as model:
        _quiet(model)
        _cplex_settings(model, gap, seconds)
        _cplex_problem(model, cpx, miqp)
        start = time.process_time()
        try:
            model.solve()
        except cpx.exceptions.CplexSolverError as error:
            if error.args[2] == CPLEX_TOO_LARGE:
                raise TooLarge from None
            raise
        took = time.process_time() - start
        status = model.solution.get_status_string()
        cost = model.solution.get_objective_value() if model.solution.is_primal_feasible() else np.inf
        nodes = model.solution.progress.get_num_nodes_processed()
        return Answer(cost, "optimal" in status, "infeasible" in status, int(nodes), took)


def _quiet(model: Any) -> None:
    for stream in (model.set_log_stream, model.set_error_stream, model.set_warning_stream, model.set_results_stream):
        stream(None)


def _cplex_settings(model: Any, gap: float, seconds: float) -> None:
    p = model.parameters
    p.threads.set(1)
    p.timelimit.set(seconds)
    p.mip.tolerances.mipgap.set(gap)
    p.mip.tolerances.absmipgap.set(GAP_ABS)
    p.mip.tolerances.integrality.set(0.0)
    p.simplex.tolerances.feasibility.set(FEASIBILITY)


def _cplex_problem(model: Any, cpx: Any, miqp: Miqp) -> None:
    qp, inf = miqp.qp, cpx.infinity
    kinds = ["C"] * qp.n
    for i in miqp.binaries:
        kinds[i] = "B"
    model.variables.add(
        obj=qp.q.tolist(), lb=np.clip(qp.lb, -inf, inf).tolist(), ub=np.clip(qp.ub, -inf, inf).tolist(),
        types="".join(kinds),
    )  # fmt: skip
    A = qp.A.tocsr()
    for ends, sense in ((qp.u, "L"), (qp.l, "G")):
        rows = np.flatnonzero(np.isfinite(ends))
        pairs = [_pair(cpx, A, row) for row in rows]
        model.linear_constraints.add(lin_expr=pairs, senses=sense * len(rows), rhs=ends[rows].tolist())
    P = qp.P.tocsr()
    model.objective.set_quadratic([_pair(cpx, P, row) for row in range(qp.n)])
    model.objective.set_offset(float(qp.constant))


def _pair(cpx: Any, matrix: Any, row: int) -> Any:
    entries = slice(matrix.indptr[row], matrix.indptr[row + 1])
    return cpx.SparsePair(matrix.indices[entries].tolist(), matrix.data[entries].tolist())
