"""The time that a chain of searches may take, who watches it, and who may end it."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import perf_counter

__all__ = ["Clock", "Watch"]

Watch = Callable[[int], object]
"""Told the number of searches begun; a true answer ends the work as if its time were over."""


class Clock:
    """Time that is left of a limit; none is left once whoever watches says so.

    Parameters
    ----------
    seconds : float
    watch : callable, optional
        See :data:`Watch`.
    """

    def __init__(self, seconds: float = inf, watch: Watch | None = None) -> None:
        self._begin = perf_counter()
        self._limit = seconds
        self._held_back = 0.0
        self._watch = watch
        self.searches = 0
        self.is_stopped = False

    def hold_back(self, part: float) -> None:
        """Keep a part of the whole time for later."""
        self._held_back = part

    def stop(self) -> None:
        """End the work: no time is left."""
        self.is_stopped = True

    def allowance(self) -> float:
        """Seconds for a search that begins now; whoever watches is told of it."""
        self.searches += 1
        if self._watch is not None and self._watch(self.searches):
            self.stop()
        return self.left

    @property
    def elapsed(self) -> float:
        """Seconds since the start."""
        return perf_counter() - self._begin

    @property
    def left(self) -> float:
        """Seconds that are left, 0 at the end."""
        return 0.0 if self.is_stopped else max(0.0, self._limit * (1.0 - self._held_back) - self.elapsed)

    @property
    def is_over(self) -> bool:
        """Whether no time is left."""
        return self.left <= 0.0

    @property
    def end(self) -> str:
        """Why no time is left, in words."""
        return "the search was interrupted" if self.is_stopped else "the time was over"
