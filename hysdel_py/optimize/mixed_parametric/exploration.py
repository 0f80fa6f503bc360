"""Depth first through the sequences, several at a time where there is an executor.

What is done with a sequence depends on it alone, so that the answer is the same whatever ran it and in which order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, field
from time import perf_counter

from hysdel_py.optimize.mixed_parametric.piece import Piece, solve_sequence
from hysdel_py.optimize.mixed_parametric.problem import MpMiqp
from hysdel_py.optimize.mixed_parametric.sequences import Children, Word, next_words
from hysdel_py.optimize.mixed_parametric.settings import MpMiqpSettings
from hysdel_py.optimize.mixed_parametric.substitution import Fate
from hysdel_py.optimize.parametric.exploration import Stop

__all__ = ["Progress", "Search", "advance"]

Outcome = Children | Piece | Fate
Progress = Callable[[int, int, int], object]


def advance(problem: MpMiqp, settings: MpMiqpSettings, words: list[Word]) -> list[Outcome]:
    """What follows from each of some sequences: longer ones, or the map of a complete one."""
    return [
        next_words(problem, word, settings)
        if len(word) < len(problem.binaries)
        else solve_sequence(problem, word, settings)
        for word in words
    ]


@dataclass(slots=True)
class Search:
    """One run.

    Attributes
    ----------
    problem : MpMiqp
    settings : MpMiqpSettings
    executor : Executor, optional
        Anything with ``submit``.
    progress : callable, optional
        Called with the numbers of maps found, of regions in them, and of sequences waiting.
    pieces : dict of Word to Piece
    tried, propagated, infeasible, flat, complete : int
        Sequences looked at, partial ones included; those cut off by propagation, by their rows, because their
        parameters fill no volume; and complete ones that were solved.
    """

    problem: MpMiqp
    settings: MpMiqpSettings
    executor: Executor | None = None
    progress: Progress | None = None
    pieces: dict[Word, Piece] = field(default_factory=dict)
    tried: int = 0
    propagated: int = 0
    infeasible: int = 0
    flat: int = 0
    complete: int = 0
    regions: int = 0
    _waiting: list[Word] = field(default_factory=lambda: [()])
    _started: float = field(default_factory=perf_counter)

    def run(self) -> Stop:
        """Look at sequences until none is left or a limit is reached."""
        try:
            return self._run()
        except KeyboardInterrupt:
            return Stop.INTERRUPTED

    def _run(self) -> Stop:
        while self._waiting:
            batch = self._batch()
            for words, outcomes in self._outcomes(batch):
                for word, outcome in zip(words, outcomes, strict=True):
                    self._record(word, outcome)
            if self.progress is not None:
                self.progress(len(self.pieces), self.regions, len(self._waiting))
            stop = self._limit()
            if stop is not None and self._waiting:
                return stop
        return Stop.DONE

    def _limit(self) -> Stop | None:
        if len(self.pieces) >= self.settings.sequences:
            return Stop.REGIONS
        if perf_counter() - self._started > self.settings.seconds:
            return Stop.SECONDS
        return None

    def _batch(self) -> list[Word]:
        """The sequences that came last, the longest ones."""
        size = self.settings.chunk * (_PER_EXECUTOR if self.executor is not None else 1)
        batch = self._waiting[-size:][::-1]
        del self._waiting[-size:]
        return batch

    def _outcomes(self, batch: list[Word]) -> Iterator[tuple[list[Word], list[Outcome]]]:
        if self.executor is None:
            for word in batch:
                yield [word], advance(self.problem, self.settings, [word])
            return
        size = max(1, len(batch) // _PER_EXECUTOR)
        chunks = [batch[start : start + size] for start in range(0, len(batch), size)]
        futures = [self.executor.submit(advance, self.problem, self.settings, chunk) for chunk in chunks]
        for chunk, future in zip(chunks, futures, strict=True):
            yield chunk, future.result()

    def _record(self, word: Word, outcome: Outcome) -> None:
        self.tried += 1
        self.complete += len(word) == len(self.problem.binaries)
        match outcome:
            case Children():
                self._waiting += outcome.words[::-1]
                self.propagated += outcome.propagated
                self.infeasible += outcome.infeasible
                self.flat += outcome.flat
            case Piece():
                self.pieces[word] = outcome
                self.regions += len(outcome.regions)
                if outcome.solution.stop is Stop.INTERRUPTED:  # where the interrupt was met
                    raise KeyboardInterrupt
            case Fate.FLAT:
                self.flat += 1
            case Fate.EMPTY:
                self.infeasible += 1


_PER_EXECUTOR = 8
"""Tasks that an executor is given at a time."""
