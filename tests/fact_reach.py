"""Checks of facts about reachable and feasible sets, minimum times and functions on sets."""

from __future__ import annotations

import numpy as np
from fact_geometry import region
from fact_tools import Fact, NotSupported, array, close

import hysdel_py as hys
from hysdel_py.analysis.quadratic_bound import Quadratic, is_nowhere_positive
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.relations import are_equal
from hysdel_py.optimize.mpqp import MpQp, solve_mpqp
from hysdel_py.systems.affine import Affine

WIDE = 1e3
"""Range of the states where the fact gives them none."""


def linear(A, B, low, high, x_low=-WIDE, x_high=WIDE) -> hys.Model:
    """``x+ = A x + B u`` as a model with inputs in a box."""
    nx, nu = array(B).shape
    states = " ".join(f"REAL x{i} [{x_low!r}, {x_high!r}];" for i in range(nx))
    inputs = " ".join(f"REAL u{j} [{low[j]!r}, {high[j]!r}];" for j in range(nu))
    rows = " ".join(
        f"x{i} = {' + '.join([f'({A[i][k]!r})*x{k}' for k in range(nx)] + [f'({B[i][j]!r})*u{j}' for j in range(nu)])};"
        for i in range(nx)
    )
    return hys.load(
        f"SYSTEM linear {{ INTERFACE {{ STATE {{ {states} }} INPUT {{ {inputs} }} }}"
        f" IMPLEMENTATION {{ CONTINUOUS {{ {rows} }} }} }}"
    )


def reach(fact: Fact) -> str:
    """The area and the corners of the states that get into a box in one step."""
    p, expected, tolerance = fact["problem"], fact["expected"], fact["tolerance"]
    model = linear(p["A"], p["B"], p["U"]["lb"], p["U"]["ub"])
    (piece,) = hys.reach_backward(model, region(p["X"]), 1).sets[1].pieces
    close(piece.region.volume, expected["area"], tolerance, "area")
    assert are_equal(piece.region, Polyhedron.hull(expected["vertices"]), tolerance)
    assert len(piece.region.minimal().vertices) == len(expected["vertices"])
    return "area and corners"


def feasible_set(fact: Fact) -> str:
    """The parameters of a linear program for which there is a point."""
    p, expected, tolerance = fact["problem"], fact["expected"], fact["tolerance"]
    A, S = array(p["A"]), array(p["pB"])
    n = A.shape[1]
    both = Polyhedron(np.hstack([A, -S]), array(p["b"]).ravel())
    found = both.project(range(n, n + S.shape[1])) & Polyhedron(array(p["Ath"]), array(p["bth"]).ravel())
    found = found.minimal()
    assert found.m == expected["feasible_set_inequalities"], f"{found.m} rows"
    close(found.bounding_box, [expected["bounding_box_lo"], expected["bounding_box_hi"]], tolerance, "box")
    for point in expected["membership"]:
        assert found.contains(point["x"], tolerance) == point["feasible"]
    return f"rows, box and {len(expected['membership'])} points"


def min_time(fact: Fact) -> str:
    """The number of steps that the farthest state needs into the terminal set, and the law of the last step."""
    p, expected = fact["problem"], fact["expected"]
    model = linear(p["A"], p["B"], p["umin"], p["umax"], p["xmin"][0], p["xmax"][0])
    found = hys.reach_backward(model, region(p["terminal"]), 5)
    whole = hys.reach_backward(model, {}, 0).sets[0]
    horizon = next(k for k in range(6) if found.sets[k].covers(whole))
    assert horizon == expected["horizon"], f"horizon {horizon}, expected {expected['horizon']}"
    regions = len(solve_mpqp(_into(p)).regions) + 1  # one more law within the terminal set
    assert regions == expected["regions_total"], f"{regions} regions"
    return "horizon and regions"


def _into(p) -> MpQp:
    """``min Q x(1)^2 + R u^2`` with x(1) in the terminal set, for a scalar integrator, over x(0)."""
    a, b, q, r = (float(array(p[key]).ravel()[0]) for key in "ABQR")
    if array(p["A"]).size != 1:
        raise NotSupported("more than one state")
    ends, inputs = p["terminal"], (p["umin"][0], p["umax"][0])
    G = np.array([[b], [-b], [1.0], [-1.0]])
    w = np.array([ends["ub"][0], -ends["lb"][0], inputs[1], -inputs[0]])
    S = np.array([[-a], [a], [0.0], [0.0]])
    box = Polyhedron.box(p["xmin"], p["xmax"])
    return MpQp(np.array([[2 * (q * b * b + r)]]), np.zeros(1), np.array([[2 * q * a * b]]), G, w, S, box)


def function(fact: Fact) -> str:
    """Values of affine functions at a point of a set."""
    p, expected, tolerance = fact["problem"], fact["expected"], fact["tolerance"]
    x = array(p["x"])
    if "form" not in p:
        assert Polyhedron(array(p["A"]), array(p["b"]).ravel()).contains(x) == expected["contains_x"]
        for name, rows in p["F"].items():
            forms = [Affine(0.0, tuple((str(i), c) for i, c in enumerate(row))) for row in rows]
            close([form.value({str(i): v for i, v in enumerate(x)}) for form in forms], expected[name], tolerance, name)
        return "three functions"
    return quadratic(fact)


def quadratic(fact: Fact) -> str:
    """The value of a quadratic function at a point of a box, and that its bounds on the box hold it."""
    p, expected = fact["problem"], fact["expected"]
    H, point, box = array(p["H"]), array(p["x"]), Polyhedron.box(p["lb"], p["ub"])
    found = Quadratic((H + H.T) / 2, array(p["F"]).ravel(), float(p["g"]))
    close(found(point[None])[0], expected["value"], fact["tolerance"], "value")
    assert box.contains(point)
    lowered = Quadratic(found.H, found.g, found.c - expected["value"] + 0.1)
    assert not is_nowhere_positive(lowered, box, fact["tolerance"], 1000).holds
    return "a quadratic function"
