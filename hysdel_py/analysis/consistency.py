"""Which parts of a horizon contradict each other: answers of HiGHS, remembered.

The elements are the members of the horizon, 0 to m-1, and behind them the ends of its ranges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.farkas import least_violation_duals
from hysdel_py.analysis.horizon import Horizon
from hysdel_py.analysis.milp import Answer, Milp, Status
from hysdel_py.analysis.settings import DEFAULT_SEARCH_TOLERANCES, SearchTolerances

__all__ = ["Consistency"]

Vector = NDArray[np.float64]
Set = frozenset[int]

_NODES = 50
"""Nodes of the search for a point around a consistent set; a poor one only costs more searches afterwards."""


@dataclass(frozen=True, slots=True)
class _Known:
    """What is known already."""

    consistent: list[Set]
    contradictory: list[Set]


class Consistency:
    """Answers whether elements of a horizon contradict each other.

    Attributes
    ----------
    doubtful : bool
        Whether a search ended without an answer; the set was then taken to be consistent.
    """

    def __init__(
        self, horizon: Horizon, clock: Clock, tolerances: SearchTolerances = DEFAULT_SEARCH_TOLERANCES
    ) -> None:
        self.horizon = horizon
        self.clock = clock
        self.tolerances = tolerances
        self.doubtful = False
        self._known = _Known([], [])
        self._owner = _owners(horizon)
        self._check = _Residuals(horizon, tolerances.rows)

    @property
    def calls(self) -> int:
        """Searches so far, with those of whoever had the clock before."""
        return self.clock.searches

    @property
    def members(self) -> Set:
        """All members."""
        return frozenset(range(len(self.horizon.members)))

    @property
    def ends(self) -> Set:
        """All ends of ranges."""
        first = len(self.horizon.members)
        return frozenset(range(first, first + len(self.horizon.ends)))

    def contradicts(self, elements: Set) -> bool:
        """Whether the elements contradict each other."""
        if any(elements <= known for known in self._known.consistent):
            return False
        if any(known <= elements for known in self._known.contradictory):
            return True
        answer = self.search(elements)
        if answer.status is Status.NONE:
            self._known.contradictory.append(elements)
        elif answer.status is Status.FOUND:
            self._known.consistent.append(elements | self._check.satisfied(answer.w))
        else:
            self.doubtful = True
        return answer.status is Status.NONE

    def search(self, elements: Set) -> Answer:
        """A point at which the elements hold."""
        return self.problem(elements).search(seconds=self.clock.allowance())

    def problem(self, elements: Set) -> Milp:
        """The rows and ends of some elements."""
        horizon = self.horizon
        low, high = horizon.problem.low[:], horizon.problem.high[:]
        first = len(horizon.members)
        for number, end in enumerate(horizon.ends):
            if first + number not in elements:
                (high if end.is_high else low)[end.place] = inf if end.is_high else -inf
        rows = [
            row for row, owner in zip(horizon.problem.rows, self._owner, strict=True) if owner < 0 or owner in elements
        ]
        return Milp(low, high, horizon.problem.integer[:], horizon.problem.size[:], rows)

    def around(self, consistent: Set, universe: Set, suspects: Set) -> Set:
        """Elements of a universe outside a maximal consistent set around a consistent one, if time allows.

        Where the suspects are what contradicts the rest, one search is enough.
        """
        if self.contradicts(consistent | (universe - suspects)):
            self._reach_out(consistent, universe - suspects)
        inside = self._enlarged(consistent)
        outside: set[int] = set()
        waiting = [tuple(sorted(suspects - inside)), tuple(sorted(universe - suspects - inside))]
        while waiting:
            chunk = tuple(e for e in waiting.pop() if e not in inside)
            if not chunk:
                continue
            if self.clock.is_over:  # what is outside a smaller consistent set will do as well
                return universe - inside
            if not self.contradicts(inside | set(chunk)):
                inside = self._enlarged(inside | set(chunk))
            elif len(chunk) == 1:
                outside.update(chunk)
            else:
                half = len(chunk) // 2
                waiting += [chunk[half:], chunk[:half]]
        return frozenset(outside)

    def _reach_out(self, consistent: Set, wanted: Set) -> None:
        """Look for a point at which a set holds and a wanted one is violated by little in sum, and so in few places."""
        problem = self.problem(consistent)
        costs: dict[int, float] = {}
        for member in sorted(wanted - consistent):
            for number in self.horizon.rows[member]:
                row = self.horizon.problem.rows[number]
                size = max((abs(c) for _, c in row.terms), default=1.0)
                below, above = problem.real(0.0), problem.real(0.0)
                problem.row({**dict(row.terms), below: size, above: -size}, row.low, row.high)
                costs |= {below: 1.0, above: 1.0}
        answer = problem.search(costs, seconds=self.clock.allowance(), nodes=_NODES)
        if answer.status is Status.FOUND:
            self._known.consistent.append(consistent | self._check.satisfied(answer.w[: self.horizon.problem.n]))

    def _enlarged(self, consistent: Set) -> Set:
        """The largest known consistent set around one."""
        self.contradicts(consistent)
        return max((k for k in self._known.consistent if consistent <= k), key=len, default=consistent)

    def named_by_relaxation(self, candidates: Sequence[int]) -> tuple[int, ...]:
        """Candidates whose rows and bounds contradict each other even if Booleans may be fractions; else empty.

        The dual values of the least sum of violations prove it: the rows with a dual value that is not zero have no
        common point (the certificate of J. Farkas).
        """
        problem = self.problem(frozenset(candidates) | self.ends)
        duals = least_violation_duals(problem, self.tolerances)
        if duals is None:
            return ()
        owners = [owner for owner in self._owner if owner < 0 or owner in set(candidates)]
        named = {owner for owner, dual in zip(owners, duals, strict=True) if owner >= 0 and dual}
        return tuple(c for c in candidates if c in named)


def _owners(horizon: Horizon) -> list[int]:
    """The member of each row, -1 for one that always holds."""
    owner = [-1] * len(horizon.problem.rows)
    for member, rows in enumerate(horizon.rows):
        for row in rows:
            owner[row] = member
    return owner


class _Residuals:
    """Finds out which elements hold at a point."""

    def __init__(self, horizon: Horizon, tolerance: float) -> None:
        self._horizon = horizon
        self._tolerance = tolerance
        self._A, self._low, self._high = horizon.problem.matrix()
        self._places = np.array([end.place for end in horizon.ends], dtype=int)
        self._signs = np.array([1.0 if end.is_high else -1.0 for end in horizon.ends])
        self._values = np.array([end.value for end in horizon.ends])

    def satisfied(self, w: Vector) -> Set:
        value = self._A @ w
        holds = (value >= self._low - self._tolerance) & (value <= self._high + self._tolerance)
        first = len(self._horizon.members)
        members = (m for m, rows in enumerate(self._horizon.rows) if holds[list(rows)].all())
        inside = self._signs * (w[self._places] - self._values) <= self._tolerance
        return frozenset(members) | frozenset((first + np.flatnonzero(inside)).tolist())
