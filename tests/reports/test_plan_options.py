"""Limits that vary, and options of a controller that are refused rather than left out."""

from __future__ import annotations

import pytest

import hysdel_py as hys

TANK = """SYSTEM tank {
INTERFACE { STATE { REAL level [0, 10]; } INPUT { REAL flow [-1, 1]; } OUTPUT { REAL seen; } }
IMPLEMENTATION { CONTINUOUS { level = level + flow; } OUTPUT { seen = level; } }
}"""


@pytest.fixture(scope="module")
def tank():
    return hys.load(TANK)


def controller(tank, limits, **options):
    return hys.HybridMpc(tank, 3, hys.Cost(y={"seen": 1}), limits, **options)


def test_a_limit_that_varies_is_explained_with_its_time(tank):
    mpc = controller(tank, hys.Limits(x={"level": (None, [10, 10, 10, 1])}))
    assert not mpc.solve([5.0]).ok
    text = str(hys.explain_infeasible(mpc, [5.0]))
    assert "level <= 1" in text
    assert mpc.solve([3.5]).ok
    assert "level <= 10" not in text


def test_limits_that_are_not_explained_are_refused(tank):
    with pytest.raises(hys.ArgumentError, match=r"increments of an input \(flow\)"):
        hys.explain_infeasible(controller(tank, hys.Limits(du={"flow": (0, 1)})), [5.0])
    with pytest.raises(hys.ArgumentError, match="output of the last state"):
        hys.explain_infeasible(controller(tank, hys.Limits(terminal={"seen": (0, 1)})), [5.0])
    with pytest.raises(hys.ArgumentError, match="blocks"):
        hys.explain_infeasible(controller(tank, hys.Limits(), control_horizon=1), [5.0])
