"""Active sets beyond the facets of a region, by exchange of rows (see the table in docs/mpqp.md)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.factor import factor, solve_upper

__all__ = ["ActiveSet", "sets_beyond"]

ActiveSet = tuple[int, ...]


def sets_beyond(form: Canonical, active: ActiveSet, source: NDArray[np.int64], tolerance: float) -> list[Any]:
    """For each facet a tuple of the active sets that may lie beyond it.

    Parameters
    ----------
    form : Canonical
    active : tuple of int
    source : int array of shape (f,)
        Row of each facet: of the problem, ``m + `` place of a multiplier, or -1 for the domain.
    tolerance : float
        Sine of the angle from which a row is independent.
    """
    entering = np.flatnonzero((source >= 0) & (source < form.m))
    exchanges = _entering(form, active, source[entering], tolerance)
    beyond: list[Any] = [()] * len(source)
    for facet, sets in zip(entering.tolist(), exchanges, strict=True):
        beyond[facet] = sets
    for facet in np.flatnonzero(source >= form.m).tolist():
        beyond[facet] = _leaving(form, active, int(source[facet]) - form.m, tolerance)
    return beyond


def _entering(
    form: Canonical, active: ActiveSet, rows: NDArray[np.int64], tolerance: float
) -> list[tuple[ActiveSet, ...]]:
    """A row that is violated beyond the facet enters, in exchange for another if it depends on the active ones."""
    if not len(active):
        return [((row,),) for row in rows.tolist()]
    k = len(active)
    Qt, R, _ = factor(form.M[list(active)], 0.0)
    parts = Qt @ form.M[rows].T
    rest = parts[k:]
    independent = (rest * rest).sum(axis=0) > tolerance**2
    if independent.all():
        return [(_with(active, row),) for row in rows.tolist()]
    weights = solve_upper(R, k, parts[:k].copy()).T
    return [
        (_with(active, row),) if alone else _exchanged(active, row, weight > tolerance)
        for row, alone, weight in zip(rows.tolist(), independent, weights, strict=True)
    ]


def _with(active: ActiveSet, row: int) -> ActiveSet:
    return tuple(sorted((*active, row)))


def _exchanged(active: ActiveSet, row: int, positive: NDArray[np.bool_]) -> tuple[ActiveSet, ...]:
    places = np.flatnonzero(positive).tolist()
    return tuple(_with(active[:place] + active[place + 1 :], row) for place in places)


def _leaving(form: Canonical, active: ActiveSet, place: int, tolerance: float) -> tuple[ActiveSet, ...]:
    """A row with a negative multiplier leaves, in exchange for a blocking row if v2 is no longer fixed."""
    rest = active[:place] + active[place + 1 :]
    if not form.free:
        return (rest,)
    flat = form.M[:, form.n - form.free :]
    _, size, directions = np.linalg.svd(flat[list(rest)].reshape(len(rest), form.free))
    if len(size) == form.free and size[-1] > tolerance:
        return (rest,)
    speed = flat @ directions[-1]
    if speed[active[place]] > 0:
        speed = -speed
    speed[list(active)] = 0.0
    return tuple(_with(rest, row) for row in np.flatnonzero(speed > tolerance).tolist())
