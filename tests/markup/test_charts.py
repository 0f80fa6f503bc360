"""Charts have the values they were given, at their places."""

import re
from itertools import pairwise
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hysdel_py.markup.charts import MOST_POINTS, Frame, Line, band_chart, line_chart, room_for, ticks
from hysdel_py.markup.mode_graph import Node, graph_picture


def line(values, *, held=False, name="a"):
    return Line(name, tuple(map(float, range(len(values) + held))), tuple(values), held)


def points(picture):
    """Places on each path."""
    paths = [e.attrib["d"] for e in ElementTree.fromstring(picture).iter("path")]
    return [[tuple(map(float, pair)) for pair in re.findall(r"[ML]([-\d.]+) ([-\d.]+)", d)] for d in paths]


def test_lines_go_through_their_values():
    (found,) = points(line_chart([line([0.0, 1.0, 0.5])], "x", (0.0, 2.0)))
    frame = Frame(0.0, 2.0, -0.05, 1.05)
    assert found == [pytest.approx((frame.x(t), frame.y(v)), abs=0.01) for t, v in ((0, 0), (1, 1), (2, 0.5))]
    assert found[0][1] > found[2][1] > found[1][1]  # up is less


def test_held_values_stay_until_the_next_time():
    picture = line_chart([line([1.0, 2.0], held=True)], "x", (0.0, 2.0))
    ends = [float(x) for x in re.findall(r"H([-\d.]+)", picture)]
    frame = Frame(0.0, 2.0)
    assert ends == [frame.x(1.0), frame.x(2.0)]


def test_what_is_no_number_leaves_a_gap():
    picture = line_chart([line([0.0, float("nan"), 1.0, float("inf"), 2.0])], "x", (0.0, 4.0))
    assert len(re.findall(r"M[\d.]+ [\d.]+", picture)) == 3
    assert "nan" not in picture


def test_extremes_of_long_signals_stay():
    values = [0.0] * 30_000
    values[777], values[20_001] = 5.0, -3.0
    (found,) = points(line_chart([line(values)], "x", (0.0, 3e4)))
    assert len(found) <= MOST_POINTS + 2
    frame = Frame(0.0, 3e4, -3.4, 5.4)
    assert min(y for _, y in found) == pytest.approx(frame.y(5.0), abs=0.02)
    assert max(y for _, y in found) == pytest.approx(frame.y(-3.0), abs=0.02)


def test_bands_are_where_the_value_is_not_0():
    picture = band_chart([line([0.0, 1.0, 1.0, 0.0, 3.0], held=True)], "x", (0.0, 5.0))
    bands = [e.attrib for e in ElementTree.fromstring(picture).iter("rect")]
    frame = Frame(0.0, 5.0)
    assert [(b["class"], float(b["x"])) for b in bands] == [("band b0", frame.x(1.0)), ("band b2", frame.x(4.0))]
    assert [float(b["width"]) for b in bands] == [frame.x(3.0) - frame.x(1.0), frame.x(5.0) - frame.x(4.0)]


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6))
def test_ticks_lie_inside_and_are_even(low, width):
    found = ticks(low, low + width)
    assert 1 <= len(found) <= 10
    assert all(low - 1e-6 * width <= t <= low + width * (1 + 1e-6) for t in found)
    steps = [b - a for a, b in pairwise(found)]
    assert max(steps, default=0) == pytest.approx(min(steps, default=0), rel=1e-6)


def test_room_for_names_is_enough_and_has_an_end():
    assert room_for([]) == room_for(["a"]) == Frame(0.0, 1.0).left
    assert room_for(["a", "n" * 20]) > 20 * 6
    assert room_for(["n" * 500]) == room_for(["n" * 900])


def test_ticks_of_nothing():
    assert ticks(2.0, 2.0) == (2.0,)


def test_graph_has_an_arrow_for_each_pair_and_a_ring_for_each_that_stays():
    nodes = [Node(k, f"mode {k}", k, is_flat=k == 2) for k in range(3)]
    picture = graph_picture(nodes, [(0, 1), (1, 0), (2, 2), (0, 1)], "three modes")
    tree = ElementTree.fromstring(picture)
    arrows = [(e.attrib["data-from"], e.attrib["data-to"]) for e in tree.iter("path") if "data-from" in e.attrib]
    assert arrows == [("0", "1"), ("1", "0")]
    assert [e.attrib["class"] for e in tree.iter("circle")] == ["mode b0", "mode b1", "stays", "mode b2 flat"]


def test_names_in_pictures_are_escaped():
    picture = line_chart([line([1.0], name="<i>&")], "<b>", (0.0, 1.0))
    assert "<i>" not in picture
    ElementTree.fromstring(picture)
