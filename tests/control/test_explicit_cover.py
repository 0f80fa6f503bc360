"""Planes, hull and open leaves of explicit laws."""

from __future__ import annotations

import numpy as np
import pytest
from export.laws import inner_region, saturation, solved, without

from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.control.explicit_cover import cover_of
from hysdel_py.control.explicit_planes import planes_of
from hysdel_py.control.explicit_tree import build_tree, same_moves


@pytest.mark.parametrize("name", ["a_di_N3", "c_pend_N3"])
def test_every_row_is_a_side_of_its_plane(name):
    law = solved(name)
    planes = planes_of(law)
    assert planes.normals[planes.numbers] * planes.signs[:, None] == pytest.approx(law.A, abs=1e-7)
    assert planes.offsets[planes.numbers] * planes.signs == pytest.approx(-law.b, abs=1e-7)
    assert planes.count < len(law.b)


@pytest.mark.parametrize("name", ["a_di_N3", "c_pend_N3"])
def test_a_convex_map_is_its_hull(name):
    law = solved(name)
    planes = planes_of(law)
    cover = cover_of(law, planes, build_tree(law, same_moves(law)))
    assert not cover.is_open.any()
    points = random_points(law, 200, np.random.default_rng(0))
    inside = np.all(points @ law.A[cover.hull].T <= law.b[cover.hull] + 1e-8, axis=1)
    assert inside.tolist() == [law.locate(point) >= 0 for point in points]


def test_a_hole_opens_the_leaves_around_it():
    law = solved("a_di_N3")
    holed = without(law, inner_region(law))
    tree = build_tree(holed, same_moves(holed))
    cover = cover_of(holed, planes_of(holed), tree)
    assert cover.is_open.any()
    hole = law.polyhedron(inner_region(law)).ball.centre
    leaf = tree.tree.locate(hole, nearest=True).leaf
    assert leaf < 0 or cover.is_open[leaf]


@pytest.mark.parametrize("name", ["a_di_N3", "f_thesis"])
def test_the_leaf_of_a_point_holds_its_region(name):
    law = solved(name)
    kinds = same_moves(law)
    tree = build_tree(law, kinds)
    for point in random_points(law, 100, np.random.default_rng(1)):
        region = law.locate(point)
        if region >= 0 and law.excess(point)[region] < -1e-6:
            leaf = tree.tree.locate(point, nearest=True).leaf
            assert region in tree.members[leaf]
            assert len({kinds[member] for member in tree.members[leaf]}) == 1


def test_the_hull_of_one_dimension_is_the_interval():
    law = saturation()
    cover = cover_of(law, planes_of(law), build_tree(law))
    ends = sorted((law.b[cover.hull] / law.A[cover.hull, 0]).tolist())
    assert ends == pytest.approx([-3.0, 3.0])
