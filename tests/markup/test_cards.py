"""What a notebook shows of each kind of object."""

import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.geometry.polyhedron import Polyhedron


def shown(thing):
    """Words of what a notebook shows, after a look at its tags."""
    words, tags = [], []

    class Reader(HTMLParser):
        def handle_starttag(self, tag, attrs):
            tags.append(tag)

        def handle_endtag(self, tag):
            assert tags.pop() == tag

        def handle_startendtag(self, tag, attrs):
            pass

        def handle_data(self, data):
            words.append(data)

    Reader().feed(thing._repr_html_())
    assert tags == []
    return " ".join(words)


@pytest.fixture(scope="module")
def model():
    return hys.load("two_tanks")


def test_model_shows_its_variables(model):
    assert "level of tank 1" in shown(model)
    assert "ts = 5" in shown(model)


def test_forms_show_rows_and_modes(model):
    assert "43 above = h1 >= h_pipe" in shown(model.mld)
    assert "[0, 0.6] m" in shown(model.mld)
    assert "h1 >= h_pipe (line 43) & h2 >= 0.9*h_max (line 44)" in shown(model.pwa)


def test_long_lists_are_cut_and_it_is_said():
    assert "and 4 more" in shown(hys.load("two_rooms").pwa)


def test_move_shows_input_and_worth():
    status = hys.MoveStatus
    text = shown(
        hys.Move(status.OPTIMAL, "a <b>plan", u=np.array([0.5, 1.0]), cost=2.0, bound=2.0, gap=0.0, seconds=0.01)
    )
    assert "optimal" in text
    assert "0.5, 1" in text
    assert "a <b>plan" in text  # as text: the tags of the page are in order
    assert "none" in shown(hys.Move(status.INFEASIBLE, "no plan"))


def test_law_shows_its_parameters():
    problem = hys.MpQp(
        H=np.eye(1), f=[0.0], F=[[1.0]], G=[[1.0], [-1.0]], w=[1.0, 1.0], S=[[0.0], [0.0]],
        theta=Polyhedron.box([-3.0], [3.0]),
    )  # fmt: skip
    law = hys.ExplicitLaw.of(hys.solve_mpqp(problem), moves=1, names=("speed",))
    assert "3 regions" in shown(law)
    assert "parameter speed" in shown(law)


def test_run_shows_a_chart_for_each_unit(model):
    run = model.simulate([0.1, 0.2], [[1e-4, 1.0]] * 5)
    card = run._repr_html_()
    assert card.count("<svg") == 1
    assert "h1, h2 [m]" in shown(run)


def test_showing_loads_nothing_heavy():
    code = "import sys, hysdel_py as h; h.load('clutch')._repr_html_(); print(*{n.split('.')[0] for n in sys.modules})"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert not {"matplotlib", "osqp", "piqp", "networkx", "pandas", "scipy", "IPython"} & set(loaded)
