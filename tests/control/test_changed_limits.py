"""Limits of one call: the same answer as from a controller that was built with them, and nothing left behind."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hysdel_py as hys
from hysdel_py.errors import ArgumentError

ROOM = """SYSTEM room {
  INTERFACE { STATE { REAL T [0, 40]; REAL w [0, 40]; } INPUT { REAL vent [0, 2]; BOOL heater; }
    OUTPUT { REAL felt, wall; } }
  IMPLEMENTATION {
    AUX { REAL heat; BOOL cold; }
    AD { cold = T <= 16; }
    DA { heat = {IF heater & cold THEN 4 ELSE 1}; }
    CONTINUOUS { T = 0.8*T + 0.1*w + heat - vent + 0.5; w = 0.9*w + 0.1*T; }
    OUTPUT { felt = T; wall = w + vent; }
  }
}"""
WIDE = {
    "x": {"T": (1, 39), "w": (1, 39)}, "y": {"wall": (0, 42), "felt": (0, 40)}, "u": {"vent": (0, 2)},
    "du": {"vent": (-2, 2)}, "terminal": {"T": (0, 40), "felt": (0, 40)},
}  # fmt: skip
NARROW = {
    "x": {"T": (14, [25, 24, 18.5, 18.5, 18.5])}, "y": {"wall": (17.2, 24)}, "u": {"vent": (0.1, 1.5)},
    "du": {"vent": (-0.4, 0.4)}, "terminal": {"felt": (15, 17.5)},
}  # fmt: skip
STATE, LAST = [18.0, 17.0], [0.5, 0]


@pytest.fixture(scope="module")
def model():
    return hys.load(ROOM)


@cache
def random_room():
    """The model, for tests whose arguments hypothesis makes."""
    return hys.load(ROOM)


def controller(model, limits, **options):
    cost = hys.Cost(y={"felt": 1.0}, u={"heater": 0.3}, du={"vent": 0.1})
    return hys.HybridMpc(model, 4, cost, limits, references=("felt",), backend="piqp", gap_rel=1e-7, **options)


def both(limits):
    """The limits of a controller with those of a call in their place."""
    return {group: {**ends, **limits.get(group, {})} for group, ends in WIDE.items()}


@pytest.mark.parametrize("soft", [False, True, ("T", "wall")])
@pytest.mark.parametrize("groups", [("x",), ("y",), ("u",), ("du",), ("terminal",), tuple(NARROW)])
def test_call_gives_the_plan_of_a_controller_with_these_limits(model, soft, groups):
    changed = {group: NARROW[group] for group in groups}
    mpc = controller(model, hys.Limits(**WIDE, soft=soft, rho=50.0))
    built = controller(model, hys.Limits(**both(changed), soft=soft, rho=50.0))
    before = mpc.solve(STATE, [21.0], last_input=LAST)
    here = mpc.solve(STATE, [21.0], last_input=LAST, limits=hys.Limits(**changed))
    there = built.solve(STATE, [21.0], last_input=LAST)
    assert here.status is there.status is hys.MoveStatus.OPTIMAL
    assert here.cost == pytest.approx(there.cost, rel=1e-5, abs=1e-5)
    assert here.u == pytest.approx(there.u, abs=1e-3)
    assert here.slack == pytest.approx(there.slack, abs=1e-3)
    again = mpc.solve(STATE, [21.0], last_input=LAST)
    assert again.cost == pytest.approx(before.cost, rel=1e-6), "nothing is left behind"


def test_limits_of_this_test_bind(model):
    """Each group changes the cost of the plan, or the test above could not fail."""
    mpc = controller(model, hys.Limits(**WIDE))
    free = mpc.solve(STATE, [21.0], last_input=LAST).cost
    for group in ("x", "y", "u", "du", "terminal"):
        assert mpc.solve(STATE, [21.0], last_input=LAST, limits=hys.Limits(**{group: NARROW[group]})).cost > free + 1e-3


@settings(max_examples=6, deadline=None, derandomize=True)
@given(st.floats(5, 25), st.floats(5, 25), st.floats(0, 20), st.floats(0, 15))
def test_the_program_is_that_of_a_controller_with_these_limits(T, w, low, width):
    model = random_room()
    changed = {"x": {"T": (low, low + width + 1.0)}, "y": {"felt": (low / 2, None)}}
    call = (
        controller(model, hys.Limits(**WIDE)).problem([T, w], [20.0], last_input=LAST, limits=hys.Limits(**changed)).qp
    )
    built = controller(model, hys.Limits(**both(changed))).problem([T, w], [20.0], last_input=LAST).qp
    for name in ("q", "l", "u", "lb", "ub", "constant"):
        assert np.asarray(getattr(call, name)) == pytest.approx(np.asarray(getattr(built, name)), abs=1e-9), name


def test_why_names_the_limit_of_the_call(model):
    mpc = controller(model, hys.Limits(**WIDE))
    move = mpc.solve(STATE, [30.0], last_input=LAST, limits=hys.Limits(y={"wall": (18.8, 42)}))
    assert any("wall in [18.8, 42]" in price.text for price in mpc.why(move).limits)
    assert "wall in [0, 42]" in str(mpc.formulation.rows)


def test_fallback_softens_the_limits_of_the_call(model):
    mpc = controller(model, hys.Limits(**WIDE), fallback="soft")
    assert mpc.solve(STATE, [20.0], last_input=LAST).status is hys.MoveStatus.OPTIMAL
    move = mpc.solve(STATE, [20.0], last_input=LAST, limits=hys.Limits(x={"T": (30, 39)}))
    assert move.status is hys.MoveStatus.FALLBACK
    assert move.slack["T"] > 5


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        (hys.Limits(y={"felt": (1, 2)}, soft=True), "soft or rho"),
        (hys.Limits(y={"felt": (1, 2)}, rho=3.0), "soft or rho"),
        (hys.Limits(x={"w": (1, 2)}), "name w, which the controller does not limit; it limits T"),
        (hys.Limits(y={"wall": (1, 30)}), "no upper end at k = 0"),
        (hys.Limits(terminal=([[1.0, 0.0]], [1.0])), "a mapping of names"),
        (hys.Limits(x={"T": (30, 20)}), "a low end that is not above"),
        ({"x": {"T": (1, 2)}}, "a Limits was expected"),
    ],
)
def test_what_a_call_cannot_change_is_said(model, limits, message):
    own = hys.Limits(x={"T": (1, 39)}, y={"felt": (None, 30), "wall": (0, None)}, soft=("wall",), du={"vent": (-2, 2)})
    with pytest.raises(ArgumentError, match=message):
        controller(model, own).solve(STATE, [20.0], last_input=LAST, limits=limits)
