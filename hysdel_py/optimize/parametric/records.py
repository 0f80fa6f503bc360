"""What the exploration keeps of each active set, and the step that workers take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.region import REGION, explore
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["ActiveSet", "Facet", "FoundRegion", "Task", "explore_chunk"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
ActiveSet = tuple[int, ...]


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
    margins, limits = settings.margins, settings.limits
    return [(task.active, *_explored(form, task, margins, limits)) for task in tasks]


def _explored(form: Canonical, task: Task, margins: Vector, limits: Vector) -> tuple[int, FoundRegion | None]:
    active = np.array(task.active, dtype=np.int64)
    answer = explore(form.M, form.b, form.c, form.domain, active, task.guess, margins, limits)
    status = int(answer[0])
    if status != REGION:
        return status, None
    _, centre, N, h, source, points, shared, beyond, lost = answer
    sets = _sets_beyond(task.active, len(h), beyond)
    facets = tuple(
        Facet(bool(row < 0), bool(same), beyond_it)
        for row, same, beyond_it in zip(source, shared, sets, strict=True)
    )
    return REGION, FoundRegion(task.active, centre, N, h, points, facets, int(lost))


def _sets_beyond(active: ActiveSet, count: int, beyond: NDArray[np.int64]) -> list[tuple[ActiveSet, ...]]:
    sets: list[Any] = [[] for _ in range(count)]
    for facet, leaving, entering in beyond.tolist():
        rows = [row for row in active if row != leaving]
        sets[facet].append(tuple(sorted([*rows, entering])) if entering >= 0 else tuple(rows))
    return [tuple(each) for each in sets]


