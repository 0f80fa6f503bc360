"""Many active sets at once: laws, regions, facets and candidates beyond them; the kernel that workers run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.facets import facets, inner_point, same_rows
from hysdel_py.optimize.parametric.factor import factor
from hysdel_py.optimize.parametric.nearest import FOUND, LOST
from hysdel_py.optimize.parametric.neighbours import sets_beyond
from hysdel_py.optimize.parametric.region import region_rows, stationary
from hysdel_py.optimize.parametric.settings import MpQpSettings
from hysdel_py.optimize.parametric.vectors import doubled

__all__ = ["DEPENDENT", "EMPTY", "REGION", "UNCLEAR", "Batch", "explore_chunk"]

REGION, EMPTY, DEPENDENT, UNCLEAR = 0, 1, 2, 3
"""What an active set turned out to be."""

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Batch:
    """What is known about some active sets, region after region and facet after facet.

    Attributes
    ----------
    status : int array, one entry per active set
        REGION, EMPTY, DEPENDENT or UNCLEAR.
    laws : array of shape (regions, n, p + 2)
        Of those that are regions, in their order.
    centres : array of shape (regions, p)
    facets : int array of shape (regions,)
        Number of facets.
    lost : int array of shape (regions,)
        Rows that could not be judged.
    N, h : arrays of shapes (rows, p), (rows,)
        Facets as rows of length one.
    points : array of shape (rows, p)
        One on each facet.
    kinds : int array of shape (rows, 3)
        Row of each facet (-1: of the domain), whether another row says the same, number of candidates beyond it.
    candidates : int array of shape (candidates, n)
        Active sets, padded with -1.
    """

    status: Numbers
    laws: NDArray[np.float64]
    centres: Matrix
    facets: Numbers
    lost: Numbers
    N: Matrix
    h: Vector
    points: Matrix
    kinds: Numbers
    candidates: Numbers

    def first(self, sets: int) -> Batch:
        """The part about the first active sets."""
        if sets >= len(self.status):
            return self
        regions = int(np.sum(self.status[:sets] == REGION))
        rows = int(self.facets[:regions].sum())
        return Batch(
            self.status[:sets],
            self.laws[:regions],
            self.centres[:regions],
            self.facets[:regions],
            self.lost[:regions],
            self.N[:rows],
            self.h[:rows],
            self.points[:rows],
            self.kinds[:rows],
            self.candidates[: int(self.kinds[:rows, 2].sum())],
        )


def explore_chunk(form: Canonical, settings: MpQpSettings, sets: Numbers, guesses: Matrix) -> Batch:
    """Everything about some active sets; runs in worker processes.

    Parameters
    ----------
    form : Canonical
    settings : MpQpSettings
    sets : int array of shape (q, n)
        Ascending, padded with -1.
    guesses : array of shape (q, p)
        Points near their regions.
    """
    tolerances = (settings.radius, settings.violation, settings.angle, settings.exchange, settings.zero, settings.same)
    return Batch(*_explore(form.M, form.b, form.c, form.domain, sets, guesses, settings.margins, tolerances))


@compiled
def _explore(M: Any, b: Any, c: Any, domain: Any, sets: Any, guesses: Any, margins: Any, tolerances: Any) -> Any:
    """The fields of a batch."""
    n, p = M.shape[1], b.shape[1] - 2
    exchange = tolerances[3]
    status = np.empty(len(sets), dtype=np.int64)
    laws, centres = np.empty((len(sets), n, p + 2)), np.empty((len(sets), p))
    sizes, lost = np.empty(len(sets), dtype=np.int64), np.empty(len(sets), dtype=np.int64)
    room = 16 * len(sets)
    N, h, points = np.empty((room, p)), np.empty(room), np.empty((room, p))
    kinds, candidates = np.empty((room, 3), dtype=np.int64), np.empty((room, n), dtype=np.int64)
    regions: Any = np.int64(0)  # not a literal: kernels would be compiled for it
    rows, count = regions, regions
    for number in range(len(sets)):
        active = _members(sets[number])
        answer, v, Qt, R, centre, own_N, own_h, source, shared, own_points, unjudged = _explore_one(
            M, b, c, domain, active, guesses[number], margins, tolerances
        )
        status[number] = answer
        if answer != REGION:
            continue
        if len(c):
            Qt, R, _ = factor(M[active], 0.0)
        factors = (Qt, R, np.empty(n + 1), np.empty(n + 1))
        laws[regions], centres[regions], sizes[regions], lost[regions] = v, centre, len(own_h), unjudged
        regions += 1
        for facet in range(len(own_h)):
            N, h, points, kinds = doubled(N, rows), doubled(h, rows), doubled(points, rows), doubled(kinds, rows)
            N[rows], h[rows], points[rows] = own_N[facet], own_h[facet], own_points[facet]
            before = count
            if source[facet] >= 0:
                candidates, count = sets_beyond(M, len(c), active, source[facet], factors, exchange, candidates, count)
            kinds[rows, 0], kinds[rows, 1], kinds[rows, 2] = source[facet], shared[facet], count - before
            rows += 1
    return (
        status, laws[:regions].copy(), centres[:regions].copy(), sizes[:regions].copy(), lost[:regions].copy(),
        N[:rows].copy(), h[:rows].copy(), points[:rows].copy(), kinds[:rows].copy(), candidates[:count].copy(),
    )  # fmt: skip


@compiled
def _members(row: Any) -> Any:
    """An active set without its padding."""
    count = 0
    while count < len(row) and row[count] >= 0:
        count += 1
    return row[:count].copy()


@compiled
def _explore_one(M: Any, b: Any, c: Any, domain: Any, active: Any, guess: Any, margins: Any, tolerances: Any) -> Any:
    """Status, law, factor, inner point, facets with their sources, whether they are shared, points; rows not judged."""
    radius, violation, angle, _, zero, same = tolerances
    regular, v, multipliers, Qt, R = stationary(M, b, c, active, angle)
    N, h, source = np.empty((0, b.shape[1] - 2)), np.empty(0), np.empty(0, dtype=np.int64)
    if not regular:
        return DEPENDENT, v, Qt, R, guess, N, h, source, source, N, 0
    possible, N, h, source = region_rows(M, b, domain, active, v, multipliers, zero)
    if not possible:
        return EMPTY, v, Qt, R, guess, N, h, source, source, N, 0
    status, centre = inner_point(N, h, guess, margins, violation, angle)
    if status != FOUND:
        return (UNCLEAR if status == LOST else EMPTY), v, Qt, R, guess, N, h, source, source, N, 0
    first = same_rows(N, h, same)
    own = np.flatnonzero(first == np.arange(len(first)))
    is_facet, points, lost = facets(N[own], h[own], centre, radius, violation, angle)
    chosen = np.flatnonzero(is_facet)
    kept = own[chosen]
    twins = np.zeros(len(first), dtype=np.int64)
    for row in range(len(first)):
        twins[first[row]] += 1
    shared = (twins[kept] > 1).astype(np.int64)
    return REGION, v, Qt, R, centre, N[kept], h[kept], source[kept], shared, points[chosen], lost
