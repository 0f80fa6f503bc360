"""Definitions that depend on each other, inside one cell of the search for modes.

As in :mod:`hysdel_py.systems.loops`, every combination of the Booleans of a circle leaves a linear system in its reals;
a combination belongs to the part of the cell in which it follows from itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import SimulationError
from hysdel_py.lowering.mode_maps import Knowledge
from hysdel_py.lowering.mode_plan import Loop
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Definition, Event, LogicEquation, Switch
from hysdel_py.systems.loops import MAX_LOOP_BOOLEANS

__all__ = ["solutions"]

Vector = NDArray[np.float64]


def solutions(loop: Loop, knowledge: Knowledge) -> Iterator[tuple[Knowledge, tuple[Event, ...]]]:
    """Combinations whose logic follows from itself, and the thresholds that have to agree with them.

    Raises
    ------
    SimulationError
        The circle has too many Booleans, or its linear system is singular.
    """
    booleans = [m for m in loop.members if isinstance(m, Event | LogicEquation)]
    reals = [m for m in loop.members if not isinstance(m, Event | LogicEquation)]
    if len(booleans) > MAX_LOOP_BOOLEANS:
        raise SimulationError((f"the algebraic loop through {_names(loop)} has too many Booleans to be settled",))
    for word in product((True, False), repeat=len(booleans)):
        trial = knowledge
        for member, value in zip(booleans, word, strict=True):
            trial = trial.with_truth(member.name, value)
        if all(_follows(member, trial) for member in booleans):
            yield _with_reals(loop, reals, trial), tuple(m for m in booleans if isinstance(m, Event))


def _follows(member: Definition, trial: Knowledge) -> bool:
    return not isinstance(member, LogicEquation) or member.value.value(trial.truths) == bool(trial.truths[member.name])


def _with_reals(loop: Loop, reals: Sequence[Definition], knowledge: Knowledge) -> Knowledge:
    """Solve ``z = M z + maps`` for the reals of the circle."""
    if not reals:
        return knowledge
    column = {member.name: index for index, member in enumerate(reals)}
    matrix, right = np.eye(len(reals)), np.zeros((len(reals), knowledge.size))
    for row, member in enumerate(reals):
        form = _active_form(member, knowledge)
        outside = tuple(term for term in form.terms if term[0] not in column)
        right[row] = knowledge.map_of(Affine(form.constant, outside))
        for name, coefficient in form.terms:
            if name in column:
                matrix[row, column[name]] -= coefficient
    if np.linalg.cond(matrix) > 1.0 / np.finfo(float).eps:
        raise SimulationError((f"the algebraic loop through {_names(loop)} has no unique solution: it is singular",))
    for member, value in zip(reals, np.linalg.solve(matrix, right), strict=True):
        knowledge = knowledge.with_map(member.name, value)
    return knowledge


def _active_form(member: Definition, knowledge: Knowledge) -> Affine:
    match member:
        case Switch():
            return member.branch(knowledge.truths)
        case AffineEquation(value=value):
            return value
        case _:
            return Affine()


def _names(loop: Loop) -> str:
    return ", ".join(member.name for member in loop.members)
