"""A predictive controller of the dry clutch that can be proven to keep the engine above its limit and to lock.

It plans as :func:`hysdel_py.demos.clutch.clutch_controller` does, with the weights and limits of the document. What is
added is what the argument needs:

* plans end where the clutch presses a little harder than the load at engine speed asks for, and the engine torque can
  follow before the engine has fallen to its limit: from there the relative speed falls with the engine as it is;
* a plan pays for each step in which the clutch is not inside its stick window, more than a step inside can cost;
* a plan pays for the relative speed at its end, more than the steps cost that it takes from there.

The engine-speed limit is hard, and plans have 15 steps instead of 10, so that one from an open clutch gets that far.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.demos.clutch import LEAST_ENGINE_SPEED
from hysdel_py.model import Model

__all__ = ["CERTIFIED_REFERENCE", "CERTIFIED_START", "certified_clutch_controller", "clutch_terminal_set"]

Row = tuple[Mapping[str, float], float]
Matrix = NDArray[np.float64]

CERTIFIED_START: Mapping[str, float | tuple[float, float]] = {
    "we": (90.0, 110.0), "gamma": (50.0, 80.0), "Te": (10.0, 30.0), "Fn": 0.0, "lc": 0.0,
}  # fmt: skip
"""First states with an open clutch."""
CERTIFIED_REFERENCE: Mapping[str, float] = {"y1": 100.0, "y2": 0.0, "y3": 0.0, "gamma": -50.0, "stick": 1.0}
"""The relative speed at the end counts from -50 rad/s: its cost falls steeply where it is small, too."""

_HORIZON = 15
_NOT_STUCK = 1e4  # what a step outside of the stick window costs
_AT_THE_END = 1250.0  # weight of the relative speed at the end
_GAP = 1e3  # a tenth of what a step outside costs
_PRESS = (8.0, 12.0)  # Nm above the load at engine speed
_MOST_SPEED = 118.0  # rad/s at the end of a plan
_LAG = 20.0  # Nm that the engine torque may be behind the clutch
_LEAD = 0.5  # Nm that it may be ahead
_CALM = 3.0  # rad/s, change of relative speed in the last step


def certified_clutch_controller(model: Model, gap: float = _GAP) -> HybridMpc:
    """The controller; `model` is the shipped clutch, whose engine speeds reach below the limit.

    With a large `gap` its plans are the first that are found: that there is one, and what it keeps, is proven of them
    as well.
    """
    return HybridMpc(
        model,
        _HORIZON,
        Cost(y={"y1": 1.0, "y2": 4.0, "y3": 4.0}, d={"stick": _NOT_STUCK}, terminal={"gamma": _AT_THE_END}),
        Limits(
            y={"y1": (LEAST_ENGINE_SPEED, None), "y2": (0.0, None), "y3": (-11.0, 11.0)},
            terminal=clutch_terminal_set(model),
        ),
        references=tuple(CERTIFIED_REFERENCE),
        gap_abs=gap,
        gap_rel=0.0,
    )


def clutch_terminal_set(model: Model) -> tuple[Matrix, Matrix]:
    """Rows ``S x <= T`` of the states in which plans end."""
    names = [v.name for v in model.dha.x]
    rows = list(_rows(model.parameters))
    S = np.array([[terms.get(name, 0.0) for name in names] for terms, _ in rows])
    return S, np.array([side for _, side in rows])


def _rows(p: Mapping[str, float]) -> Iterator[Row]:
    low, high = _PRESS
    yield {"we": p["b"], "Fn": -p["mu"]}, -low
    yield {"we": -p["b"], "Fn": p["mu"]}, high
    yield {"Te": 1.0, "Fn": -p["mu"]}, _LEAD
    yield {"Te": -1.0, "Fn": p["mu"]}, _LAG
    yield {"we": p["b"], "gamma": -p["b"], "Te": -1.0}, 0.0
    yield {"gamma": -1.0}, 0.0
    yield {"lc": 1.0}, _CALM
    yield {"lc": -1.0}, _CALM
    yield {"we": -1.0}, -LEAST_ENGINE_SPEED
    yield from _catching_up(p)
    yield from _coming_down(p)


def _catching_up(p: Mapping[str, float]) -> Iterator[Row]:
    """What the engine loses until its torque, at its fastest rate, is that of the clutch."""
    step, share = p["Te_rate"] * p["ts"], p["ts"] / p["Je"]
    for j in range(1, int(_LAG / step) + 2):
        lost = share * j
        yield {"we": -1.0, "Fn": lost * p["mu"], "Te": -lost}, share * step * j * (j - 1) / 2 - LEAST_ENGINE_SPEED


def _coming_down(p: Mapping[str, float]) -> Iterator[Row]:
    """What both sides gain, once stuck, until the engine torque has come down to the load."""
    step, share = p["Te_rate"] * p["ts"], p["ts"] / (p["Je"] + p["Jv"])
    for j in range(1, 14):
        won = share * j
        terms = {"we": 1.0 - won * p["b"], "gamma": won * p["b"], "Te": won}
        yield terms, _MOST_SPEED + share * step * j * (j - 1) / 2
