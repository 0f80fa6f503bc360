"""Why a state and input lie in no mode of a piecewise affine system, in words of the source."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.search_tree import Place
from hysdel_py.systems.mode import Condition, RowKind

if TYPE_CHECKING:
    from hysdel_py.systems.pwa import Pwa

__all__ = ["reason_outside"]

_UNEXPLORED = "the state and input lie in no mode that was found; the search was stopped by its limit"


def reason_outside(pwa: Pwa, w: NDArray[np.float64], place: Place) -> str:
    """One line.

    Parameters
    ----------
    w : array of shape (nx + nu,)
    place : Place
        Where the walk through the tree ended.
    """
    if place.in_gap:
        return _gap(pwa.tests[place.test])
    if place.leaf >= len(pwa.owner):
        return _violated(pwa.dead_ends[place.leaf - len(pwa.owner)])
    source = _broken_row(pwa, w, place)
    if source is not None:
        return _violated(source)
    return "the state and input lie in no mode" if pwa.is_complete else _UNEXPLORED


def _broken_row(pwa: Pwa, w: NDArray[np.float64], place: Place) -> Condition | None:
    """The row that the point violates most, in the mode where the walk ended or in the nearest one."""
    if not pwa.modes or (place.leaf < 0 and not pwa.is_complete):
        return None
    modes = [pwa.modes[pwa.owner[place.leaf]]] if place.leaf >= 0 else pwa.modes
    excess = [np.max(-mode.region.slack(w), initial=0.0) for mode in modes]
    nearest = modes[int(np.argmin(excess))]
    if not nearest.sources:
        return None
    return nearest.sources[int(np.argmin(nearest.region.slack(w)))]


def _violated(source: Condition) -> str:
    if source.kind is RowKind.EVENT:
        return _gap(source)
    place = f"line {source.line}: " if source.line else ""
    if source.kind is RowKind.MUST:
        return f"MUST is violated in {place}{source.text}"
    return f"the state and input lie in no mode: {place}{source.text} is violated"


def _gap(source: Condition) -> str:
    place = f"line {source.line}: " if source.line else ""
    return f"the state and input lie in the epsilon gap of {source.name}, in {place}{source.text}"
