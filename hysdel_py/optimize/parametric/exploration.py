"""Exploration of the map of critical regions in waves of active sets."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, field
from enum import Enum
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.beyond import Beyond, Verdict
from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.point import PointStatus, solve_at
from hysdel_py.optimize.parametric.records import ActiveSet, FoundRegion, Task, explore_chunk
from hysdel_py.optimize.parametric.region import UNCLEAR
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Exploration", "Progress", "Stop"]

Vector = NDArray[np.float64]
Progress = Callable[[int, int], None]

_STARTS = 50
"""Points tried for a first region."""


class Stop(Enum):
    """Why an exploration ended."""

    DONE = "nothing left to explore"
    REGIONS = "limit of regions"
    SECONDS = "limit of time"
    INTERRUPTED = "interrupted"
    NO_START = "no first region was found"


@dataclass(slots=True)
class Exploration:
    """One run over the active sets of a canonical problem.

    Attributes
    ----------
    form : Canonical
    settings : MpQpSettings
    executor : Executor, optional
        Anything with ``submit``; the results do not depend on it.
    progress : callable, optional
        Called after each wave with the numbers of regions found and of active sets waiting.
    """

    form: Canonical
    settings: MpQpSettings
    executor: Executor | None = None
    progress: Progress | None = None
    regions: dict[ActiveSet, FoundRegion] = field(default_factory=dict)
    seen: set[ActiveSet] = field(default_factory=set)
    unclear: int = 0
    points: int = 0
    verdicts: dict[tuple[ActiveSet, int], Verdict] = field(default_factory=dict)
    started: float = field(default_factory=perf_counter)

    def run(self) -> Stop:
        """Explore until nothing is left or a limit is reached."""
        try:
            return self._run()
        except KeyboardInterrupt:
            return Stop.INTERRUPTED

    def _run(self) -> Stop:
        wave = self._first()
        if not wave:
            return Stop.NO_START
        while wave:
            stop = self._explore(wave)
            if stop is not None:
                return stop
            wave = self._beyond_open_facets()
        return Stop.DONE

    def _first(self) -> list[Task]:
        """An active set that is optimal on a region, from points around the inner point."""
        rng = np.random.default_rng(0)
        inner = self.form.inner[self.form.n :]
        for attempt in range(_STARTS):
            s = inner + (0.0 if attempt == 0 else 10.0 ** -rng.integers(1, 7)) * rng.uniform(-1, 1, self.form.p)
            self.points += 1
            point = solve_at(self.form, s, self.settings)
            if point.status is not PointStatus.OPTIMAL:
                continue
            ((_, _, region),) = explore_chunk(self.form, self.settings, [Task(point.active, s)])
            if region is not None:
                return [Task(point.active, s)]
        return []

    def _explore(self, wave: list[Task]) -> Stop | None:
        """Follow exchanges of rows until no new active set turns up."""
        self.seen.update(task.active for task in wave)
        while wave:
            found: list[FoundRegion] = []
            for active, status, region in self._results(wave):
                self.unclear += status == UNCLEAR
                if region is not None:
                    self.regions[active] = region
                    found.append(region)
                stop = self._limit()
                if stop is not None:
                    return stop
            wave = self._next(found)
            if self.progress is not None:
                self.progress(len(self.regions), len(wave))
        return None

    def _limit(self) -> Stop | None:
        if len(self.regions) >= self.settings.regions:
            return Stop.REGIONS
        if perf_counter() - self.started > self.settings.seconds:
            return Stop.SECONDS
        return None

    def _results(self, wave: list[Task]) -> Iterator[tuple[ActiveSet, int, FoundRegion | None]]:
        size = self.settings.chunk
        chunks = [wave[start : start + size] for start in range(0, len(wave), size)]
        if self.executor is None:
            for chunk in chunks:
                yield from explore_chunk(self.form, self.settings, chunk)
            return
        futures = [self.executor.submit(explore_chunk, self.form, self.settings, chunk) for chunk in chunks]
        for future in futures:
            yield from future.result()

    def _next(self, found: list[FoundRegion]) -> list[Task]:
        """Active sets beyond the facets of new regions, in an order of their own."""
        new: dict[ActiveSet, Vector] = {}
        for region in found:
            for facet, point in zip(region.facets, region.points, strict=True):
                for active in facet.beyond:
                    if active not in self.seen and len(active) <= self.form.n:
                        self.seen.add(active)
                        new[active] = point
        return [Task(active, new[active]) for active in sorted(new)]

    def _beyond_open_facets(self) -> list[Task]:
        """Active sets that single points beyond facets show, where exchanges of rows have left it open."""
        judge = Beyond(self.form, self.settings, self.regions)
        new: dict[ActiveSet, Vector] = {}
        for key, region, facet in judge.open_facets(self.verdicts):
            verdict, tasks = judge.settle(region, facet)
            if not tasks:
                self.verdicts[key] = verdict
            for task in tasks:
                if task.active not in self.seen:
                    self.seen.add(task.active)
                    new[task.active] = task.guess
        self.points += judge.points
        return [Task(active, new[active]) for active in sorted(new)]
