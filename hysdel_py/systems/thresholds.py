"""Thresholds of single states, and the gap that epsilon leaves at each of them.

In a mixed-integer form an event is true where its form is at most zero and false where it is at least epsilon. A state
in between belongs to neither side there, while the model itself sees the false one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.dha import Dha, Event

__all__ = ["Threshold", "out_of_gaps", "state_thresholds"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Threshold:
    """A real state that is compared with a number.

    Attributes
    ----------
    column : int
        Of the state.
    true_end, false_end : float
        The last value on either side; in between is the gap.
    """

    column: int
    true_end: float
    false_end: float

    def holds_gap(self, value: float) -> bool:
        """Whether a value is on neither side."""
        return min(self.true_end, self.false_end) < value < max(self.true_end, self.false_end)


def state_thresholds(dha: Dha) -> tuple[Threshold, ...]:
    """Thresholds of the events that read one real state and nothing else."""
    reals = {v.name: i for i, v in enumerate(dha.x) if not v.is_bool}
    found = []
    for item in dha.items:
        if isinstance(item, Event) and len(item.form.terms) == 1 and item.form.terms[0][0] in reals:
            ((name, c),) = item.form.terms
            constant = item.form.constant
            found.append(Threshold(reals[name], -constant / c, (item.epsilon - constant) / c))
    return tuple(found)


def out_of_gaps(x: Vector, thresholds: tuple[Threshold, ...], most: float) -> Vector:
    """A state with values in a gap moved to its false side, where the model sees them, by no more than a distance."""
    moved = x
    for threshold in thresholds:
        value = float(moved[threshold.column])
        if threshold.holds_gap(value) and abs(threshold.false_end - float(x[threshold.column])) <= most:
            moved = moved.copy()
            moved[threshold.column] = threshold.false_end
    return moved
