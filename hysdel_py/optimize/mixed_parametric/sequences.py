"""Values of the binaries, stage after stage: which of them leave the program a point?

A partial sequence is given up when interval propagation finds a conflict in the whole program, or when the rows of the
stages up to it have no common point, parameters and variables taken together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.mixed_parametric.problem import MpMiqp
from hysdel_py.optimize.mixed_parametric.settings import MpMiqpSettings
from hysdel_py.optimize.mixed_parametric.substitution import Fate, Reduced, reduce_to_free
from hysdel_py.optimize.parametric.cover import point_inside
from hysdel_py.optimize.propagation import Propagator

__all__ = ["Children", "Word", "next_words"]

Vector = NDArray[np.float64]
Word = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Children:
    """What follows a partial sequence.

    Attributes
    ----------
    words : tuple of Word
        Sequences one stage longer that may have a point, in rising order.
    propagated, infeasible, flat : int
        Sequences given up by propagation, by their rows, and because their parameters fill no volume.
    """

    words: tuple[Word, ...]
    propagated: int
    infeasible: int
    flat: int


def next_words(problem: MpMiqp, word: Word, settings: MpMiqpSettings) -> Children:
    """Sequences that continue a partial one by one stage.

    Parameters
    ----------
    problem : MpMiqp
    word : Word
        All binaries of some first stages.
    settings : MpMiqpSettings
    """
    stage = int(problem.stages[len(word)])
    grown, propagated = _propagated(problem, word, problem.decided(stage + 1), settings)
    fates = [_fate(problem, candidate, stage, settings) for candidate in grown]
    alive = tuple(candidate for candidate, fate in zip(grown, fates, strict=True) if fate is Fate.ALIVE)
    return Children(alive, propagated, fates.count(Fate.EMPTY), fates.count(Fate.FLAT))


def _propagated(problem: MpMiqp, word: Word, length: int, settings: MpMiqpSettings) -> tuple[list[Word], int]:
    """Continuations up to a length that propagation leaves, and how many it cut off."""
    propagator = Propagator(problem.A, problem.binaries, settings.propagation)
    box = _box_of(problem, propagator, word)
    pending, cut = ([(word, box)], 0) if box is not None else ([], 1)
    done: list[Word] = []
    while pending:
        prefix, (lb, ub) = pending.pop()
        if len(prefix) == length:
            done.append(prefix)
            continue
        at = int(problem.binaries[len(prefix)])
        for bit in (1, 0):
            low, high = lb.copy(), ub.copy()
            low[at], high[at] = max(lb[at], bit), min(ub[at], bit)
            found = (
                propagator.propagate(low, high, problem.l, problem.u, np.array([at])) if low[at] <= high[at] else None
            )
            if found is None or found.conflict is not None:
                cut += 1
            else:
                pending.append(((*prefix, bit), (found.lb, found.ub)))
    return done, cut


def _box_of(problem: MpMiqp, propagator: Propagator, word: Word) -> tuple[Vector, Vector] | None:
    lb, ub = problem.lb.copy(), problem.ub.copy()
    lb[problem.binaries] = np.maximum(lb[problem.binaries], 0.0)
    ub[problem.binaries] = np.minimum(ub[problem.binaries], 1.0)
    at = problem.binaries[: len(word)]
    if np.any(lb[at] > word) or np.any(ub[at] < word):
        return None
    lb[at] = ub[at] = word
    found = propagator.propagate(lb, ub, problem.l, problem.u)
    return None if found.conflict is not None else (found.lb, found.ub)


def _fate(problem: MpMiqp, word: Word, stage: int, settings: MpMiqpSettings) -> Fate:
    fate, reduced = reduce_to_free(problem, word, stage, settings)
    return fate if reduced is None or has_point(reduced, settings) else Fate.EMPTY


def has_point(reduced: Reduced, settings: MpMiqpSettings) -> bool:
    """Whether the rows, moved outwards by the tolerance, may have a common point.

    Where the nearest-point method finds none, a linear program has the last word, for it may have lost its way.
    """
    rows = reduced.N, reduced.h
    if point_inside(rows, -settings.outwards, settings.mpqp) is not None:
        return True
    room = Polyhedron(*rows)
    return room.ball.radius > room.precision.empty
