"""Sets of which no part can be left out, and the smallest of them, from answers to "does this set contradict itself?".

Nothing here knows what the elements are. The property must be monotone: what contradicts itself does so with more
elements, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

__all__ = ["Contradicts", "irreducible", "smallest", "smallest_hitting_set"]

Set = frozenset[int]
Contradicts = Callable[[Set], bool]


def irreducible(contradicts: Contradicts, background: Set, candidates: Sequence[int]) -> tuple[int, ...]:
    """Candidates that contradict each other and the background, such that none can be left out.

    U. Junker, "QuickXplain: preferred explanations and relaxations for over-constrained problems", AAAI 2004. Earlier
    candidates are preferred. Background and candidates together must contradict themselves.
    """
    if not candidates or contradicts(background):
        return ()
    return _divide(contradicts, background, False, tuple(candidates))


def _divide(contradicts: Contradicts, background: Set, grown: bool, candidates: tuple[int, ...]) -> tuple[int, ...]:
    if grown and contradicts(background):
        return ()
    if len(candidates) == 1:
        return candidates
    first, second = candidates[: len(candidates) // 2], candidates[len(candidates) // 2 :]
    of_second = _divide(contradicts, background | set(first), True, second)
    of_first = _divide(contradicts, background | set(of_second), bool(of_second), first)
    return of_first + of_second


def smallest(
    contradicts: Contradicts,
    correction: Callable[[Set], Set],
    known: Set,
    give_up: Callable[[], bool] = lambda: False,
) -> tuple[Set, bool]:
    """Smallest set that contradicts itself.

    A. Ignatiev, A. Previti, M. Liffiton and J. Marques-Silva, "Smallest MUS extraction with minimal hitting set
    dualization", CP 2015; here the correction sets around a known irreducible set come first, which often proves at
    once that it is a smallest one.

    Parameters
    ----------
    contradicts : callable
    correction : callable
        Given a consistent set, all elements outside a maximal consistent set around it.
    known : frozenset
        An irreducible set.
    give_up : callable
        Asked before each step.

    Returns
    -------
    found : frozenset
        The smallest set, or the known one if the search gave up.
    proven : bool
    """
    corrections: list[Set] = []
    for element in sorted(known):
        if give_up():
            return known, False
        corrections.append(correction(known - {element}))
    while not give_up():
        hitting = smallest_hitting_set(corrections, preferred=known)
        if len(hitting) >= len(known):
            return known, True
        if contradicts(hitting):
            return hitting, True
        corrections.append(correction(hitting))
    return known, False


def smallest_hitting_set(sets: Iterable[Set], *, preferred: Set = frozenset()) -> Set:
    """A smallest set that has an element of each set; among equals one with many preferred elements."""
    import numpy as np
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import csr_array

    each = [sorted(one) for one in sets]
    elements = sorted({element for one in each for element in one})
    if not elements:
        return frozenset()
    column = {element: index for index, element in enumerate(elements)}
    index = [(number, column[e]) for number, one in enumerate(each) for e in one]
    rows, columns = zip(*index, strict=True)
    matrix = csr_array((np.ones(len(index)), (rows, columns)), shape=(len(each), len(elements)))
    # The preference is too small in sum to outweigh one element.
    cost = np.array([1.0 if e in preferred else 1.0 + 0.5 / (len(elements) + 1) for e in elements])
    answer = milp(
        cost,
        integrality=np.ones(len(elements)),
        bounds=Bounds(0.0, 1.0),
        constraints=LinearConstraint(matrix, 1.0, np.inf),
        options={"mip_rel_gap": 0.0},
    )
    return frozenset(e for e, value in zip(elements, answer.x, strict=True) if value > 0.5)
