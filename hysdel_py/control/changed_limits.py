"""Other numbers for the limits of a controller, for one call: the matrices stay, only ends of rows and bounds move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import isfinite
from typing import Any, TypeAlias

import numpy as np

from hysdel_py.control.bands import Band, ResolvedLimits
from hysdel_py.control.bounds import variable_bounds
from hysdel_py.control.formulation import Formulation
from hysdel_py.control.limits import DEFAULT_PRICE, Limits
from hysdel_py.control.rows import Row
from hysdel_py.errors import ArgumentError

__all__ = ["for_call", "merged", "with_limits"]

Key: TypeAlias = tuple[str, int]
Place: TypeAlias = tuple[str, int, int, str]
_GROUPS = ("x", "y", "u", "du", "terminal")


def for_call(formulation: Formulation, own: Limits, call: Limits | None, *, soft: bool = False) -> Formulation:
    """The program of one call.

    Parameters
    ----------
    formulation : Formulation
    own : Limits
        Those of the controller.
    call : Limits, optional
        Those of the call; without them the program stays as it is.
    soft : bool
        Whether the program has all limits softened.

    Raises
    ------
    ArgumentError
        See :func:`merged` and :func:`with_limits`.
    """
    if call is None:
        return formulation
    if not isinstance(call, Limits):
        raise ArgumentError(f"limits is a {type(call).__name__}: a Limits was expected")
    now = merged(own, call)
    layout = formulation.layout
    resolved = (replace(now, soft=True) if soft else now).resolve(layout.mld, layout.horizon)
    before = formulation.limits
    return with_limits(formulation, replace(resolved, settled=before.settled, allowance=before.allowance))


def merged(own: Limits, call: Limits) -> Limits:
    """The limits of a controller with those of a call in their place, signal by signal.

    Raises
    ------
    ArgumentError
        A signal that the controller does not limit, or something that belongs to the controller: what is softened, at
        which price, and a terminal polytope.
    """
    if call.soft is not False or call.rho != DEFAULT_PRICE:
        raise ArgumentError(
            "limits of a call have soft or rho: what is softened, and at which price, is the controller's"
        )
    groups = {group: _merged_group(own, call, group) for group in _GROUPS}
    return replace(own, **groups)


def _merged_group(own: Limits, call: Limits, group: str) -> Any:
    before, now = getattr(own, group), getattr(call, group)
    if isinstance(now, Mapping) and not now:
        return before
    if not isinstance(now, Mapping):
        raise ArgumentError(f"limits {group} of a call are {now!r}: a mapping of names to (low, high) was expected")
    known = list(before) if isinstance(before, Mapping) else []
    unknown = [str(name) for name in now if name not in known]
    if unknown:
        raise ArgumentError(
            f"limits {group} of a call name {', '.join(unknown)}, which the controller does not limit; it limits "
            f"{', '.join(known) or 'none of them'}: give it a limit when it is built, as wide as you like"
        )
    return {**before, **now}


def with_limits(formulation: Formulation, limits: ResolvedLimits) -> Formulation:
    """The same program with other numbers in its limits.

    Parameters
    ----------
    formulation : Formulation
    limits : ResolvedLimits
        Of the same signals, with the same slacks.

    Raises
    ------
    ArgumentError
        A limit where the program has no row for it: a side, at some time, on which the controller has no limit.
    """
    bands: dict[Key, Band] = {(band.group, band.column): band for band in limits.bands}
    _check_places(formulation, limits)
    low, high = formulation.low.copy(), formulation.high.copy()
    rows = list(formulation.rows)
    for i, row in enumerate(rows):
        if row.band is not None:
            band = bands[row.band]
            least, most = limits.ends(band, row.stage)
            hard = limits.slack_of(band) is None
            low[i] = least if hard or isfinite(low[i]) else -np.inf
            high[i] = most if hard or isfinite(high[i]) else np.inf
            rows[i] = Row.of_band(band, row.stage)
    lb, ub = variable_bounds(formulation.layout, limits)
    return replace(
        formulation, limits=limits, low=low, high=high, lb=lb, ub=ub, rows=tuple(rows),
        unmovable=tuple(bands[band.group, band.column] for band in formulation.unmovable),
    )  # fmt: skip


def _check_places(formulation: Formulation, limits: ResolvedLimits) -> None:
    known = set(_known_places(formulation))
    for place in _wanted_places(formulation, limits):
        if place not in known:
            group, column, time, side = place
            band = next(b for b in limits.bands if (b.group, b.column) == (group, column))
            raise ArgumentError(
                f"limit {group} of {band.name}: the controller has no {side} end at k = {time}, so a call cannot "
                "change it; give it one when it is built, as wide as you like"
            )


def _known_places(formulation: Formulation) -> Iterator[Place]:
    """Where the program has a row: a hard limit has both ends in one row."""
    soft = {(b.group, b.column): formulation.limits.slack_of(b) is not None for b in formulation.limits.bands}
    for i, row in enumerate(formulation.rows):
        if row.band is not None:
            if not soft[row.band] or isfinite(formulation.low[i]):
                yield (*row.band, row.stage, "lower")
            if not soft[row.band] or isfinite(formulation.high[i]):
                yield (*row.band, row.stage, "upper")


def _wanted_places(formulation: Formulation, limits: ResolvedLimits) -> Iterator[Place]:
    """Where limits need a row; hard ones of states and inputs are bounds of variables."""
    unmovable = {(band.group, band.column) for band in formulation.unmovable}
    for band in limits.bands:
        for time in _times(band, limits, formulation.layout.horizon):
            if time or (band.group, band.column) not in unmovable:
                for end, side in zip(band.at(time), ("lower", "upper"), strict=True):
                    if isfinite(end):
                        yield (band.group, band.column, time, side)


def _times(band: Band, limits: ResolvedLimits, horizon: int) -> range:
    """Times at which a limit has rows, as :func:`row_blocks` makes them."""
    soft = limits.slack_of(band) is not None
    match band.group:
        case "y" | "du":
            return range(horizon)
        case "x" if soft:
            return range(1, horizon + 1)
        case "final":
            return range(horizon, horizon + 1)
        case "terminal" if soft:
            return range(horizon, horizon + 1)
        case _:
            return range(0)
