"""Mixed-integer linear feasibility and optimisation problems whose rows know where they come from; solved by HiGHS."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.origin import Origin

__all__ = ["Answer", "Milp", "Row", "Source", "Status"]

Vector = NDArray[np.float64]
Terms = Mapping[int, float]


class Status(Enum):
    """What the search found."""

    FOUND = "found"
    NONE = "none"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Source:
    """What a row stands for: an item of the source at a time step.

    `what` is the word for a row without an item, such as ``x(0)`` for a given initial state.
    """

    origin: Origin | None
    step: int = 0
    what: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """``low <= sum of coefficient * variable <= high``."""

    terms: tuple[tuple[int, float], ...]
    low: float
    high: float
    source: Source | None


@dataclass(frozen=True, eq=False, slots=True)
class Answer:
    """Answer of one search.

    Attributes
    ----------
    status : Status
        ``FOUND``: `w` is a solution (optimal if there is an objective and `gap` is 0). ``NONE``: the solver proved that
        there is no point, to its tolerance. ``UNKNOWN``: it stopped before either.
    w : array of shape (n,)
        Empty without a point.
    value : float
        Objective at w.
    """

    status: Status
    w: Vector
    value: float = inf


@dataclass(slots=True)
class Milp:
    """A problem under construction: variables by number, rows with their sources."""

    low: list[float] = field(default_factory=list)
    high: list[float] = field(default_factory=list)
    integer: list[bool] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)

    @property
    def n(self) -> int:
        """Number of variables."""
        return len(self.low)

    def real(self, low: float = -inf, high: float = inf) -> int:
        """A new real variable."""
        return self._new(low, high, integer=False)

    def boolean(self) -> int:
        """A new variable that is 0 or 1."""
        return self._new(0.0, 1.0, integer=True)

    def _new(self, low: float, high: float, *, integer: bool) -> int:
        self.low.append(low)
        self.high.append(high)
        self.integer.append(integer)
        return self.n - 1

    def row(self, terms: Terms, low: float = -inf, high: float = inf, source: Source | None = None) -> None:
        """Demand ``low <= terms <= high``."""
        self.rows.append(Row(tuple((i, c) for i, c in terms.items() if c), low, high, source))

    def fix(self, variable: int, value: float, source: Source | None = None) -> None:
        """Demand that a variable has a value."""
        self.row({variable: 1.0}, value, value, source)

    def copy(self) -> Milp:
        """An independent copy, to which more can be added."""
        return Milp(self.low[:], self.high[:], self.integer[:], self.rows[:])

    def matrix(self) -> tuple[Any, Vector, Vector]:
        """Sparse matrix of the rows, scaled so that their greatest coefficient is 1, and both sides."""
        return _matrix(self.rows, self.n)

    def search(
        self,
        objective: Terms | None = None,
        *,
        rows: Iterable[Row] | None = None,
        relaxed: bool = False,
        seconds: float = inf,
        nodes: int | None = None,
    ) -> Answer:
        """Find a point, the least one if there is an objective.

        Parameters
        ----------
        objective : mapping of variable to coefficient, optional
            Minimised.
        rows : iterable of Row, optional
            These rows instead of all.
        relaxed : bool
            Whether Booleans may be fractions.
        seconds : float
            Time limit.
        nodes : int, optional
            Limit of the nodes of the branch and bound, which unlike a time limit is the same on every machine.
        """
        from scipy.optimize import Bounds, LinearConstraint, milp

        chosen = self.rows if rows is None else list(rows)
        limits = {"time_limit": seconds} if seconds < inf else {}
        cost = np.zeros(self.n)
        for variable, coefficient in (objective or {}).items():
            cost[variable] = coefficient
        if any(row.low > row.high for row in chosen):
            return Answer(Status.NONE, np.zeros(0))
        answer = milp(
            cost,
            integrality=np.zeros(self.n) if relaxed else np.array(self.integer, dtype=float),
            bounds=Bounds(np.array(self.low), np.array(self.high)),
            constraints=LinearConstraint(*_matrix(chosen, self.n)) if chosen else None,
            options=limits | ({} if nodes is None else {"node_limit": nodes}),
        )
        return _answer(answer)


def _matrix(rows: list[Row], n: int) -> tuple[Any, Vector, Vector]:
    """Rows scaled so that their greatest coefficient is 1."""
    from scipy.sparse import csr_array

    index, column, value = [], [], []
    low, high = np.empty(len(rows)), np.empty(len(rows))
    for number, row in enumerate(rows):
        scale = 1.0 / max((abs(c) for _, c in row.terms), default=1.0)
        index += [number] * len(row.terms)
        column += [i for i, _ in row.terms]
        value += [c * scale for _, c in row.terms]
        low[number], high[number] = row.low * scale, row.high * scale
    return csr_array((value, (index, column)), shape=(len(rows), n)), low, high


def _answer(answer: Any) -> Answer:
    if answer.x is not None:
        return Answer(Status.FOUND, np.asarray(answer.x, dtype=float), float(answer.fun))
    infeasible = answer.status == 2
    return Answer(Status.NONE if infeasible else Status.UNKNOWN, np.zeros(0))
