"""Checks of single facts, one function per kind.

A fact that does not hold raises an AssertionError with the difference; one that the package cannot judge yet raises
NotSupported.
"""

from __future__ import annotations

import numpy as np
from fact_controllers import mpc_eval, pwa_mpc_cost, simulate
from fact_explicit import mplp_param_cost, mplp_regions, mpqp_regions
from fact_geometry import polyhedron, pwa, union
from fact_hybrid_laws import pwa_mpc_explicit
from fact_tools import Fact, array, close

from hysdel_py.optimize.miqp import Miqp, MiqpSettings, solve_miqp
from hysdel_py.optimize.qp import Qp
from hysdel_py.optimize.verified import solve_qp

# ------------------------------------------------------------------ programs


def program(p: Fact, extra: Fact | None = None) -> Qp:
    """``min 1/2 x'Hx + f'x`` with ``A x <= b, C x = d``."""
    extra = extra or {}
    n = len(p["f"])
    A, C = array(p.get("A"), n), array(extra.get("C", p.get("C", p.get("Ae"))), n)
    b, d = array(p.get("b")).ravel(), array(extra.get("d", p.get("d", p.get("be")))).ravel()
    free = np.full(n, np.inf)
    return Qp(
        array(p.get("H", np.zeros((n, n)))), p["f"], np.vstack([A, C]), np.concatenate([np.full(len(b), -np.inf), d]),
        np.concatenate([b, d]), -free, free,
    )  # fmt: skip


def miqp(fact: Fact) -> str:
    p = fact["problem"]
    for case, expected in zip(p["cases"], fact["expected"]["results"], strict=True):
        qp = program(p, case)
        result = solve_miqp(Miqp(qp, range(p["n_continuous"], qp.n)), MiqpSettings(gap_abs=1e-9, gap_rel=1e-9))
        if "status" in expected:
            assert result.status.value == expected["status"], f"{result.status.value}, expected {expected['status']}"
            continue
        close(result.objective, expected["obj"], fact["tolerance"], "objective")
        close(result.x, expected["x"], 10 * fact["tolerance"], "point")
    return f"{len(p['cases'])} cases"


def qp(fact: Fact) -> str:
    expected, tolerance = fact["expected"], fact["tolerance"]
    answer = solve_qp(program(fact["problem"]))
    assert answer.status.value == "optimal", answer.message
    close(answer.objective, expected["obj"], tolerance, "objective")
    if "x" in expected:
        close(answer.x, expected["x"], 10 * tolerance, "point")
    for entry in expected.get("x_partial", ()):
        close(answer.x[entry["index"]], entry["value"], 10 * tolerance, f"entry {entry['index']}")
    return "objective and point"


CHECKS = {
    "pwa_mpc_cost": pwa_mpc_cost,
    "pwa_mpc_explicit": pwa_mpc_explicit,
    "miqp": miqp,
    "qp": qp,
    "lp": qp,
    "mpc_eval": mpc_eval,
    "mpqp_regions": mpqp_regions,
    "mplp_regions": mplp_regions,
    "mplp_param_cost": mplp_param_cost,
    "simulate": simulate,
    "polyhedron": polyhedron,
    "union": union,
    "pwa": pwa,
}
