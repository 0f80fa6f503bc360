"""All regions found so far, stacked: row after row, candidate after candidate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.batch import REGION, Batch

__all__ = ["Atlas"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Atlas:
    """Regions in the order in which they were found.

    Attributes
    ----------
    sets : int array of shape (regions,)
        Number of each region's active set in the frontier.
    region_of : int array, one entry per active set
        Its region, or -1.
    laws, centres
        As in :class:`Batch`.
    starts : int array of shape (regions + 1,)
        Where the rows of each region begin.
    N, h, points, kinds
        As in :class:`Batch`.
    links : int array
        Numbers of the candidates' active sets.
    link_starts : int array of shape (rows + 1,)
        Where the candidates beyond each row begin.
    """

    sets: Numbers
    region_of: Numbers
    laws: NDArray[np.float64]
    centres: Matrix
    starts: Numbers
    N: Matrix
    h: Vector
    points: Matrix
    kinds: Numbers
    links: Numbers
    link_starts: Numbers

    @classmethod
    def of(cls, batches: Sequence[Batch], links: Sequence[Numbers], met: int) -> Atlas:
        """Stack batches whose sets follow each other from number 0; `met` sets have been met in all."""
        status = np.concatenate([batch.status for batch in batches])
        sets = np.flatnonzero(status == REGION)
        region_of = np.full(met, -1)
        region_of[sets] = np.arange(len(sets))
        kinds = _stacked(batches, "kinds")
        return cls(
            sets,
            region_of,
            _stacked(batches, "laws"),
            _stacked(batches, "centres"),
            _starts(_stacked(batches, "facets")),
            _stacked(batches, "N"),
            _stacked(batches, "h"),
            _stacked(batches, "points"),
            kinds,
            np.concatenate(links),
            _starts(kinds[:, 2]),
        )

    def rows(self, region: int) -> tuple[Matrix, Vector]:
        """Facets of a region."""
        own = slice(self.starts[region], self.starts[region + 1])
        return self.N[own], self.h[own]

    def region_of_row(self, row: int) -> int:
        """Region that a row belongs to."""
        return int(np.searchsorted(self.starts, row, side="right")) - 1

    def beyond(self, row: int) -> Numbers:
        """Stored regions among the candidates beyond a row."""
        regions = self.region_of[self.links[self.link_starts[row] : self.link_starts[row + 1]]]
        return np.asarray(regions[regions >= 0])

    def not_crossed(self) -> NDArray[np.bool_]:
        """Rows with candidates none of which is a stored region."""
        stored = np.concatenate([[0], np.cumsum(self.region_of[self.links] >= 0)])
        reached = stored[self.link_starts[1:]] - stored[self.link_starts[:-1]]
        return np.asarray((self.kinds[:, 2] > 0) & (reached == 0))

    def home(self, s: Vector, first: int, tolerance: float) -> int:
        """Region that holds a point up to a tolerance, the given one if it does; -1 without one."""
        return int(_home(self.N, self.h, self.starts, s, first, tolerance))


def _stacked(batches: Sequence[Batch], name: str) -> Any:
    return np.concatenate([getattr(batch, name) for batch in batches])


def _starts(sizes: Numbers) -> Numbers:
    return np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(sizes)])


@compiled
def _home(N: Any, h: Any, starts: Any, s: Any, first: int, tolerance: float) -> int:
    if first >= 0 and _excess(N, h, starts[first], starts[first + 1], s, tolerance) <= tolerance:
        return first
    best, least = -1, tolerance
    for region in range(len(starts) - 1):
        excess = _excess(N, h, starts[region], starts[region + 1], s, least)
        if excess <= least:
            best, least = region, excess
    return best


@compiled
def _excess(N: Any, h: Any, first: int, last: int, s: Any, enough: float) -> float:
    """Greatest excess of some rows, or the first that is more than enough."""
    most = -np.inf
    for row in range(first, last):
        excess = -h[row]
        for i in range(len(s)):
            excess += N[row, i] * s[i]
        most = max(most, excess)
        if most > enough:
            break
    return most
