"""Checks of facts about polyhedra and their unions."""

from __future__ import annotations

import numpy as np
from fact_tools import Fact, NotSupported, array, close

from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.precision import Precision
from hysdel_py.geometry.relations import are_equal, common_facet, includes, share_boundary
from hysdel_py.geometry.union import PolyhedralUnion


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
    ball = region(p).relative_ball
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


def check_facets_of_hull(p, expected, tolerance):
    found = Polyhedron.hull(p["V"])
    assert are_equal(found, Polyhedron(array(expected["A"]), array(expected["b"]).ravel()), tolerance)
    assert found.m == len(expected["b"])
    assert len(found.vertices) == expected.get("n_vertices", len(p["V"]))


def check_rows_of_unit_length(p, expected, tolerance):
    found = region(p).normalised()
    C, d = array(expected["C"]), array(expected["d"]).ravel()
    close(found.A, np.vstack([expected["A"], C, -C]), tolerance, "rows")
    close(found.b, np.concatenate([expected["b"], d, -d]), tolerance, "sides")


def check_shadow(p, expected, _):
    for n, facets, corners in zip(
        p["n"], expected["facets_of_projection"], expected["vertices_of_projection"], strict=True
    ):
        shadow = Polyhedron.box([p["lb"]] * n, [p["ub"]] * n).project(range(n - 1))
        assert (shadow.m, len(shadow.vertices)) == (facets, corners)


def check_vertices(p, expected, tolerance):
    wanted = array(expected["vertices"])
    polyhedron = section_of(p) if "slice_dims_1based" in p else region(p)
    found = polyhedron.vertices
    assert found.shape == wanted.shape, f"{found.shape[0]} vertices, expected {wanted.shape[0]}"
    close(found[np.lexsort(found.T)], wanted[np.lexsort(wanted.T)], tolerance, "vertices")
    if "chebyshev_radius" in expected:
        close(polyhedron.ball.radius, expected["chebyshev_radius"], tolerance, "radius")


def section_of(p):
    return Polyhedron.hull(p["V"]).section({i - 1: v for i, v in zip(p["slice_dims_1based"], p["values"], strict=True)})


def check_image(p, expected, tolerance):
    low, high = Polyhedron.hull(p["V"]).image(p["M"]).bounding_box
    close([low[0], high[0]], expected["interval"], tolerance, "image")


def check_facet(p, expected, tolerance):
    """Half the length of a facet, and the distance from its centre to the nearest other row."""
    polygon, row = region(p), p["facet_1based"] - 1
    ball = polygon.facet(row).relative_ball
    close(ball.radius, expected["half_facet_length"], 1e-8, "half length")
    others = [i for i in range(polygon.m) if i != row]
    close(np.min(polygon.slack(ball.centre)[others] / polygon.lengths[others]), expected["r"], 1e-8, "radius")
    assert len(polygon.irredundant_rows()) == expected["n_facets_irredundant"]


def check_adjacent(p, expected, tolerance):
    first, second = (from_table(p[name], tolerance) for name in ("P_H", "Q_H"))
    rows = common_facet(first, second)
    assert (rows is not None) == expected["isAdjacent"]
    assert share_boundary(first, second) == expected.get("isNeighbor", True)
    if rows is not None:
        assert (rows[0] + 1, rows[1] + 1) == (expected["facet_P_1based"], expected["facet_Q_1based"])


def from_table(rows, tolerance):
    """Rows ``[A b]`` given to some digits: neighbours meet up to these."""
    table = array(rows)
    return Polyhedron(table[:, :-1], table[:, -1], Precision(empty=max(tolerance, 1e-8)))


def check_neighbours(p, expected, _):
    boxes = {name[:2]: Polyhedron.hull(corners) for name, corners in p.items()}
    for relation, holds in (
        ("isNeighbor", share_boundary),
        ("isAdjacent", lambda a, b: common_facet(a, b) is not None),
    ):
        for pair, wanted in expected[relation].items():
            assert holds(*(boxes[name] for name in pair.split("_"))) == wanted, f"{relation} of {pair}"


def is_bounded(polyhedron):
    return polyhedron.is_bounded


def check_hull_or_rows(p, expected, tolerance):
    (check_facets_of_hull if "V" in p else check_rows_of_unit_length)(p, expected, tolerance)


def check_any_neighbours(p, expected, tolerance):
    (check_adjacent if "P_H" in p else check_neighbours)(p, expected, tolerance)


POLYHEDRA = {
    "empty": check_empty,
    "radius": check_radius,
    "without_equality": check_contains,
    "minimal_facets_any_of": check_minimal,
    "intersection": check_intersection,
    "bounded": check_bounded,
    "chebyshev_radius": check_vertices,
    "vertices": check_vertices,
    "A": check_hull_or_rows,
    "facets_of_projection": check_shadow,
    "interval": check_image,
    "half_facet_length": check_facet,
    "isAdjacent": check_any_neighbours,
}


def union(fact: Fact) -> str:
    p, expected = fact["problem"], fact["expected"]
    if "shifts" in p:
        low, high = array(p["P1"]["lb"]).ravel(), array(p["P1"]["ub"]).ravel()
        found = PolyhedralUnion(tuple(Polyhedron.box(low + shift, high + shift) for shift in array(p["shifts"])))
        assert (found.is_connected, found.is_full_dimensional) == (expected["isConnected"], expected["isFullDim"])
        return "connected, inner points"
    rectangle = Polyhedron.box(p["rectangle"]["lb"], p["rectangle"]["ub"])
    both = PolyhedralUnion((rectangle, Polyhedron.hull(p["triangle_V"])))
    orthant = Polyhedron(-np.eye(2), np.zeros(2))
    assert all(includes(orthant, part) for part in both.parts) == expected["in_positive_orthant"]
    close(both.volume, expected["union_area"], fact["tolerance"], "area")
    assert (both.is_convex, both.is_connected) == (expected["union_convex"], expected["union_connected"])
    return "orthant, area, convex, connected"


def pwa(fact: Fact) -> str:
    """Whether the interiors of no two regions meet."""
    p, expected = fact["problem"], fact["expected"]
    for name in ("overlapping", "touching"):
        parts = [region(part) for part in p[name]]
        meet = [a & b for i, a in enumerate(parts) for b in parts[i + 1 :]]
        found = all(both.is_empty or both.is_flat for both in meet)
        assert found == expected[f"well_posed_{name}"], f"well posed is {found} for the {name} regions"
    return "2 partitions"
