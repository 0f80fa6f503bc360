"""What lies beyond a facet: a stored region, an infeasible point, or an active set that was missed.

The facet, moved outwards by a little, must be covered by stored regions and by half-spaces that rays of Farkas prove to
be infeasible. An uncovered point is solved on its own; its active set is the missing one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.cover import Rows, point_inside, uncovered_point
from hysdel_py.optimize.parametric.point import PointStatus, solve_at
from hysdel_py.optimize.parametric.records import ActiveSet, FoundRegion, Task
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Beyond", "Verdict"]

Vector = NDArray[np.float64]
Key = tuple[ActiveSet, int]

_STEP = 0.1
"""How far beyond a facet one looks, as a share of the distance that is kept from its edges."""

_PIECES, _PIECES_SHARED = 4, 30
"""Most points solved beyond a facet: where the exchange of rows led to a region without inner points, and where several
rows share the facet, so that several regions may lie beyond it."""


class Verdict(Enum):
    """What is known about the far side of a facet."""

    REGIONS = "stored regions"
    SAMPLED = "stored regions at all points tried"
    EDGE = "edge of the feasible set"
    OPEN = "not settled"


@dataclass(slots=True)
class Beyond:
    """Looks beyond the facets of stored regions.

    Attributes
    ----------
    form : Canonical
    settings : MpQpSettings
    regions : mapping of active sets to regions
    points : int
        Number of single points solved.
    """

    form: Canonical
    settings: MpQpSettings
    regions: Mapping[ActiveSet, FoundRegion]
    points: int = 0
    _stacked: Any = None

    def open_facets(self, settled: Mapping[Key, Verdict]) -> Iterator[tuple[Key, FoundRegion, int]]:
        """Facets that the exchange of rows does not settle."""
        for active in sorted(self.regions):
            region = self.regions[active]
            for number, facet in enumerate(region.facets):
                if facet.on_domain or (active, number) in settled:
                    continue
                crossed = not facet.beyond or any(other in self.regions for other in facet.beyond)
                if facet.shared or not crossed or self.settings.thorough:
                    yield (active, number), region, number

    def settle(self, region: FoundRegion, facet: int) -> tuple[Verdict, list[Task]]:
        """Verdict on a facet, or the active sets that it shows to be missing."""
        strip, margin = self._strip(region, facet)
        covers: list[Rows] = []
        verdict = Verdict.EDGE
        for active in region.facets[facet].beyond:
            if active in self.regions:
                covers.append((self.regions[active].N, self.regions[active].h))
                verdict = Verdict.REGIONS
        for _ in range(_PIECES_SHARED if region.facets[facet].shared else _PIECES):
            s = uncovered_point(strip, covers, 0.1 * _STEP * margin, self.settings)
            if s is None:
                return verdict, []
            self.points += 1
            point = solve_at(self.form, s, self.settings)
            if point.status is PointStatus.INFEASIBLE:
                covers.append(_half_space(point.ray))
                continue
            home = self._home(point.active, s) if point.status is PointStatus.OPTIMAL else None
            if home is None:
                missing = point.status is PointStatus.OPTIMAL and point.active not in self.regions
                return Verdict.OPEN, [Task(point.active, s)] if missing else []
            covers.append((home.N, home.h))
            verdict = Verdict.REGIONS
        return Verdict.SAMPLED, []

    def _home(self, active: ActiveSet, s: Vector) -> FoundRegion | None:
        """Stored region that holds a point, the one of its active set first."""
        tolerance = 10 * self.settings.radius
        own = self.regions.get(active)
        if own is not None and own.holds(s, tolerance):
            return own
        if not self._stacked:
            self._stacked = _stack(list(self.regions.values()))
        found, N, h, starts = self._stacked
        excess = np.maximum.reduceat(N @ s - h, starts)
        best = int(np.argmin(excess))
        return found[best] if excess[best] <= tolerance else None

    def _strip(self, region: FoundRegion, facet: int) -> tuple[Rows, float]:
        """The facet moved outwards, thin in that direction and kept away from its edges."""
        N, h, settings = region.N, region.h, self.settings
        kept = np.arange(len(h)) != facet
        for margin in settings.margins:
            step = _STEP * margin
            rows = np.vstack([N[kept], -N[facet : facet + 1], N[facet : facet + 1]])
            sides = np.concatenate([h[kept] - margin, [-h[facet] - step, h[facet] + 2 * step]])
            if point_inside((rows, sides), 0.0, settings, region.points[facet]) is not None:
                break
        domain = self.form.domain
        return (np.vstack([rows, domain[:, 1:]]), np.concatenate([sides, domain[:, 0]])), float(margin)


def _stack(found: list[FoundRegion]) -> Any:
    """Rows of all regions in one matrix, and where each region's begin."""
    starts = np.cumsum([0, *(len(region.h) for region in found[:-1])])
    N, h = np.vstack([region.N for region in found]), np.concatenate([region.h for region in found])
    return found, N, h, starts


def _half_space(ray: Vector) -> Rows:
    """Where ``ray (1, s) <= 0``: nothing is feasible inside."""
    length = float(np.linalg.norm(ray[1:]))
    return ray[None, 1:] / length, -ray[:1] / length
