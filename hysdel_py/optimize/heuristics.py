"""From a relaxed point to binary values that propagation does not reject.

Two guesses, both cheap beside a quadratic program: keep the *drivers* (the inputs of a controlled system) at their
relaxed values and let the rows decide the binaries, as a simulation would; and round the binaries group by group in
the order of their priorities, with propagation after each group.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.compiled_propagation import CompiledPropagator
from hysdel_py.optimize.mixed_integer import Miqp
from hysdel_py.optimize.propagation import Box, Propagator

__all__ = ["Guesser"]

Vector = NDArray[np.float64]
Indices = NDArray[np.intp]
Sides = tuple[Vector, Vector]


@dataclass(frozen=True, eq=False, slots=True)
class Guesser:
    """What the guesses need to know of a problem.

    Attributes
    ----------
    propagator : Propagator or CompiledPropagator
    binaries : array of int
    groups : tuple of arrays of int
        The binaries by rising priority.
    drivers : array of int
        Real variables that settle most others.
    """

    propagator: Propagator | CompiledPropagator
    binaries: Indices
    groups: tuple[Indices, ...]
    drivers: Indices

    @classmethod
    def of(cls, miqp: Miqp, propagator: Propagator | CompiledPropagator) -> Guesser:
        """Prepare the guesses of a problem."""
        groups = tuple(miqp.binaries[miqp.priorities == value] for value in np.unique(miqp.priorities))
        return cls(propagator, miqp.binaries, groups, miqp.drivers)

    def guesses(self, box: Box, sides: Sides, x: Vector) -> Iterator[Vector]:
        """Yield up to two vectors of binary values for a node with the given box and relaxed point x."""
        if len(self.drivers):
            kept = np.clip(x[self.drivers], box.lb[self.drivers], box.ub[self.drivers])
            yield from self._round_groups(self._fix(box, sides, self.drivers, kept), sides, x)
        yield from self._round_groups(box, sides, x)

    def _round_groups(self, box: Box, sides: Sides, x: Vector) -> Iterator[Vector]:
        for group in self.groups:
            if box.conflict is not None:
                return
            free = group[box.lb[group] < box.ub[group]]
            if free.size:
                box = self._fix(box, sides, free, np.where(x[free] > 0.5, 1.0, 0.0))
        if box.conflict is None:
            yield box.lb[self.binaries]

    def _fix(self, box: Box, sides: Sides, variables: Indices, values: Vector) -> Box:
        lb, ub = box.lb.copy(), box.ub.copy()
        lb[variables] = ub[variables] = values
        return self.propagator.propagate(lb, ub, *sides, changed=variables)
