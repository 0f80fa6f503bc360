"""Searches for runs that meet or avoid a condition, by mixed-integer programs over the steps of a Dha."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from hysdel_py.analysis.consistency import Clock
from hysdel_py.analysis.hybrid_set import Span
from hysdel_py.analysis.milp import Answer, Status
from hysdel_py.analysis.monitor import Monitor, Watch
from hysdel_py.analysis.replay import Wish, replayed
from hysdel_py.analysis.runs import Runs, start_runs
from hysdel_py.analysis.settings import DEFAULT_SEARCH_TOLERANCES, SearchTolerances
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Found", "Question", "Searcher", "Verdict", "earliest_meeting", "longest_avoidance"]

Progress = Callable[[int, int], Any]


class Verdict(Enum):
    """What a search over runs found."""

    RUN = "run"
    """There is one, and the simulator confirms it."""
    NONE = "none"
    """There is none, to the tolerance of the solver."""
    NOT_SETTLED = "not settled"


@dataclass(frozen=True, eq=False, slots=True)
class Question:
    """From where, under which inputs, what, and for how long.

    Attributes
    ----------
    dha : Dha
    box : mapping of name to value or (low, high)
        Of the first states.
    start : Monitor or None
        What the first state has to fulfil besides.
    inputs : mapping of name to value or (low, high)
    target : Monitor
    steps : int
    ts : float
        Sample time, for the time axis of runs.
    """

    dha: Dha
    box: Mapping[str, Span]
    start: Monitor | None
    inputs: Mapping[str, Span]
    target: Monitor
    steps: int
    ts: float = 1.0

    @property
    def times(self) -> range:
        """When the target is judged: one that reads more than states cannot be after the last step."""
        return range(self.steps + (not self.target.needs_step))


@dataclass(frozen=True, eq=False, slots=True)
class Found:
    """Answer of a search.

    Attributes
    ----------
    verdict : Verdict
    run : Trajectory or None
    time : int or None
        When the run meets the target.
    message : str
        Why it is not settled.
    borderline : bool
        Whether the run meets what is asked only up to the tolerance of the solver.
    """

    verdict: Verdict
    run: Trajectory | None = None
    time: int | None = None
    message: str = ""
    borderline: bool = False


@dataclass(slots=True)
class Searcher:
    """Poses one problem after the other over rows that grow.

    Attributes
    ----------
    question : Question
    clock : Clock
    calls : int
        Mixed-integer searches so far.
    """

    question: Question
    clock: Clock
    tolerances: SearchTolerances = DEFAULT_SEARCH_TOLERANCES
    calls: int = 0
    _runs: dict[float, Runs] = field(default_factory=dict)
    _watches: dict[tuple[float, int], Watch] = field(default_factory=dict)

    def run(self, steps: int, times: Sequence[int], *, meets: bool) -> Found:
        """A run of so many steps that meets the target at each of some times, or at none of them.

        The closed rows prove that there is none. Where their point is no run, for it stands on the wrong side of a
        threshold, a second search keeps away from the thresholds.
        """
        closed = self._search(0.0, steps, times, meets)
        if closed.verdict is not Verdict.NOT_SETTLED or not closed.run_refused:
            return closed.found
        apart = self._search(self.tolerances.apart, steps, times, meets)
        if apart.verdict is Verdict.NONE:
            return Found(Verdict.NOT_SETTLED, message="only runs that touch a threshold are left: " + closed.message)
        return apart.found

    def _search(self, apart: float, steps: int, times: Sequence[int], meets: bool) -> _Attempt:
        runs = self._grown(apart, steps)
        wishes = [Wish(self._watch(apart, time), meets) for time in times]
        if self.question.start is not None:
            wishes.append(Wish(self._start(apart), True))
        problem = runs.problem.copy()
        for wish in wishes:
            problem.fix(wish.watch.result, float(wish.holds))
        self.calls += 1
        answer = problem.search(seconds=self.clock.left)
        if answer.status is not Status.FOUND:
            return _without_point(answer)
        found = replayed(
            self.question.dha,
            runs,
            problem,
            wishes,
            answer.w,
            course=(steps, self.question.ts),
            tolerances=self.tolerances,
        )
        if found.run is None:
            return _Attempt(Verdict.NOT_SETTLED, found.message, run_refused=True)
        time = times[0] if meets and times else None
        return _Attempt(Verdict.RUN, run=found.run, borderline=found.borderline, time=time)

    def _grown(self, apart: float, steps: int) -> Runs:
        question = self.question
        if apart not in self._runs:
            self._runs[apart] = start_runs(question.dha, question.box, question.inputs, apart)
        runs = self._runs[apart]
        while len(runs.steps) < steps:
            runs.grow()
        return runs

    def _watch(self, apart: float, time: int) -> Watch:
        if (apart, time) not in self._watches:
            self._watches[apart, time] = self._runs[apart].watch(self.question.target, time)
        return self._watches[apart, time]

    def _start(self, apart: float) -> Watch:
        assert self.question.start is not None  # asked for only then
        if (apart, -1) not in self._watches:
            self._watches[apart, -1] = self._runs[apart].watch(self.question.start, 0)
        return self._watches[apart, -1]


@dataclass(frozen=True, eq=False, slots=True)
class _Attempt:
    """What one search gave."""

    verdict: Verdict
    message: str = ""
    run_refused: bool = False
    run: Trajectory | None = None
    borderline: bool = False
    time: int | None = None

    @property
    def found(self) -> Found:
        return Found(self.verdict, self.run, self.time, self.message, self.borderline)


def _without_point(answer: Answer) -> _Attempt:
    if answer.status is Status.NONE:
        return _Attempt(Verdict.NONE)
    return _Attempt(Verdict.NOT_SETTLED, "the search ended without an answer within its time")


def earliest_meeting(searcher: Searcher, progress: Progress | None = None) -> Found:
    """A run that meets the target as early as possible, or that there is none within the steps.

    Times are tried one after the other; those that could not be settled are told in the message.
    """
    target, unsettled = searcher.question.target, ""
    for time in searcher.question.times:
        found = searcher.run(time + target.needs_step, (time,), meets=True)
        if found.verdict is Verdict.RUN:
            return found
        if found.verdict is Verdict.NOT_SETTLED and not unsettled:
            unsettled = f"step {time}: {found.message}"
        if progress is not None:
            progress(time, searcher.calls)
        if searcher.clock.is_over:
            return Found(Verdict.NOT_SETTLED, message=unsettled or f"the time was over after step {time}")
    return Found(Verdict.NOT_SETTLED if unsettled else Verdict.NONE, message=unsettled)


def longest_avoidance(searcher: Searcher, progress: Progress | None = None) -> tuple[Found, int]:
    """A run of all steps that never meets the target, or that there is none; second, the least steps that show that.

    Lengths are tried from the shortest on, since many targets are met long before the end.
    """
    question, found = searcher.question, Found(Verdict.NONE)
    for length in dict.fromkeys((*_doubling(question.steps), question.steps)):
        times = tuple(time for time in question.times if time <= length - question.target.needs_step)
        found = searcher.run(length, times, meets=False)
        if progress is not None:
            progress(length, searcher.calls)
        if found.verdict is Verdict.NONE or searcher.clock.is_over:
            return found, length
    return found, question.steps


def _doubling(steps: int) -> list[int]:
    lengths = [1]
    while 2 * lengths[-1] < steps:
        lengths.append(2 * lengths[-1])
    return [length for length in lengths if length <= steps]
