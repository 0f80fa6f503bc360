"""The laws of single sequences of switches, and all of them stacked to find the best one at a point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw

__all__ = ["TIE", "Place", "SearchReport", "SequenceLaw", "Stack", "stacked"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

TIE = 1e-9
"""Values that differ by less, relative to 1 and their size, are equal."""


@dataclass(frozen=True, slots=True, eq=False)
class SequenceLaw:
    """The law of one sequence of switches.

    Attributes
    ----------
    word : tuple of int
        Values of the Boolean parameters, then of all switches, in the order of :attr:`HybridLaw.switches`.
    law : ExplicitLaw
        Over the real parameters. Its variables are the inputs of the whole plan, stage after stage; the first are the
        move.
    """

    word: tuple[int, ...]
    law: ExplicitLaw


@dataclass(frozen=True, slots=True)
class SearchReport:
    """What the enumeration of the sequences did.

    Attributes
    ----------
    tried : int
        Sequences looked at, partial ones included.
    propagated, infeasible, flat : int
        Sequences given up by interval propagation, because their rows have no common point, and because their
        parameters fill no volume.
    solved : int
        Complete sequences whose program was solved.
    found : int
        Regions before any were removed.
    stop : str
        Why the search ended.
    seconds : float
    """

    tried: int
    propagated: int
    infeasible: int
    flat: int
    solved: int
    found: int
    stop: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Place:
    """Where a point lies.

    Attributes
    ----------
    sequence : int
        Number of the sequence in :attr:`HybridLaw.sequences`.
    region : int
        Number of the region in the law of this sequence.
    value : float
        Optimal cost.
    """

    sequence: int
    region: int
    value: float


@dataclass(frozen=True, slots=True, eq=False)
class Stack:
    """Regions of several sequences, one after another, for one product with the point."""

    A: Matrix
    b: Vector
    starts: NDArray[np.int64]
    P: Matrix
    q: Matrix
    r: Vector
    sequence: NDArray[np.int64]
    region: NDArray[np.int64]
    tolerance: float

    def best(self, theta: Vector) -> Place | None:
        """The region with the least value; ties go to the first sequence."""
        excess = np.maximum.reduceat(self.A @ theta - self.b, self.starts)
        inside = np.flatnonzero(excess <= self.tolerance)
        if not len(inside):
            return None
        values = 0.5 * ((self.P[inside] @ theta) @ theta) + self.q[inside] @ theta + self.r[inside]
        least = float(values.min())
        tied = inside[values <= least + TIE * max(1.0, abs(least))]
        own = tied[self.sequence[tied] == self.sequence[tied].min()]
        chosen = own[np.argmin(excess[own])]
        value = float(values[np.flatnonzero(inside == chosen)[0]])
        return Place(int(self.sequence[chosen]), int(self.region[chosen]), value)


def stacked(sequences: Sequence[SequenceLaw], numbers: list[int]) -> Stack:
    """Stack the laws of the sequences with the given numbers; none may be empty."""
    laws = [sequences[number].law for number in numbers]
    sizes = [len(law.b) for law in laws]
    offsets = np.cumsum([0, *sizes[:-1]])
    return Stack(
        A=np.vstack([law.A for law in laws]),
        b=np.concatenate([law.b for law in laws]),
        starts=np.concatenate([law.starts[:-1] + offset for law, offset in zip(laws, offsets, strict=True)]),
        P=np.concatenate([law.P for law in laws]),
        q=np.concatenate([law.q for law in laws]),
        r=np.concatenate([law.r for law in laws]),
        sequence=np.concatenate([np.full(law.count, n) for law, n in zip(laws, numbers, strict=True)]),
        region=np.concatenate([np.arange(law.count) for law in laws]),
        tolerance=laws[0].tolerance,
    )
