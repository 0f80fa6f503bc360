"""Ranges with room on both sides, from which the rows of a horizon take their constants."""

from __future__ import annotations

from math import isfinite

from hysdel_py.analysis.encoding import Interval, ranges_by_definition
from hysdel_py.systems.dha import Dha

__all__ = ["ROOM", "with_room"]

ROOM = 2.0
"""Constants of rows are taken from ranges that reach further by this many widths (of at least 1) on both sides."""


def with_room(dha: Dha) -> dict[str, Interval]:
    """Ranges by definition with room on both sides for reals, so that a range is no silent part of a definition."""
    reals = {v.name for v in (*dha.x, *dha.u, *dha.z) if not v.is_bool}
    ranges = ranges_by_definition(dha)
    return {name: _wider(ends) if name in reals else ends for name, ends in ranges.items()}


def _wider(interval: Interval) -> Interval:
    low, high = interval
    if not (isfinite(low) and isfinite(high)):
        return interval
    room = ROOM * max(1.0, high - low)
    return low - room, high + room
