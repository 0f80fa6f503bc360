"""SCIP on our mixed-integer quadratic programs, for comparison."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from hysdel_py.optimize.miqp import Miqp


@dataclass(frozen=True)
class ScipAnswer:
    """Status in SCIP's words, cost, certified bound, nodes; seconds of clock and processor without the building."""

    status: str
    cost: float
    bound: float
    nodes: int
    seconds: float
    processor: float


def available() -> bool:
    """Whether pyscipopt is installed."""
    from importlib.util import find_spec

    return find_spec("pyscipopt") is not None


def solve(miqp: Miqp, *, gap_rel: float, time_limit: float, feasibility: float | None = None) -> ScipAnswer:
    """Solve once, cold, on one thread."""
    model = _model(miqp)
    model.setParam("limits/gap", gap_rel)
    model.setParam("limits/time", time_limit)
    if feasibility is not None:
        model.setParam("numerics/feastol", feasibility)
    start, processor = time.perf_counter(), time.process_time()
    try:
        model.optimize()
    except Exception as error:  # pyscipopt raises nothing more special
        print(f"SCIP gave up: {error}", file=sys.stderr)
        seconds, processor = time.perf_counter() - start, time.process_time() - processor
        return ScipAnswer("error", np.inf, -np.inf, 0, seconds, processor)
    seconds, processor = time.perf_counter() - start, time.process_time() - processor
    found = model.getNSols() > 0
    return ScipAnswer(
        model.getStatus(),
        model.getObjVal() if found else np.inf,
        model.getDualbound(),
        int(model.getNTotalNodes()),
        seconds,
        processor,
    )


def _model(miqp: Miqp) -> Any:
    import pyscipopt as scip

    qp, binary = miqp.qp, set(miqp.binaries.tolist())
    model = scip.Model()
    model.hideOutput()
    v = [model.addVar(lb=_end(qp.lb[i]), ub=_end(qp.ub[i]), vtype="B" if i in binary else "C") for i in range(qp.n)]
    A = qp.A.tocsr()
    for row in range(qp.m):
        entries = slice(A.indptr[row], A.indptr[row + 1])
        form = scip.quicksum(a * v[i] for i, a in zip(A.indices[entries], A.data[entries], strict=True))
        if np.isfinite(qp.u[row]):
            model.addCons(form <= qp.u[row])
        if np.isfinite(qp.l[row]):
            model.addCons(form >= qp.l[row])
    P = qp.P.tocoo()
    cost = model.addVar(lb=None)
    square = scip.quicksum(0.5 * p * v[i] * v[j] for p, i, j in zip(P.data, *P.coords, strict=True))
    model.addCons(square + scip.quicksum(c * v[i] for i, c in enumerate(qp.q) if c) <= cost)
    # With the constant inside, the relative gap of both solvers means the same.
    model.setObjective(cost + qp.constant)
    return model


def _end(bound: float) -> float | None:
    return float(bound) if np.isfinite(bound) else None
