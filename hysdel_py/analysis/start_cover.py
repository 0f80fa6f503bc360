"""Whether each state of a box has a plan, and what the best plans cost at most.

With the Booleans of the plans held, the pairs of a state and a plan from it are a polyhedron, and the cost is convex
on it. So where the corners of a box have plans with the same word of Booleans, all its states have, and none costs more
than the dearest corner. A box is halved where its corners share neither the word of its centre nor one of theirs that
was tried.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from math import inf
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.clock import Clock
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.thresholds import state_thresholds

__all__ = ["Cover", "Programs", "at_thresholds", "cover_of"]

MOST_WORDS = 4
"""Words that are tried on a box: that of its centre, then those of corners that do not share it."""

Vector = NDArray[np.float64]
Box = tuple[Vector, Vector]
Progress = Callable[[int, int], object]


class Programs(Protocol):
    """The programs of a controller, one for each state."""

    def word(self, x: Vector, /) -> Vector | None:
        """Booleans of a plan; None where it is proven that there is none.

        Raises
        ------
        TimeoutError
            Neither was found.
        """

    def cost(self, x: Vector, word: Vector, /) -> float:
        """What the best plan with these Booleans costs, infinite where none is found."""


@dataclass(frozen=True, eq=False, slots=True)
class Cover:
    """What was found.

    Attributes
    ----------
    is_complete : bool
        Whether each state of the box has a plan.
    cost : float
        What the best plan costs at most, over all states; infinite unless complete.
    parts : int
        Boxes with a common word.
    without : array of shape (n,) or None
        A state without a plan.
    open : array of shape (n,) or None
        Centre of a box that was not settled.
    """

    is_complete: bool
    cost: float
    parts: int
    without: Vector | None = None
    open: Vector | None = None


def cover_of(
    programs: Programs, box: Box, clock: Clock, *, most: int, cuts: Sequence[Box] = (), progress: Progress | None = None
) -> Cover:
    """Cover a box of first states by parts with a common word.

    Parameters
    ----------
    programs : Programs
    box : (low, high)
        Ends may be equal.
    clock : Clock
    most : int
        Boxes that are looked at, at most.
    cuts : sequence of (low, high)
        The parts to begin with in place of the box.
    progress : callable, optional
        ``progress(settled, pending)`` after each box.
    """
    widest = np.where(box[1] > box[0], box[1] - box[0], 1.0)
    pending, parts, cost, seen = list(cuts) or [box], 0, 0.0, 0
    while pending:
        low, high = pending.pop()
        centre = (low + high) / 2
        seen += 1
        if seen > most or not clock.left:
            return Cover(False, inf, parts, open=centre)
        try:
            found = _of_box(programs, low, high)
        except TimeoutError:
            return Cover(False, inf, parts, open=centre)
        if isinstance(found, float):
            parts, cost = parts + 1, max(cost, found)
        elif found is not None:
            return Cover(False, inf, parts, without=found)
        elif np.array_equal(low, high):
            return Cover(False, inf, parts, open=centre)
        else:
            pending += _halves(low, high, widest)
        if progress is not None:
            progress(parts, len(pending))
    return Cover(True, cost, parts)


def _of_box(programs: Programs, low: Vector, high: Vector) -> float | Vector | None:
    """The greatest cost of its corners; a state without a plan; None where no word was found that all corners share."""
    centre, corners = (low + high) / 2, _corners(low, high)
    tried: list[Vector] = []
    asked = centre
    for _ in range(MOST_WORDS):
        word = programs.word(asked)
        if word is None:
            return asked
        if any(np.array_equal(word, other) for other in tried):
            return None
        tried.append(word)
        costs = [programs.cost(corner, word) for corner in corners]
        if max(costs) < inf:
            return max(0.0, *costs)
        asked = corners[costs.index(inf)]
    return None


def _corners(low: Vector, high: Vector) -> list[Vector]:
    ends = [(a,) if a == b else (a, b) for a, b in zip(low, high, strict=True)]
    return [np.array(corner) for corner in product(*ends)]


def _halves(low: Vector, high: Vector, widest: Vector) -> list[Box]:
    """Both halves along the coordinate that is widest relative to the whole box."""
    k = int(np.argmax((high - low) / widest))
    middle = (low[k] + high[k]) / 2
    lower, upper = high.copy(), low.copy()
    lower[k], upper[k] = middle, middle
    return [(low, lower), (upper, high)]


def at_thresholds(box: Box, dha: Dha) -> list[Box]:
    """A box cut where a single state is compared with a number, without the gap that epsilon leaves there."""
    parts = [box]
    for threshold in state_thresholds(dha):
        gap = sorted((threshold.true_end, threshold.false_end))
        parts = [part for whole in parts for part in _cut(whole, threshold.column, *gap)]
    return parts


def _cut(box: Box, i: int, low: float, high: float) -> list[Box]:
    below, above = box[1].copy(), box[0].copy()
    if not box[0][i] <= low <= high <= box[1][i]:
        return [box]
    below[i], above[i] = low, high
    return [(box[0], below), (above, box[1])]
