"""Pictures of explicit laws: what they show."""

from __future__ import annotations

import numpy as np
import pytest
from export.laws import saturation, solved
from matplotlib.colors import to_hex

import hysdel_py as hys
from hysdel_py.plotting.law_pieces import colour_of, kinds_of, law_text, pieces_of


def area(corners):
    x, y = np.asarray(corners).T
    return abs(float(np.sum(np.roll(x, 1) * y - x * np.roll(y, 1)))) / 2


@pytest.mark.parametrize("by", ["law", "region"])
def test_the_partition_covers_the_map_once(by):
    law = solved("a_di_N3")
    (axes,) = law.plot(by=by, units=("m", "m/s")).axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x1 [m]", "x2 [m/s]")
    assert len(axes.patches) == law.count
    rng = np.random.default_rng(0)
    low, high = law.domain.bounding_box
    points = rng.uniform(low, high, (4000, 2))
    share = np.mean([law.locate(point) >= 0 for point in points])
    total = sum(area(patch.get_xy()) for patch in axes.patches)
    assert total == pytest.approx(share * np.prod(high - low), rel=0.05)
    kinds = {to_hex(patch.get_facecolor()) for patch in axes.patches}
    assert len(kinds) == len(set(map(colour_of, kinds_of(law, by))))


def test_equal_moves_have_equal_colours_and_are_named():
    law = solved("a_di_N3")
    (axes,) = law.plot(move_label="force [N]").axes
    entries = [text.get_text() for text in axes.get_legend().get_texts()]
    assert axes.get_legend().get_title().get_text() == "force [N]"
    assert {"1", "−1", "−0.52 x1 − 0.94 x2"} <= set(entries)
    assert len(entries) == len(set(kinds_of(law, "law")))
    saturated = {p.colour for p in pieces_of(law, "law") if p.text == "1"}
    assert len(saturated) == 1
    assert all(patch.get_facecolor()[:3] != (0, 0, 0) for patch in axes.patches)


def test_regions_bear_their_numbers():
    (axes,) = solved("a_di_N3").plot(by="region").axes
    shown = [int(text.get_text()) for text in axes.texts]
    assert len(shown) > 5
    law = solved("a_di_N3")
    assert all(law.locate(text.get_position()) == int(text.get_text()) for text in axes.texts)


def test_a_run_is_drawn_where_it_goes():
    trace = np.array([[-2.0, 0.5], [-1.0, 0.5], [0.0, 0.0]])
    (axes,) = solved("a_di_N3").plot(trace=trace).axes
    lines = {line.get_label(): line for line in axes.lines}
    assert np.array_equal(lines["run"].get_xydata(), trace)
    assert np.array_equal(lines["start"].get_xydata(), trace[:1])


def test_one_parameter_gives_the_moves_and_the_value():
    law = saturation()
    moves, value = law.plot(move_label="u").axes
    drawn = [line for line in moves.lines if len(line.get_xdata()) == 2 and line.get_linewidth() == 2]
    ends = np.vstack([line.get_xydata() for line in drawn])
    assert np.allclose(ends, [[-3, 1], [-1, 1], [-1, 1], [1, -1], [1, -1], [3, -1]])
    assert (moves.get_ylabel(), value.get_ylabel(), value.get_xlabel()) == ("u", "value", "x")
    for line in value.lines:
        if len(line.get_xdata()) > 2:
            for x, height in line.get_xydata()[1:-1]:
                assert height == pytest.approx(law.value([x]))
    assert len(law.merged().plot().axes) == 1


def test_surfaces_have_the_heights_of_the_law():
    law = solved("a_di_N3")
    (axes,) = law.plot("move", move_label="force [N]").axes
    (faces,) = axes.collections
    assert len(faces._faces) == law.count if hasattr(faces, "_faces") else True
    assert axes.get_zlabel() == "force [N]"
    assert axes.get_zlim() == pytest.approx((-1, 1))
    (axes,) = law.plot("value").axes
    assert axes.get_zlabel() == "value"
    corners = np.vstack([p.corners for p in pieces_of(law, "region")])
    values = [law.value(c) for c in corners if law.locate(c) >= 0]
    assert axes.get_zlim()[0] <= min(values) + 1e-6


def test_a_slice_names_what_is_fixed():
    law = solved("f_thesis")
    section = {"x3": 100.0, "x4": 90.0, "x5": 115.0, "x6": 0.5}
    (axes,) = law.plot(section=section).axes
    assert axes.get_title(loc="left") == "at x3 = 100, x4 = 90, x5 = 115, x6 = 0.5"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x1", "x2")
    assert len(axes.patches) == law.fixed(section).count


def test_formulas_leave_out_what_rounding_left():
    law = solved("a_di_N3")
    saturated = next(r for r in range(law.count) if np.abs(law.K[r, 0]).max() < 1e-12)
    assert law_text(law, saturated) in ("1", "−1")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"what": "graph"}, "partition, move, value"),
        ({"by": "colour"}, "law or region"),
        ({"move": 1}, "from 0 to 0"),
        ({"units": ("m",)}, "2 texts"),
        ({"trace": [1.0, 2.0]}, r"\(n, 2\)"),
        ({"trace": [[np.nan, 2.0]]}, "finite"),
        ({"section": {"speed": 1.0}}, "no parameter"),
        ({"section": {"x1": 1e3}}, "outside the box of the law"),
        ({"what": "move", "trace": [[0.0, 0.0]]}, "over a partition"),
    ],
)
def test_wrong_options_are_refused(options, message):
    with pytest.raises(hys.ArgumentError, match=message):
        solved("a_di_N3").plot(**options)


def test_too_many_parameters_and_no_value_are_refused():
    with pytest.raises(hys.ArgumentError, match="fix all but two"):
        solved("f_thesis").plot()
    with pytest.raises(hys.ArgumentError, match="no value function"):
        solved("a_di_N3").merged().plot("value")
