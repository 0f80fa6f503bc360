"""What the exploration keeps of each active set, and the step that workers take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.neighbours import ActiveSet, sets_beyond
from hysdel_py.optimize.parametric.region import REGION, explore
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["ActiveSet", "Facet", "FoundRegion", "Task", "explore_chunk"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Facet:
    """What may lie beyond one facet.

    Attributes
    ----------
    on_domain : bool
        It bounds the domain of theta.
    shared : bool
        Several rows say the same.
    beyond : tuple of active sets
        Candidates from exchanges of rows.
    """

    on_domain: bool
    shared: bool
    beyond: tuple[ActiveSet, ...]


@dataclass(frozen=True, eq=False, slots=True)
class FoundRegion:
    """A region in scaled parameters.

    Attributes
    ----------
    active : tuple of int
    v : array of shape (n, p + 2)
        Law.
    centre : array of shape (p,)
    N, h : arrays of shapes (r, p), (r,)
        Facets as rows of length one.
    points : array of shape (r, p)
        One on each facet.
    facets : tuple of Facet
    lost : int
        Rows that could not be judged.
    """

    active: ActiveSet
    v: Matrix
    centre: Vector
    N: Matrix
    h: Vector
    points: Matrix
    facets: tuple[Facet, ...]
    lost: int

    def holds(self, s: Vector, tolerance: float) -> bool:
        """Whether a point lies in the region up to a tolerance."""
        return bool(np.all(self.N @ s <= self.h + tolerance))


@dataclass(frozen=True, eq=False, slots=True)
class Task:
    """An active set to be looked at, and a point near its region."""

    active: ActiveSet
    guess: Vector


def explore_chunk(
    form: Canonical, settings: MpQpSettings, tasks: Sequence[Task]
) -> list[tuple[ActiveSet, int, FoundRegion | None]]:
    """Status of each active set, and its region if it has one; runs in worker processes."""
    margins = settings.margins
    return [(task.active, *_explored(form, task, margins, settings)) for task in tasks]


def _explored(form: Canonical, task: Task, margins: Vector, settings: MpQpSettings) -> tuple[int, FoundRegion | None]:
    answer = explore(form, np.array(task.active, dtype=np.int64), task.guess, margins, settings)
    if answer.status != REGION:
        return answer.status, None
    sets = sets_beyond(form, task.active, answer.source, settings.exchange)
    facets = tuple(map(Facet, (answer.source < 0).tolist(), answer.shared.tolist(), sets))
    return REGION, FoundRegion(
        task.active, answer.v, answer.centre, answer.N, answer.h, answer.points, facets, answer.lost
    )
