"""Checks of single facts, one function per kind.

A fact that does not hold raises an AssertionError with the difference; one that the package cannot judge yet raises
NotSupported.
"""

from __future__ import annotations

import numpy as np
from fact_controllers import mpc_eval, pwa_mpc_cost, simulate
from fact_explicit import mplp_param_cost, mplp_regions, mpqp_regions
from fact_hybrid_laws import pwa_mpc_explicit
from fact_tools import Fact, NotSupported, array, close

from hysdel_py.geometry.polyhedron import Polyhedron
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


# ------------------------------------------------------------------ polyhedra


def region(p: Fact) -> Polyhedron:
    """Bounds (None for a missing one), rows and equalities as one polyhedron."""
    n = len(p["lb"] if "lb" in p else p["A"][0])
    rows, sides = [np.zeros((0, n))], [np.zeros(0)]
    for key, sign in (("ub", 1.0), ("lb", -1.0)):
        for i, end in enumerate(p.get(key) or ()):
            if end is not None:
                rows.append(sign * np.eye(n)[[i]])
                sides.append(np.array([sign * end]))
    if "A" in p:
        rows.append(array(p["A"]))
        sides.append(array(p["b"]).ravel())
    if p.get("C") is not None:
        C, d = array(p["C"]), array(p["d"]).ravel()
        rows += [C, -C]
        sides += [d, -d]
    return Polyhedron(np.vstack(rows), np.concatenate(sides))


def polyhedron(fact: Fact) -> str:
    expected = fact["expected"]
    for entry, check in POLYHEDRA.items():
        if entry in expected:
            check(fact["problem"], expected, fact["tolerance"])
            return entry
    raise NotSupported("an operation that geometry/polyhedron.py does not have")


def check_empty(p, expected, _):
    found = [region(case).is_empty for case in p.get("cases", [p])]
    assert found == list(np.atleast_1d(expected["empty"])), f"empty is {found}, expected {expected['empty']}"


def check_radius(p, expected, tolerance):
    if p.get("C") is not None:
        raise NotSupported("the largest ball inside a flat set")
    ball = region(p).ball
    close(ball.radius, expected["radius"], tolerance, "radius")
    if "center" in expected:
        close(ball.centre, expected["center"], tolerance, "centre")
    for entry in expected.get("center_partial", ()):
        close(ball.centre[entry["index"]], entry["value"], tolerance, "centre")


def check_contains(p, expected, tolerance):
    for name, case in (("without", {"lb": p["lb"], "ub": p["ub"]}), ("with", p)):
        found = [region(case).contains(point, tolerance) for point in p["points"]]
        assert found == expected[f"{name}_equality"], f"contains is {found} {name} the equality"


def check_minimal(p, expected, _):
    rows = list(region(p).irredundant_rows())
    assert rows in expected["minimal_facets_any_of"], (
        f"rows {rows}, expected one of {expected['minimal_facets_any_of']}"
    )


def check_intersection(p, expected, tolerance):
    both = region(p["p1"]) & region(p["p2"])
    low, high = both.bounding_box
    close([low, high], [expected["intersection"]["lb"], expected["intersection"]["ub"]], tolerance, "intersection")
    assert both.minimal().m == expected["n_facets"]
    assert (region({**p["p1"], **p["eq_on_p1"]}) & region(p["p2"])).is_empty == expected["empty_with_eq"]


def check_bounded(p, expected, _):
    found = [is_bounded(one_sided(case, p["n"])) for case in p["cases"]]
    assert found == expected["bounded"], f"bounded is {found}, expected {expected['bounded']}"
    assert is_bounded(region(p["case_3d"])) == expected["bounded_3d"]


def one_sided(case, n):
    return region({"lb": case["lb"], "ub": case.get("ub", [None] * n)})


def is_bounded(polyhedron):
    return polyhedron.is_empty or all(
        polyhedron.maximise(sign * row).is_optimal for row in np.eye(polyhedron.n) for sign in (1, -1)
    )


POLYHEDRA = {
    "empty": check_empty,
    "radius": check_radius,
    "without_equality": check_contains,
    "minimal_facets_any_of": check_minimal,
    "intersection": check_intersection,
    "bounded": check_bounded,
}


def pwa(fact: Fact) -> str:
    """Whether the interiors of no two regions meet."""
    p, expected = fact["problem"], fact["expected"]
    for name in ("overlapping", "touching"):
        parts = [region(part) for part in p[name]]
        meet = [a & b for i, a in enumerate(parts) for b in parts[i + 1 :]]
        found = all(both.is_empty or both.is_flat for both in meet)
        assert found == expected[f"well_posed_{name}"], f"well posed is {found} for the {name} regions"
    return "2 partitions"


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
    "pwa": pwa,
}
