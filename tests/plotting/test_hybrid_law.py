"""Pictures of hybrid laws: at each dot the move, or the value, that the law itself gives there."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.plotting.hybrid_law import best_regions
from hysdel_py.plotting.law_pieces import colour_of, ranked

SOURCE = """SYSTEM valve { INTERFACE {
  STATE { REAL a [-2, 2]; /* [m] */ REAL c [-2, 2]; BOOL b; } INPUT { REAL u [-1, 1]; BOOL s; }
  OUTPUT { REAL y; } } IMPLEMENTATION { AUX { BOOL up; REAL z; } AD { up = a >= 0; }
  DA { z = {IF up & s THEN 0.5*a + u ELSE -0.4*a + 0.5*c}; } CONTINUOUS { a = z; c = 0.6*c + 0.4*a - u; }
  AUTOMATA { b = s; } OUTPUT { y = a; } } }"""


def made(norm):
    cost = hys.Cost(x={"a": 3, "c": 1}, u={"u": 0.2, "s": 0.3}, norm=norm)
    fixed = {"r(a)": 0.2, "r(c)": 0.0, "r(u)": 0.0, "r(s)": 0.0}
    return hys.explicit(hys.HybridMpc(hys.load(SOURCE), 2, cost), fixed=fixed)


@pytest.fixture(scope="module")
def curved():
    law = made("2")
    assert not law.partition
    return law


@pytest.fixture(scope="module")
def straight():
    return made("1")


def shown(figure):
    """The picture on the axes as an array, and the coordinates of its dots."""
    (image,) = figure.axes[0].images
    array = image.get_array()
    left, right, low, high = image.get_extent()
    return array, np.linspace(left, right, array.shape[1]), np.linspace(low, high, array.shape[0])


def places(law, across, upwards, count, b):
    rng = np.random.default_rng(4)
    for i, j in rng.integers(0, [len(upwards), len(across)], (count, 2)).tolist():
        yield i, j, {"a": float(across[j]), "c": float(upwards[i]), "b": b}


@pytest.mark.parametrize("b", [0, 1])
def test_values_and_moves_are_those_of_the_law(curved, b):
    for what, move in (("value", 0), ("move", "u"), ("move", 1)):
        array, across, upwards = shown(curved.plot(what, section={"b": b}, move=move, points=60))
        number = 0 if move == "u" else 1
        for i, j, zeta in places(curved, across, upwards, 150, b):
            own = curved.value(zeta) if what == "value" else curved(zeta)[number]
            assert array[i, j] == pytest.approx(own, abs=1e-9)


def test_equal_colours_are_equal_moves(curved):
    array, across, upwards = shown(curved.plot(points=80))
    moves = {}
    for i, j, zeta in places(curved, across, upwards, 300, 0):
        place = curved.locate(zeta)
        law = curved.sequences[place.sequence].law
        gains = np.round([*law.K[place.region][:2].ravel(), *law.k[place.region][:2]], 6) + 0.0
        moves.setdefault(tuple(array[i, j]), set()).add(tuple(gains.tolist()))
    assert len(moves) > 3
    assert all(len(found) == 1 for found in moves.values())


def test_axes_and_what_is_fixed_are_named(curved):
    figure = curved.plot(section={"b": 1})
    (axes,) = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("a [m]", "c")
    assert axes.get_title(loc="left") == "at b = 1"
    assert axes.get_legend().get_title().get_text() == "u, s"


def test_over_one_parameter_the_best_pieces_stand_in_a_row(curved):
    moves, switch, value = curved.plot(section={"c": 0.7}).axes
    assert [panel.get_ylabel() for panel in (moves, switch, value)] == ["u", "s", "value"]
    assert value.get_xlabel() == "a [m]"
    ends = []
    for panel, number in ((moves, 0), (switch, 1)):
        for line in panel.lines:
            if line.get_linewidth() == 2:
                (start, first), (end, last) = line.get_xydata()
                middle = 0.5 * (start + end)
                assert 0.5 * (first + last) == pytest.approx(curved({"a": middle, "c": 0.7, "b": 0})[number], abs=1e-9)
                ends.append((start, end))
    pieces = sorted(set(ends))
    assert (pieces[0][0], pieces[-1][1]) == pytest.approx((-2.0, 2.0))
    assert [end for _, end in pieces[:-1]] == [start for start, _ in pieces[1:]]


def test_a_partition_is_drawn_as_polygons(straight):
    (axes,) = straight.plot().axes
    assert len(axes.patches) > 3
    assert not axes.images
    for patch in axes.patches:
        middle = patch.get_xy()[:-1].mean(axis=0)
        assert straight.locate({"a": middle[0], "c": middle[1], "b": 0}) is not None


def test_of_equal_values_the_first_region_wins_and_outside_there_is_none(straight):
    twice = straight.single({"b": 0})
    points = np.array([[0.0, 0.0], [5.0, 5.0]])
    assert best_regions(twice, points)[1] == -1
    assert best_regions(twice, points)[0] >= 0


def test_kinds_that_cover_most_come_first():
    assert ranked([4, 7, 4, 9], [1.0, 3.0, 1.5, 0.1]) == {7: 0, 4: 1, 9: 2}
    assert len({colour_of(kind) for kind in range(12)}) == 12


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"what": "graph"}, "partition, move, value"),
        ({"by": "colour"}, "law or region"),
        ({"move": "w"}, "one of u, s"),
        ({"move": 2}, "one of u, s"),
        ({"points": 1}, "at least 2"),
        ({"section": {"d": 1}}, "there are a, c, b"),
        ({"section": {"b": 0.5}}, "0 or 1"),
        ({"section": {"a": 0, "c": 0}}, "ask the law"),
        ({"section": {"a": 7}}, "outside the box"),
        ({"section": {"a": "low"}}, "a number was expected"),
        ({"section": 3}, "a mapping of names"),
    ],
)
def test_wrong_options_are_refused(curved, options, message):
    with pytest.raises(hys.ArgumentError, match=message):
        curved.plot(**options)
