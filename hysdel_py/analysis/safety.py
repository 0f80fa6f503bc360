"""Searches for runs that meet or avoid a condition, by mixed-integer programs over the steps of a Dha."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any

from hysdel_py.analysis.clock import Clock
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
        Whether the run meets what is asked only up to the tolerance of the solver, or there is none only among those
        that pass the thresholds of the target by more than a small distance.
    """

    verdict: Verdict
    run: Trajectory | None = None
    time: int | None = None
    message: str = ""
    borderline: bool = False


Apart = tuple[float, float]
"""How far events of the model, and of the target, keep away from their thresholds where they are false."""

_ONLY_TOUCHED = (
    "runs may touch a threshold of the condition, but none passes it by more than {:g} of the size of its row"
)


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
    _runs: dict[Apart, Runs] = field(default_factory=dict)
    _watches: dict[tuple[Apart, int], Watch] = field(default_factory=dict)

    def run(self, steps: int, times: Sequence[int], *, meets: bool) -> Found:
        """A run of so many steps that meets the target at each of some times, or at none of them.

        The closed rows prove that there is none. Where their point is no run, since it stands on the wrong side of a
        threshold, two more searches follow: one for the runs that pass the thresholds of the target by a little more,
        which can prove that no run does, and one that keeps away from the thresholds of the model as well.
        """
        apart, first = self.tolerances.apart, _NOTHING_YET
        for of_model, of_target in ((0.0, 0.0), (0.0, apart), (apart, apart)):
            found, refused = self._search((of_model, of_target), steps, times, meets)
            if found.verdict is Verdict.NONE and of_model:
                break
            if found.verdict is Verdict.NONE:
                return found if not of_target else replace(found, borderline=True, message=_ONLY_TOUCHED.format(apart))
            if found.verdict is Verdict.RUN and not found.borderline:
                return found
            first = found if first.verdict is Verdict.NOT_SETTLED else first
            if not refused:
                break
        return first

    def _search(self, apart: Apart, steps: int, times: Sequence[int], meets: bool) -> tuple[Found, bool]:
        """What one search gave; second, whether another one that keeps apart may give more."""
        runs = self._grown(apart, steps)
        wishes = [Wish(self._watch(apart, time), meets) for time in times]
        if self.question.start is not None:
            wishes.append(Wish(self._start(apart), True))
        problem = runs.problem.copy()
        for wish in wishes:
            problem.fix(wish.watch.result, float(wish.holds))
        self.calls += 1
        answer = problem.search(seconds=self.clock.allowance())
        if answer.status is not Status.FOUND:
            return _without_point(answer), False
        course = (steps, self.question.ts)
        replay = replayed(self.question.dha, runs, problem, wishes, answer.w, course=course, tolerances=self.tolerances)
        if replay.run is None:
            return Found(Verdict.NOT_SETTLED, message=replay.message), True
        time = times[0] if meets and times else None
        return Found(Verdict.RUN, replay.run, time, borderline=replay.borderline), replay.borderline

    def _grown(self, apart: Apart, steps: int) -> Runs:
        question = self.question
        if apart not in self._runs:
            self._runs[apart] = start_runs(question.dha, question.box, question.inputs, apart)
        runs = self._runs[apart]
        while len(runs.steps) < steps:
            runs.grow()
        return runs

    def _watch(self, apart: Apart, time: int) -> Watch:
        if (apart, time) not in self._watches:
            self._watches[apart, time] = self._runs[apart].watch(self.question.target, time)
        return self._watches[apart, time]

    def _start(self, apart: Apart) -> Watch:
        assert self.question.start is not None  # asked for only then
        if (apart, -1) not in self._watches:
            self._watches[apart, -1] = self._runs[apart].watch(self.question.start, 0)
        return self._watches[apart, -1]


_NOTHING_YET = Found(Verdict.NOT_SETTLED)


def _without_point(answer: Answer) -> Found:
    if answer.status is Status.NONE:
        return Found(Verdict.NONE)
    return Found(Verdict.NOT_SETTLED, message="the search ended without an answer within its time")


def earliest_meeting(searcher: Searcher, progress: Progress | None = None) -> Found:
    """A run that meets the target as early as possible, or that there is none within the steps.

    Times are tried one after the other; the first that could not be settled is told in the message.
    """
    target, answer = searcher.question.target, Found(Verdict.NONE)
    for time in searcher.question.times:
        found = searcher.run(time + target.needs_step, (time,), meets=True)
        if found.verdict is Verdict.RUN and not found.borderline:
            return found
        if found.verdict is not Verdict.NONE or found.borderline:
            answer = _worse(answer, replace(found, message=f"step {time}: {found.message}"))
        if progress is not None and progress(time, searcher.calls):
            searcher.clock.stop()
        if searcher.clock.is_over:
            return _worse(answer, Found(Verdict.NOT_SETTLED, message=f"{searcher.clock.end} after step {time}"))
    return answer


_ORDER = (Verdict.NONE, Verdict.NOT_SETTLED, Verdict.RUN)


def _worse(first: Found, second: Found) -> Found:
    """The one that says less for the absence of runs; the first of equal ones."""
    rank, other = ((_ORDER.index(found.verdict), found.borderline) for found in (first, second))
    return first if rank >= other else second


def longest_avoidance(searcher: Searcher, progress: Progress | None = None) -> tuple[Found, int]:
    """A run of all steps that never meets the target, or that there is none; second, the least steps that show that.

    Lengths are tried from the shortest on, since many targets are met long before the end.
    """
    question, found = searcher.question, Found(Verdict.NONE)
    for length in dict.fromkeys((*_doubling(question.steps), question.steps)):
        times = tuple(time for time in question.times if time <= length - question.target.needs_step)
        found = searcher.run(length, times, meets=False)
        if progress is not None and progress(length, searcher.calls):
            searcher.clock.stop()
        if found.verdict is Verdict.NONE or searcher.clock.is_over:
            return found, length
    return found, question.steps


def _doubling(steps: int) -> list[int]:
    lengths = [1]
    while 2 * lengths[-1] < steps:
        lengths.append(2 * lengths[-1])
    return [length for length in lengths if length <= steps]
