"""Sets of states that a piecewise affine system can be in after each step, and from which it can get into a set.

Forward: the successors of a piece under the branches that its states belong to, under all inputs. Backward: the states
that have an input which leads into a piece. Exact sets are images and shadows of polyhedra; with a template of
directions each successor is enclosed by the greatest values along them, one linear program each (C. Le Guernic and
A. Girard, "Reachability analysis of linear systems using support functions", Nonlinear Analysis: Hybrid Systems 4,
2010).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from hysdel_py.analysis.counts import counted
from hysdel_py.analysis.hybrid_set import HybridSet, Piece, Span, box_of, hybrid_set
from hysdel_py.analysis.pwa_branches import Branch, branches_of
from hysdel_py.analysis.reach_images import Backward, Forward
from hysdel_py.analysis.replacement import box_around, empty_share
from hysdel_py.analysis.templates import template_of
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.union import PolyhedralUnion
from hysdel_py.systems.pwa import Pwa

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from hysdel_py.systems.signals import Variable

__all__ = ["HasPwa", "Progress", "Reach", "pwa_of", "reach", "reach_backward", "tidied"]

Sets = Literal["exact", "boxes", "octagons"] | ArrayLike
Progress = Callable[[int, int], Any]


@dataclass(frozen=True, eq=False, slots=True)
class Reach:
    """States at each step.

    Attributes
    ----------
    sets : tuple of HybridSet
        ``sets[k]`` holds the states after k steps, or those k steps before the target; ``sets[0]`` is what was given.
    is_exact : bool
        Whether the sets are the states themselves; else they hold them and more.
    settled_at : int or None
        From this step on nothing new is reached: the union of the sets up to here is that of all times.
    is_complete : bool
        False if the computation was interrupted; then `sets` ends early.
    losses : tuple of float
        For each step the greatest share of a box that holds none of the pieces which it stands for, because there
        were more than `most`; 0 where no piece was replaced at that step. Later steps start from what was kept.
    """

    sets: tuple[HybridSet, ...]
    is_exact: bool
    settled_at: int | None
    is_complete: bool
    losses: tuple[float, ...] = ()

    @property
    def union(self) -> HybridSet:
        """States of all steps."""
        return HybridSet(self.sets[0].x, tuple(piece for states in self.sets for piece in states.pieces))

    def first_meeting(self, target: Mapping[str, Span] | Polyhedron | HybridSet) -> int | None:
        """First step at which a set has a state in common with the target; None if none has.

        With sets that hold more than the states, a meeting proves nothing, and None proves that there is none.
        """
        wanted = hybrid_set(target, self.sets[0].x, "target")
        return next((k for k, states in enumerate(self.sets) if states.meets(wanted)), None)

    def modes_to(self, step: int, piece: int) -> tuple[int | None, ...]:
        """Modes of the steps behind a piece, in the order of time; None where pieces were joined."""
        modes: list[int | None] = []
        number: int | None = piece
        for k in range(step, 0, -1):
            here = self.sets[k].pieces[number] if number is not None else None
            modes.append(here.mode if here else None)
            number = here.parent if here else None
        return tuple(reversed(modes))


class HasPwa(Protocol):
    """A model that has a piecewise affine form."""

    @property
    def pwa(self) -> Pwa:
        """The form."""


def pwa_of(system: Pwa | HasPwa) -> Pwa:
    """The piecewise affine form of a model, or the one that is given.

    Raises
    ------
    ArgumentError
        For anything else, or if the search for the modes was stopped: sets would then be too small.
    """
    pwa = system if isinstance(system, Pwa) else getattr(system, "pwa", None)
    if not isinstance(pwa, Pwa):
        raise ArgumentError(f"a {type(system).__name__} was given: a Model or Pwa was expected")
    if not pwa.is_complete:
        raise ArgumentError("not all modes are known, since the search for them was stopped: raise max_modes")
    return pwa


def reach(
    system: Pwa | HasPwa,
    x0: Mapping[str, Span] | Polyhedron | HybridSet,
    steps: int,
    *,
    inputs: Mapping[str, Span] | None = None,
    sets: Sets = "exact",
    merge: bool = True,
    most: int = 200,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Reach:
    """States after each step, from any state of a set and under any inputs.

    Parameters
    ----------
    system : Pwa or Model
    x0 : mapping of name to value or (low, high), Polyhedron over the states, or HybridSet
        States that a mapping does not name may have any value of their range.
    steps : int
    inputs : mapping of name to value or (low, high), optional
        Inputs that are not named may have any value of their range.
    sets : {"exact", "boxes", "octagons"} or array_like of shape (d, n)
        Exact polyhedra, or enclosures along directions of the n real states.
    merge : bool
        Drop pieces that others cover, and join pieces whose union is convex.
    most : int
        When a step has more pieces for one value of the Boolean states, they are replaced by one box around them, and
        the result says that it is not exact and how much of the box is empty.
    executor : concurrent.futures.Executor, optional
        Takes the pieces of a step; the result does not depend on it.
    progress : callable, optional
        ``progress(k, pieces)`` after each step.

    Returns
    -------
    Reach
        An interrupt by the keyboard ends the computation early with the sets so far.

    Raises
    ------
    ArgumentError
        For unknown names, intervals upside down, or numbers of steps that make no sense.

    Notes
    -----
    A state that has no successor, because a requirement or a range fails for every input or because it lies in the gap
    of a threshold, has none in the sets.
    """
    return _run(Forward, pwa_of(system), x0, inputs, _Course(steps, sets, merge, most, executor, progress))


def reach_backward(
    system: Pwa | HasPwa,
    target: Mapping[str, Span] | Polyhedron | HybridSet,
    steps: int,
    *,
    inputs: Mapping[str, Span] | None = None,
    sets: Sets = "exact",
    merge: bool = True,
    most: int = 200,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Reach:
    """States from which some inputs lead into a set in exactly k steps.

    Parameters and errors are those of :func:`reach`. Enclosures hold more states than can get there.
    """
    return _run(Backward, pwa_of(system), target, inputs, _Course(steps, sets, merge, most, executor, progress))


@dataclass(frozen=True, eq=False, slots=True)
class _Course:
    """How a computation is to go on."""

    steps: int
    sets: Sets
    merge: bool
    most: int
    executor: Executor | None
    progress: Progress | None

    def __post_init__(self) -> None:
        object.__setattr__(self, "steps", counted(self.steps, 0, "steps"))
        object.__setattr__(self, "most", counted(self.most, 1, "most"))

    def each(self, function: Forward | Backward, pieces: Sequence[Piece]) -> list[Piece]:
        """Results of all pieces, in their order."""
        numbered = list(enumerate(pieces))
        some = map(function, numbered) if self.executor is None else self.executor.map(function, numbered)
        return [piece for found in some for piece in found]


def _run(
    kind: type[Forward | Backward],
    pwa: Pwa,
    given: Mapping[str, Span] | Polyhedron | HybridSet,
    inputs: Mapping[str, Span] | None,
    course: _Course,
) -> Reach:
    template = template_of(course.sets, sum(not v.is_bool for v in pwa.x))
    step = kind(_with_inputs(branches_of(pwa), inputs or {}, pwa.u), template)
    first = hybrid_set(given, pwa.x, "x0" if kind is Forward else "target")
    return _steps(step, first, course, exact=template is None)


def _with_inputs(branches: Sequence[Branch], given: Mapping[str, Span], u: Sequence[Variable]) -> tuple[Branch, ...]:
    """Branches that the inputs allow, with the ranges of the real ones as rows."""
    low, high = box_of(given, u, "inputs")
    booleans = [i for i, v in enumerate(u) if v.is_bool]
    reals = [i for i, v in enumerate(u) if not v.is_bool]
    allowed = [b for b in branches if all(low[i] <= b.inputs[k] <= high[i] for k, i in enumerate(booleans))]
    box = Polyhedron.box(low[reals], high[reals])
    return tuple(
        replace(b, region=b.region.with_rows(np.hstack([np.zeros((box.m, len(b.f))), box.A]), box.b)) for b in allowed
    )


def _steps(step: Forward | Backward, first: HybridSet, course: _Course, *, exact: bool) -> Reach:
    found, known, settled, complete, losses = [first], first, None, False, [0.0]
    try:
        for k in range(1, course.steps + 1):
            states, loss = _tidied(HybridSet(first.x, tuple(course.each(step, found[-1].pieces))), course)
            exact = exact and loss is None
            losses.append(loss or 0.0)
            if settled is None and known.covers(states):
                settled = k - 1
            found.append(states)
            known = known | states
            if course.progress is not None:
                course.progress(k, len(states.pieces))
        complete = True
    except KeyboardInterrupt:
        pass  # what was found so far is the answer
    return Reach(tuple(found), exact, settled, complete, tuple(losses[: len(found)]))


def _tidied(states: HybridSet, course: _Course) -> tuple[HybridSet, float | None]:
    """Fewer pieces for the same states; second, what a box in their place adds, None where there is none."""
    pieces: list[Piece] = []
    loss = None
    for word, numbers in states.by_word().items():
        group = [states.pieces[i] for i in numbers]
        if course.merge:
            group = _joined(word, group)
        if len(group) > course.most:
            box = box_around(group)
            loss = max(loss or 0.0, empty_share(box, group))
            group = [Piece(word, box)]
        pieces += group
    return HybridSet(states.x, tuple(pieces)), loss


def tidied(states: HybridSet) -> HybridSet:
    """The same states in fewer pieces."""
    return HybridSet(
        states.x,
        tuple(
            piece
            for word, numbers in states.by_word().items()
            for piece in _joined(word, [states.pieces[i] for i in numbers])
        ),
    )


def _joined(word: tuple[bool, ...], group: list[Piece]) -> list[Piece]:
    """Pieces without those that others cover; neighbours with a convex union joined."""
    union = PolyhedralUnion(tuple(piece.region for piece in group)).merged()
    ours = {id(piece.region): piece for piece in group}
    return [ours.get(id(part), Piece(word, part)) for part in union.parts if not part.is_empty]
