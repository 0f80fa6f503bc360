"""What lies beyond a facet: a stored region, an infeasible point, or an active set that was missed.

The facet, moved outwards by a little, must be covered by stored regions and by half-spaces that rays of Farkas prove to
be infeasible. An uncovered point is solved on its own; its active set is the missing one.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.atlas import Atlas
from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.cover import Rows, uncovered_point
from hysdel_py.optimize.parametric.facets import inner_point_in
from hysdel_py.optimize.parametric.frontier import Frontier, find
from hysdel_py.optimize.parametric.nearest import FOUND, workspace
from hysdel_py.optimize.parametric.point import PointStatus, solve_at
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Beyond", "Verdict"]

Vector = NDArray[np.float64]
Missing = tuple[tuple[int, ...], Vector]

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
    atlas : Atlas
    frontier : Frontier
    points : int
        Number of single points solved.
    """

    form: Canonical
    settings: MpQpSettings
    atlas: Atlas
    frontier: Frontier
    points: int = 0

    def open_rows(self, settled: Container[int]) -> list[int]:
        """Rows of the atlas whose far side the exchange of rows does not settle."""
        kinds = self.atlas.kinds
        asked = (kinds[:, 0] >= 0) & ((kinds[:, 1] > 0) | self.atlas.not_crossed() | self.settings.thorough)
        return [row for row in np.flatnonzero(asked).tolist() if row not in settled]

    def settle(self, row: int) -> tuple[Verdict, Missing | None]:
        """Verdict on a facet, or an active set that it shows to be missing and a point in its region."""
        strip, margin = self._strip(row)
        covers = [self.atlas.rows(region) for region in self.atlas.beyond(row)]
        verdict = Verdict.REGIONS if covers else Verdict.EDGE
        for _ in range(_PIECES_SHARED if self.atlas.kinds[row, 1] else _PIECES):
            s = uncovered_point(strip, covers, 0.1 * _STEP * margin, self.settings)
            if s is None:
                return verdict, None
            self.points += 1
            point = solve_at(self.form, s, self.settings)
            if point.status is PointStatus.INFEASIBLE:
                covers.append(_half_space(point.ray))
                continue
            if point.status is not PointStatus.OPTIMAL:
                return Verdict.OPEN, None
            home, explored = self._home(point.active, s)
            if home < 0:
                return Verdict.OPEN, None if explored else (point.active, s)
            covers.append(self.atlas.rows(home))
            verdict = Verdict.REGIONS
        return Verdict.SAMPLED, None

    def _home(self, active: tuple[int, ...], s: Vector) -> tuple[int, bool]:
        """Stored region that holds a point, and whether the given active set has been explored."""
        number = int(find(self.frontier.table, self.frontier.sets, self.frontier.row(active)))
        explored = 0 <= number < len(self.atlas.region_of)
        first = int(self.atlas.region_of[number]) if explored else -1
        return self.atlas.home(s, first, 10 * self.settings.radius), explored

    def _strip(self, row: int) -> tuple[Rows, float]:
        """The facet moved outwards, thin in that direction and kept away from its edges."""
        atlas, settings = self.atlas, self.settings
        region = atlas.region_of_row(row)
        N, h = atlas.rows(region)
        place = row - int(atlas.starts[region])
        rows, sides, margin = _strip(
            N, h, place, atlas.points[row], self.form.domain, settings.margins, settings.violation, settings.angle
        )
        return (rows, sides), margin


@compiled
def _strip(N: Any, h: Any, facet: int, point: Any, domain: Any, margins: Any, violation: float, angle: float) -> Any:
    """Rows and sides of the strip beyond a facet, and the distance that it keeps from the edges."""
    f, n = N.shape
    rows, sides = np.empty((f + 1 + len(domain), n)), np.empty(f + 1 + len(domain))
    rows[:f], rows[f] = N, -N[facet]
    work, x, margin = workspace(n), point.copy(), margins[-1]
    for margin in margins:
        step = _STEP * margin
        for row in range(f):
            sides[row] = h[row] - margin
        sides[facet], sides[f] = h[facet] + 2 * step, -h[facet] - step
        if inner_point_in(rows, sides, f + 1, point, np.zeros(1), x, work, violation, angle) == FOUND:
            break
    for row in range(len(domain)):
        rows[f + 1 + row], sides[f + 1 + row] = domain[row, 1:], domain[row, 0]
    return rows, sides, margin


def _half_space(ray: Vector) -> Rows:
    """Where ``ray (1, s) <= 0``: nothing is feasible inside."""
    length = float(np.linalg.norm(ray[1:]))
    return ray[None, 1:] / length, -ray[:1] / length
