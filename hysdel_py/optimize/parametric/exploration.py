"""Exploration of the map of critical regions, active set after active set in the order in which they are met."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field
from enum import Enum
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.atlas import Atlas
from hysdel_py.optimize.parametric.batch import REGION, UNCLEAR, Batch, explore_chunk
from hysdel_py.optimize.parametric.beyond import Beyond, Verdict
from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.frontier import Frontier
from hysdel_py.optimize.parametric.point import PointStatus, solve_at
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["Exploration", "Progress", "Stop"]

Vector = NDArray[np.float64]
Numbers = NDArray[np.int64]
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
        Called after each chunk with the numbers of regions found and of active sets waiting.
    """

    form: Canonical
    settings: MpQpSettings
    executor: Executor | None = None
    progress: Progress | None = None
    started: float = field(default_factory=perf_counter)
    frontier: Frontier = field(init=False)
    batches: list[tuple[Batch, Numbers]] = field(default_factory=list)
    explored: int = 0
    found: int = 0
    unclear: int = 0
    points: int = 0
    verdicts: dict[int, Verdict] = field(default_factory=dict)
    _stacked: tuple[int, Atlas | None] = (0, None)

    def __post_init__(self) -> None:
        self.frontier = Frontier.empty(self.form.n, self.form.p)

    def run(self) -> Stop:
        """Explore until nothing is left or a limit is reached."""
        try:
            return self._run()
        except KeyboardInterrupt:
            return Stop.INTERRUPTED

    @property
    def atlas(self) -> Atlas | None:
        """What has been found; None before the first region."""
        if self._stacked[0] != len(self.batches):
            batches, links = zip(*self.batches, strict=True)
            self._stacked = len(self.batches), Atlas.of(batches, links, self.frontier.count)
        return self._stacked[1]

    def _run(self) -> Stop:
        if not self._find_first():
            return Stop.NO_START
        while True:
            stop = self._explore()
            if stop is not None:
                return stop
            if not self._look_beyond_open_facets():
                return Stop.DONE

    def _find_first(self) -> bool:
        """Explore an active set that is optimal on a region, from points around the inner point."""
        rng = np.random.default_rng(0)
        inner = self.form.inner[self.form.n :]
        for attempt in range(_STARTS):
            s = inner + (0.0 if attempt == 0 else 10.0 ** -rng.integers(1, 7)) * rng.uniform(-1, 1, self.form.p)
            self.points += 1
            point = solve_at(self.form, s, self.settings)
            if point.status is not PointStatus.OPTIMAL:
                continue
            sets, guesses = self.frontier.row(point.active)[None], s[None]
            batch = explore_chunk(self.form, self.settings, sets, guesses)
            if batch.status[0] == REGION:
                self.frontier.add(sets, guesses)
                self._merge(batch)
                return True
        return False

    def _explore(self) -> Stop | None:
        """Follow exchanges of rows until no new active set turns up."""
        stop = self._limit()
        if stop is not None:
            return stop
        for batch in self._results():
            self._merge(batch)
            stop = self._limit()
            if stop is not None:
                return stop
        return None

    def _merge(self, batch: Batch) -> None:
        """Keep what a chunk gave, up to the limit of regions, and queue what may lie beyond."""
        reached = self.found + np.cumsum(batch.status == REGION)
        batch = batch.first(1 + int(np.searchsorted(reached, self.settings.regions)))
        links = self.frontier.add(batch.candidates, np.repeat(batch.points, batch.kinds[:, 2], axis=0))
        self.batches.append((batch, links))
        self.explored += len(batch.status)
        self.found += len(batch.facets)
        self.unclear += int(np.sum(batch.status == UNCLEAR))
        if self.progress is not None:
            self.progress(self.found, self.frontier.count - self.explored)

    def _limit(self) -> Stop | None:
        if self.found >= self.settings.regions:
            return Stop.REGIONS
        if perf_counter() - self.started > self.settings.seconds:
            return Stop.SECONDS
        return None

    def _results(self) -> Iterator[Batch]:
        """Answers to the waiting active sets, chunk after chunk; the queue grows meanwhile."""
        if self.executor is not None:
            yield from self._results_of(self.executor)
            return
        while self.explored < self.frontier.count:
            yield explore_chunk(self.form, self.settings, *self._chunk(self.explored))

    def _results_of(self, executor: Executor) -> Iterator[Batch]:
        """The same in the same order, with all that waits handed to an executor."""
        futures: deque[Future[Batch]] = deque()
        submitted = self.explored
        try:
            while True:
                while submitted < self.frontier.count:
                    chunk = self._chunk(submitted)
                    futures.append(executor.submit(explore_chunk, self.form, self.settings, *chunk))
                    submitted += len(chunk[0])
                if not futures:
                    return
                yield futures.popleft().result()
        finally:
            for future in futures:
                future.cancel()

    def _chunk(self, first: int) -> tuple[Numbers, NDArray[np.float64]]:
        last = min(first + self.settings.chunk, self.frontier.count)
        return self.frontier.sets[first:last].copy(), self.frontier.guesses[first:last].copy()

    def _look_beyond_open_facets(self) -> bool:
        """Queue active sets that single points beyond facets show, where exchanges of rows have left it open."""
        atlas = self.atlas
        assert atlas is not None
        judge = Beyond(self.form, self.settings, atlas, self.frontier)
        before = self.frontier.count
        for row in judge.open_rows(self.verdicts):
            verdict, missing = judge.settle(row)
            if missing is None:
                self.verdicts[row] = verdict
            else:
                self.frontier.add(self.frontier.row(missing[0])[None], missing[1][None])
        self.points += judge.points
        return self.frontier.count > before
