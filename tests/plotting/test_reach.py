"""Pictures of reachable sets: what they show, not how."""

import pytest

import hysdel_py as hys
from hysdel_py.plotting.reach import corners_of, plot_reach, plot_set

ONE = "SYSTEM s { INTERFACE { STATE { REAL v [-9, 9]; } } IMPLEMENTATION { CONTINUOUS { v = 0.5*v + 1; } } }"


@pytest.fixture(scope="module")
def found():
    return hys.reach(hys.load("two_tanks"), {"h1": (0.1, 0.2), "h2": (0.25, 0.3)}, 2)


def test_every_piece_is_drawn(found):
    (axes,) = plot_reach(found).axes
    assert len(axes.patches) == sum(len(states.pieces) for states in found.sets)
    assert axes.get_xlabel().startswith("h1")
    corners = axes.patches[0].get_xy()
    assert (corners[:, 0].min(), corners[:, 0].max()) == pytest.approx((0.1, 0.2))
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["step 0", "step 1", "step 2"]


def test_corners_go_round(found):
    for piece in found.sets[-1].pieces:
        corners = corners_of(piece, [0, 1])
        area = 0.5 * abs(
            sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, [*corners[1:], corners[0]], strict=True))
        )
        assert area == pytest.approx(piece.region.volume, rel=1e-6)


def test_one_state_over_the_steps():
    found = hys.reach(hys.load(ONE), {"v": (0, 1)}, 3)
    run = hys.load(ONE).simulate([0.5], 3)
    (axes,) = plot_reach(found, runs=[run]).axes
    assert axes.get_xlabel() == "step"
    assert len(axes.collections) == 4
    assert len(axes.lines) == 1
    assert plot_set(found.sets[0]).axes


def test_wrong_names(found):
    with pytest.raises(hys.ArgumentError, match="one or two real states"):
        plot_reach(found, ("h1", "h3"))
