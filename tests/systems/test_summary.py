"""What the prompt of an interpreter shows of a form."""

import numpy as np
import pytest

import hysdel_py as hys


@pytest.fixture(scope="module")
def tanks():
    return hys.load("two_tanks")


def test_forms_say_what_they_are_in_one_line(tanks):
    nx, nu, ny = len(tanks.dha.x), len(tanks.dha.u), len(tanks.dha.y)
    for form in (tanks.dha, tanks.mld, tanks.pwa):
        text = repr(form)
        assert text.startswith(f"<{type(form).__name__} {form.name}: {nx} states, {nu} inputs")
        assert "\n" not in text
    assert f"{ny} output" in repr(tanks.mld)
    assert f"{len(tanks.mld.E5)} rows" in repr(tanks.mld)
    assert repr(tanks.pwa.modes[0]).startswith("<Mode 0:")


def test_a_run_names_its_signals(tanks):
    run = tanks.simulate(np.full(len(tanks.dha.x), 0.1), np.zeros((1, len(tanks.dha.u))))
    assert repr(run).startswith("<Trajectory of 1 step to t=")
    assert all(v.name in repr(run) for v in (*tanks.dha.x, *tanks.dha.u))


def test_sets_say_their_sizes():
    box = hys.Polyhedron.box([0, 0], [1, 1])
    assert repr(box) == "<Polyhedron in 2 coordinates, 4 rows>"
    assert repr(hys.PolyhedralUnion((box, box))) == "<PolyhedralUnion of 2 polyhedra in 2 coordinates>"
