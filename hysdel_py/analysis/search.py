"""Searches for a point with a property, whose answer is proof, a point that was confirmed, or neither.

The solver counts a row as satisfied up to a tolerance, and a Boolean may be off by as much, which a large M multiplies.
So no point of it is believed: with its Booleans fixed a linear program takes the tolerance out, and whoever asks
confirms the point by stepping. A point that does not stand is excluded with its word of Booleans, and the search goes
on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.milp import Milp, Status

__all__ = ["Found", "Result", "settle"]

Vector = NDArray[np.float64]

MAX_WORDS = 200
"""So many words of Booleans may fail to stand before a search gives up."""


class Found(Enum):
    """How a search ended."""

    NONE = "none"
    POINT = "point"
    DOUBTFUL = "doubtful"
    UNSETTLED = "unsettled"


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """How a search ended; `w` is the confirmed point, or the last one that was not confirmed, else empty."""

    found: Found
    w: Vector


def settle(
    problem: Milp,
    objective: Mapping[int, float],
    threshold: float,
    accept: Callable[[Vector], bool],
    clock: Clock,
) -> Result:
    """Find a point whose objective is above a threshold, or prove that there is none.

    Parameters
    ----------
    problem : Milp
        Is left as it is.
    objective : mapping of variable to coefficient
        Empty where any point will do; its value is 0 then.
    threshold : float
    accept : callable
        Whether a point stands.
    clock : Clock
    """
    work, cost = problem.copy(), {i: -c for i, c in objective.items()}
    doubted = np.zeros(0)
    for _ in range(MAX_WORDS):
        answer = work.search(cost, seconds=clock.allowance())
        below = -answer.value <= threshold
        if answer.status is Status.NONE or -answer.bound <= threshold or (below and answer.is_optimal):
            return Result(Found.DOUBTFUL if len(doubted) else Found.NONE, doubted)
        if answer.status is Status.UNKNOWN or below:
            return Result(Found.UNSETTLED, doubted)
        fine = work.refine(answer.w, cost, seconds=clock.allowance())
        if fine.status is Status.UNKNOWN:
            doubted = answer.w
        elif fine.status is Status.FOUND and -fine.value > threshold:
            if accept(fine.w):
                return Result(Found.POINT, fine.w)
            doubted = fine.w
        work.forbid(answer.w)
    return Result(Found.DOUBTFUL, doubted)
