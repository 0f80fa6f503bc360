"""Sets of states that a piecewise affine system never has to leave.

From the states that are allowed, those without an input that leads back into the set are taken away until nothing
changes (F. Blanchini and S. Miani, "Set-Theoretic Methods in Control", 2nd ed., Birkhäuser, 2015, chapter 5). Without
inputs the result is the greatest positively invariant set, with inputs the greatest controlled invariant one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from sys import maxsize
from typing import TYPE_CHECKING

from hysdel_py.analysis.counts import counted
from hysdel_py.analysis.hybrid_set import HybridSet, Span, hybrid_set
from hysdel_py.analysis.output_limits import with_output_limits
from hysdel_py.analysis.reach import HasPwa, Progress, pwa_of, reach_backward, tidied
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.pwa import Pwa

if TYPE_CHECKING:
    from concurrent.futures import Executor

__all__ = ["Invariant", "feasible_states", "invariant_set"]


@dataclass(frozen=True, eq=False, slots=True)
class Invariant:
    """What is left of the allowed states.

    Attributes
    ----------
    states : HybridSet
    is_invariant : bool
        Whether nothing changed in the last round. If not, the set holds the greatest invariant one and more: each of
        its states can stay within the allowed ones for `rounds` steps.
    rounds : int
    """

    states: HybridSet
    is_invariant: bool
    rounds: int


def invariant_set(
    system: Pwa | HasPwa,
    within: Mapping[str, Span] | Polyhedron | HybridSet | None = None,
    *,
    inputs: Mapping[str, Span] | None = None,
    rounds: int = 100,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Invariant:
    """The greatest set of allowed states that need not be left, up to sets without inner points.

    Parameters
    ----------
    system : Pwa or Model
    within : mapping of name to value or (low, high), Polyhedron or HybridSet, optional
        Allowed states; their declared ranges by default.
    inputs : mapping of name to value or (low, high), optional
        Inputs that may be chosen; those that are not named have their whole range.
    rounds : int
        At most so many; many sets are reached only in the limit.
    executor : concurrent.futures.Executor, optional
        Takes the pieces of a round; the result does not depend on it.
    progress : callable, optional
        ``progress(round, pieces)``.

    Returns
    -------
    Invariant
        An empty set is invariant, too: then every state is forced out.

    Raises
    ------
    ArgumentError
        As :func:`hysdel_py.reach`.

    Examples
    --------
    >>> from hysdel_py import load
    >>> model = load("SYSTEM s { INTERFACE { STATE { REAL v [-10, 10]; } INPUT { REAL u [-1, 1]; } }"
    ...              " IMPLEMENTATION { CONTINUOUS { v = 1.5*v + u; } } }")
    >>> found = invariant_set(model, rounds=60)
    >>> print({name: tuple(round(end, 3) for end in ends) for name, ends in found.states.ranges().items()})
    {'v': (-2.0, 2.0)}
    """
    pwa = pwa_of(system)
    rounds = counted(rounds, 1, "rounds")
    allowed = hybrid_set({}, pwa.x, "within")
    states = allowed if within is None else hybrid_set(within, pwa.x, "within") & allowed
    for k in range(1, rounds + 1):
        before = reach_backward(pwa, states, 1, inputs=inputs, most=maxsize, executor=executor).sets[1]
        kept = tidied(states & before)
        if kept.covers(states):
            return Invariant(states, is_invariant=True, rounds=k)
        states = kept
        if progress is not None:
            progress(k, len(states.pieces))
    return Invariant(states, is_invariant=False, rounds=rounds)


def feasible_states(
    system: Pwa | HasPwa,
    steps: int,
    *,
    within: Mapping[str, Span] | Polyhedron | HybridSet | None = None,
    terminal: Mapping[str, Span] | Polyhedron | HybridSet | None = None,
    inputs: Mapping[str, Span] | None = None,
    outputs: Mapping[str, Span] | None = None,
    progress: Progress | None = None,
) -> HybridSet:
    """States from which some inputs keep allowed states over some steps and end in a terminal set.

    This is the feasible set of a predictive controller with that horizon, those hard limits on states, inputs and
    outputs, and that terminal set. `within` does not hold for the first state, as it is measured.

    Parameters
    ----------
    system : Pwa or Model
    steps : int
    within, terminal : mapping of name to value or (low, high), Polyhedron or HybridSet, optional
        Declared ranges by default.
    inputs, progress
        As for :func:`invariant_set`.
    outputs : mapping of name to value or (low, high), optional
        Where outputs have to lie in each of the steps, the first one too; those that are not named are free.
    """
    pwa = with_output_limits(pwa_of(system), outputs or {})
    allowed = hybrid_set({} if within is None else within, pwa.x, "within")
    states = allowed if terminal is None else tidied(allowed & hybrid_set(terminal, pwa.x, "terminal"))
    steps = counted(steps, 0, "steps")
    for k in range(1, steps + 1):
        states = reach_backward(pwa, states, 1, inputs=inputs, most=maxsize).sets[1]
        if k < steps:
            states = tidied(states & allowed)
        if progress is not None:
            progress(k, len(states.pieces))
    return states
