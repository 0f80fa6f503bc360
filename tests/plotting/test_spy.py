"""The picture of the rows of an MLD form shows each coefficient beside its line."""

import numpy as np
import pytest

import hysdel_py as hys

pytest.importorskip("matplotlib")

from hysdel_py.plotting.spy import plot_spy


def points(axes):
    return {tuple(map(int, point)) for collection in axes.collections for point in collection.get_offsets()}


def test_every_coefficient_is_a_point_in_the_colour_of_its_section():
    mld = hys.load("two_rooms").mld
    (axes,) = plot_spy(mld).axes
    whole = np.hstack([getattr(mld, name).toarray() for name in ("E1", "E4", "E2", "E3")])
    row, column = np.nonzero(whole)
    assert points(axes) == set(zip(column.tolist(), row.tolist(), strict=True))
    sections = [text.get_text() for text in axes.get_legend().get_texts()]
    assert sections == ["AD", "LOGIC", "MUST", "DA"]
    names = [label.get_text() for label in axes.get_xticklabels()]
    assert names == [v.name for v in (*mld.u, *mld.x, *mld.d, *mld.z)]
    assert axes.get_yticklabels()[0].get_text() == "is_warm = T1 >= warm  45"


def test_a_form_without_rows_is_refused():
    text = "SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; } } IMPLEMENTATION { CONTINUOUS { x = x; } } }"
    with pytest.raises(hys.ArgumentError, match="no rows"):
        plot_spy(hys.load(text).mld)
