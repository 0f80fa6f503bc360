"""From a relaxed point to binary values that propagation does not reject.

Two guesses, both cheap beside a quadratic program: keep the *drivers* (the inputs of a controlled system) at their
relaxed values and let the rows decide the binaries, as a simulation would; and round the binaries group by group in
the order of their priorities, with propagation after each group.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.propagation import Box, Propagator

__all__ = ["guesses"]

Vector = NDArray[np.float64]
Indices = NDArray[np.intp]
Sides = tuple[Vector, Vector]


def guesses(
    propagator: Propagator, box: Box, sides: Sides, x: Vector, binaries: Indices, groups: list[Indices], drivers: Indices
) -> Iterator[Vector]:
    """Yield up to two vectors of binary values.

    Parameters
    ----------
    propagator : Propagator
    box : Box
        Of the node.
    sides : pair of arrays of shape (m,)
    x : array of shape (n,)
        Relaxed point.
    binaries : array of int
    groups : list of arrays of int
        The binaries by rising priority.
    drivers : array of int
    """
    if len(drivers):
        pushed = _fix(propagator, box, sides, drivers, np.clip(x[drivers], box.lb[drivers], box.ub[drivers]))
        yield from _round_groups(propagator, pushed, sides, x, binaries, groups)
    yield from _round_groups(propagator, box, sides, x, binaries, groups)


def _round_groups(
    propagator: Propagator, box: Box, sides: Sides, x: Vector, binaries: Indices, groups: list[Indices]
) -> Iterator[Vector]:
    for group in groups:
        if box.conflict is not None:
            return
        free = group[box.lb[group] < box.ub[group]]
        if free.size:
            box = _fix(propagator, box, sides, free, np.round(np.clip(x[free], 0.0, 1.0)))
    if box.conflict is None:
        yield box.lb[binaries]


def _fix(propagator: Propagator, box: Box, sides: Sides, variables: Indices, values: Vector) -> Box:
    if box.conflict is not None:
        return box
    lb, ub = box.lb.copy(), box.ub.copy()
    lb[variables] = ub[variables] = values
    return propagator.propagate(lb, ub, *sides, changed=variables)
