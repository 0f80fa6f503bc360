"""One more step from where plans end: whether it exists, and what it adds to the cost.

Sets decide whether it exists: the states with an input that keeps the limits and leads back are computed backward, and
have to cover the terminal set. What is left over is confirmed by a mixed-integer program over the discrete hybrid
automaton, which shares nothing with the sets.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from sys import maxsize

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.encoding import Places
from hysdel_py.analysis.hybrid_set import HybridSet, Piece, Span, box_of, hybrid_set, whole_state
from hysdel_py.analysis.milp import Milp, Status
from hysdel_py.analysis.output_limits import with_output_limits
from hysdel_py.analysis.pwa_branches import Branch, branches_of
from hysdel_py.analysis.reach import reach_backward
from hysdel_py.analysis.runs import start_runs
from hysdel_py.analysis.settings import DEFAULT_SEARCH_TOLERANCES
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, AffineRequirement, Dha
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.pwa import Pwa
from hysdel_py.systems.signals import Variable

__all__ = [
    "Kept", "LastLaw", "Limited", "cut_by_rows", "demand_piece", "kept_by_a_step", "limited_dha", "steps_between",
]  # fmt: skip

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


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
class LastLaw:
    """``u = K x + k``, the input of one more step; rows of Boolean inputs hold no gains.

    Attributes
    ----------
    K, k : arrays of shapes (nu, nx) and (nu,)
    """

    K: Matrix
    k: Vector

    def reals(self, pwa: Pwa) -> tuple[Matrix, Vector]:
        """``(v, s) = L v + l`` of real states v and real inputs s, with what Boolean states add left out."""
        states = [i for i, v in enumerate(pwa.x) if not v.is_bool]
        inputs = [i for i, v in enumerate(pwa.u) if not v.is_bool]
        L = np.vstack([np.eye(len(states)), self.K[np.ix_(inputs, states)]])
        return L, np.concatenate([np.zeros(len(states)), self.k[inputs]])

    def at(self, x: Vector) -> Vector:
        """The input at a state."""
        return np.asarray(self.K @ x + self.k)


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


def cut_by_rows(states: HybridSet, A: Matrix, b: Vector) -> HybridSet:
    """The states of a set with ``A x <= b``, in which Boolean states are 0 or 1."""
    cut = states & hybrid_set(Polyhedron(A, b), states.x, "terminal")
    return HybridSet(cut.x, tuple(replace(piece, region=piece.region.minimal()) for piece in cut.pieces))


def kept_by_a_step(
    pwa: Pwa, dha: Dha, states: HybridSet, limits: Limited, law: LastLaw | None = None, *, clock: Clock
) -> Kept:
    """Whether from each state of a set some input keeps the limits and leads back, up to sets without inner points.

    With a law it has to be its input.
    """
    limited = with_output_limits(pwa, limits.outputs)
    if law is None:
        before = reach_backward(limited, states, 1, inputs=limits.inputs, most=maxsize).sets[1]
    else:
        before = HybridSet(states.x, tuple(_before_by_law(limited, states, limits, law)))
    if before.covers(states):
        return Kept(True, None, True, len(before.pieces))
    left = max(states.minus(before).pieces, key=lambda piece: piece.region.relative_ball.radius)
    state = whole_state(left.word, left.region.relative_ball.centre, pwa.x)
    inputs = limits if law is None else _at_input(limits, dha, law.at(state))
    return Kept(False, state, _is_lost(dha, state, states, inputs, clock), len(before.pieces))


def _before_by_law(pwa: Pwa, states: HybridSet, limits: Limited, law: LastLaw) -> Iterator[Piece]:
    L, shift = law.reals(pwa)
    for branch, region, _ in steps_between(pwa, None, states, limits, law):
        own = region.preimage(L, shift)
        if not own.is_empty:
            yield Piece(branch.word, own, branch.mode)


def steps_between(
    pwa: Pwa, first: HybridSet | None, last: HybridSet, limits: Limited, law: LastLaw | None
) -> Iterator[tuple[Branch, Polyhedron, Piece]]:
    """Branches with the real states and inputs that lead from one set, anywhere without it, to another.

    Boolean inputs are those of a law, if there is one.
    """
    low, high = box_of(limits.inputs, pwa.u, "inputs")
    reals = [i for i, v in enumerate(pwa.u) if not v.is_bool]
    logical = [i for i, v in enumerate(pwa.u) if v.is_bool]
    box = Polyhedron.box(low[reals], high[reals])
    for branch in branches_of(pwa):
        wrong = law is not None and any(law.k[i] != branch.inputs[j] for j, i in enumerate(logical))
        if wrong or not all(low[i] <= branch.inputs[j] <= high[i] for j, i in enumerate(logical)):
            continue
        n = len(branch.f)
        allowed = branch.region.with_rows(np.hstack([np.zeros((box.m, n)), box.A]), box.b)
        for piece in (piece for piece in last.pieces if piece.word == branch.next_word):
            region = allowed & piece.region.preimage(np.hstack([branch.A, branch.B]), branch.f)
            yield from ((branch, _from(region, begin), piece) for begin in _begins(first, branch))


def _begins(first: HybridSet | None, branch: Branch) -> list[Polyhedron | None]:
    return [None] if first is None else [piece.region for piece in first.pieces if piece.word == branch.word]


def _from(region: Polyhedron, begin: Polyhedron | None) -> Polyhedron:
    if begin is None:
        return region
    return region.with_rows(np.hstack([begin.A, np.zeros((begin.m, region.n - begin.n))]), begin.b)


def _at_input(limits: Limited, dha: Dha, u: Vector) -> Limited:
    """Inputs that are given, moved onto their ranges where rounding left them beside."""
    given = {v.name: float(np.clip(value, v.low, v.high)) for v, value in zip(dha.u, u, strict=True)}
    return replace(limits, inputs=given)


def _is_lost(dha: Dha, state: Vector, states: HybridSet, limits: Limited, clock: Clock) -> bool:
    """Whether the rows of a step have no point that starts at a state and ends in a set."""
    start = {v.name: float(value) for v, value in zip(dha.x, state, strict=True)}
    runs = start_runs(limited_dha(dha, replace(limits, states={})), start, limits.inputs, (0.0, 0.0))
    runs.grow()
    for piece in states.pieces:
        problem = runs.problem.copy()
        demand_piece(problem, runs.states[1], piece, dha)
        if problem.search(seconds=clock.allowance()).status is not Status.NONE:
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
