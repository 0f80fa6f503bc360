"""Whole numbers among arguments."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.analysis.counts import counted
from hysdel_py.errors import ArgumentError

TEXT = """SYSTEM s { INTERFACE { STATE { REAL p [-1, 1]; } OUTPUT { REAL y; } }
  IMPLEMENTATION { CONTINUOUS { p = 0.5*p; } OUTPUT { y = p; } } }"""


@pytest.mark.parametrize("value", [2.0, "2", None, True, -1])
def test_what_is_no_count(value):
    with pytest.raises(ArgumentError, match="a whole number of at least 0 was expected"):
        counted(value, 0, "steps")


def test_numbers_of_steps_rounds_and_pieces():
    model = hys.load(TEXT)
    assert len(hys.reach(model, {}, np.int64(2)).sets) == 3
    assert hys.feasible_states(model, np.int64(2), outputs={"y": (-0.5, 0.25)}).ranges()["p"] == pytest.approx(
        (-0.5, 0.25)
    )
    for ask in (
        lambda: hys.reach(model, {}, 2.5),
        lambda: hys.reach(model, {}, 2, most="many"),
        lambda: hys.feasible_states(model, True),
        lambda: hys.invariant_set(model, rounds=True),
    ):
        with pytest.raises(ArgumentError, match="a whole number"):
            ask()
    with pytest.raises(ArgumentError, match="outputs: expected names"):
        hys.feasible_states(model, 2, outputs=[1])
