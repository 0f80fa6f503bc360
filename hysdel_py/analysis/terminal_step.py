"""One more step from where plans end: whether it exists, and what it adds to the cost.

Sets decide whether it exists: the states with an input that keeps the limits and leads back are computed backward, and
have to cover the terminal set. What is left over is confirmed by a mixed-integer program over the discrete hybrid
automaton, which shares nothing with the sets.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from sys import maxsize

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.encoding import Places
from hysdel_py.analysis.hybrid_set import HybridSet, Piece, Span, whole_state
from hysdel_py.analysis.milp import Milp, Status
from hysdel_py.analysis.output_limits import with_output_limits
from hysdel_py.analysis.reach import reach_backward
from hysdel_py.analysis.runs import start_runs
from hysdel_py.analysis.settings import DEFAULT_SEARCH_TOLERANCES
from hysdel_py.analysis.start_cover import Timer
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, AffineRequirement, Dha
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.pwa import Pwa
from hysdel_py.systems.signals import Variable

__all__ = ["Kept", "Limited", "demand_piece", "kept_by_a_step", "limited_dha"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Limited:
    """Hard limits of every step of a plan.

    Attributes
    ----------
    states, inputs, outputs : mapping of name to (low, high)
    """

    states: Mapping[str, Span]
    inputs: Mapping[str, Span]
    outputs: Mapping[str, Span]


@dataclass(frozen=True, eq=False, slots=True)
class Kept:
    """Whether each state of a set has a step that leads back into it.

    Attributes
    ----------
    holds : bool
    state : array of shape (nx,) or None
        One that has none.
    is_confirmed : bool
        Whether the mixed-integer rows say so too.
    pieces : int
        Of the states that have such a step.
    """

    holds: bool
    state: Vector | None
    is_confirmed: bool
    pieces: int


def kept_by_a_step(pwa: Pwa, dha: Dha, states: HybridSet, limits: Limited, clock: Timer) -> Kept:
    """Whether from each state of a set some input keeps the limits and leads back, up to sets without inner points."""
    limited = with_output_limits(pwa, limits.outputs)
    before = reach_backward(limited, states, 1, inputs=limits.inputs, most=maxsize).sets[1]
    if before.covers(states):
        return Kept(True, None, True, len(before.pieces))
    left = max(states.minus(before).pieces, key=lambda piece: piece.region.relative_ball.radius)
    state = whole_state(left.word, left.region.relative_ball.centre, pwa.x)
    return Kept(False, state, _is_lost(dha, state, states, limits, clock), len(before.pieces))


def _is_lost(dha: Dha, state: Vector, states: HybridSet, limits: Limited, clock: Timer) -> bool:
    """Whether the rows of a step have no point that starts at a state and ends in a set."""
    start = {v.name: float(value) for v, value in zip(dha.x, state, strict=True)}
    runs = start_runs(limited_dha(dha, replace(limits, states={})), start, limits.inputs, (0.0, 0.0))
    runs.grow()
    for piece in states.pieces:
        problem = runs.problem.copy()
        demand_piece(problem, runs.states[1], piece, dha)
        if problem.search(seconds=clock.left).status is not Status.NONE:
            return False
    return True


def demand_piece(problem: Milp, places: Places, piece: Piece, dha: Dha) -> None:
    """Rows that keep a state in a piece, up to the tolerance of the solver."""
    booleans = [v.name for v in dha.x if v.is_bool]
    reals = [v.name for v in dha.x if not v.is_bool]
    for name, value in zip(booleans, piece.word, strict=True):
        problem.fix(places[name], float(value))
    for a, b in zip(piece.region.A, piece.region.b, strict=True):
        room = DEFAULT_SEARCH_TOLERANCES.rows * max(1.0, abs(float(b)))
        problem.row({places[name]: float(c) for name, c in zip(reals, a, strict=True)}, high=float(b) + room)


def limited_dha(dha: Dha, limits: Limited) -> Dha:
    """The model with limits as ranges of states and inputs and as requirements on outputs."""
    return replace(
        dha,
        x=tuple(_narrowed(v, limits.states) for v in dha.x),
        u=tuple(_narrowed(v, limits.inputs) for v in dha.u),
        items=(*dha.items, *_output_requirements(dha, limits.outputs)),
    )


def _narrowed(variable: Variable, limits: Mapping[str, Span]) -> Variable:
    low, high = np.broadcast_to(limits.get(variable.name, (-np.inf, np.inf)), 2)
    return replace(variable, low=max(variable.low, float(low)), high=min(variable.high, float(high)))


def _output_requirements(dha: Dha, limits: Mapping[str, Span]) -> list[AffineRequirement]:
    """Outputs that are affine within their limits; logical ones have none."""
    found = []
    for name, span in limits.items():
        equation = dha.definitions.get(name)
        low, high = np.broadcast_to(span, 2)
        if not isinstance(equation, AffineEquation):
            continue
        for sign, end in ((1.0, float(high)), (-1.0, -float(low))):
            if np.isfinite(end):
                terms = tuple((n, sign * c) for n, c in equation.value.terms)
                found.append(AffineRequirement(Affine(sign * equation.value.constant - end, terms), Origin()))
    return found
