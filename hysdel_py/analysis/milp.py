"""Mixed-integer linear feasibility and optimisation problems whose rows know where they come from; solved by HiGHS.

Columns of small variables are scaled by their ranges, and rows by their greatest coefficient, so that the absolute
tolerances of the solver do not swallow what is measured in small units.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from math import inf, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.quiet import quiet
from hysdel_py.systems.origin import Origin

__all__ = ["Answer", "Milp", "Row", "Source", "Status"]

Vector = NDArray[np.float64]
Terms = Mapping[int, float]

_LP_TOLERANCE = 1e-10  # the least that HiGHS accepts; with the Booleans fixed nothing is multiplied by a large M


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
        ``FOUND``: `w` is a solution. ``NONE``: the solver proved that
        there is no point, to its tolerance. ``UNKNOWN``: it stopped before either.
    w : array of shape (n,)
        Empty without a point.
    value : float
        Objective at w.
    bound : float
        No point has a lesser objective, says the solver; minus infinity where it says nothing.
    is_optimal : bool
        Whether the solver calls the point optimal.
    """

    status: Status
    w: Vector
    value: float = inf
    bound: float = -inf
    is_optimal: bool = False


@dataclass(slots=True)
class Milp:
    """A problem under construction: variables by number, rows with their sources."""

    low: list[float] = field(default_factory=list)
    high: list[float] = field(default_factory=list)
    integer: list[bool] = field(default_factory=list)
    size: list[float] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)

    @property
    def n(self) -> int:
        """Number of variables."""
        return len(self.low)

    def real(self, low: float = -inf, high: float = inf, *, size: float = 0.0) -> int:
        """A new real variable; `size` is the unit in which it is solved for, from its range where it is not given."""
        return self._new(low, high, size or _size(low, high), integer=False)

    def boolean(self) -> int:
        """A new variable that is 0 or 1."""
        return self._new(0.0, 1.0, 1.0, integer=True)

    def _new(self, low: float, high: float, size: float, *, integer: bool) -> int:
        self.low.append(low)
        self.high.append(high)
        self.integer.append(integer)
        self.size.append(size)
        return self.n - 1

    def row(self, terms: Terms, low: float = -inf, high: float = inf, source: Source | None = None) -> None:
        """Demand ``low <= terms <= high``."""
        self.rows.append(Row(tuple((i, c) for i, c in terms.items() if c), low, high, source))

    def fix(self, variable: int, value: float, source: Source | None = None) -> None:
        """Demand that a variable has a value."""
        self.row({variable: 1.0}, value, value, source)

    def forbid(self, w: Vector) -> None:
        """Exclude the word of the Booleans at a point, and with it all points that share it."""
        terms = {i: (-1.0 if w[i] > 0.5 else 1.0) for i in range(self.n) if self.integer[i]}
        self.row(terms, low=1.0 - sum(c < 0 for c in terms.values()))

    def copy(self) -> Milp:
        """An independent copy, to which more can be added."""
        return Milp(self.low[:], self.high[:], self.integer[:], self.size[:], self.rows[:])

    def matrix(self) -> tuple[Any, Vector, Vector]:
        """Sparse matrix of the rows, scaled so that their greatest coefficient is 1, and both sides."""
        return _matrix(self.rows, [1.0] * self.n)

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
        matrices = self._scaled(self.rows if rows is None else list(rows), objective or {})
        if matrices is None:
            return _nothing(Status.NONE)
        if not self.n:
            return Answer(Status.FOUND, np.zeros(0), 0.0, 0.0, is_optimal=True)
        whole = np.zeros(self.n) if relaxed else np.array(self.integer, dtype=float)
        limits = {"time_limit": max(seconds, 0.0)} if seconds < inf else {}
        limits |= {} if nodes is None else {"node_limit": nodes}
        answer = matrices.solve(whole, limits, presolve=True)
        if answer.status == _SOLVE_ERROR:  # HiGHS gives up on some problems after its own presolve
            answer = matrices.solve(whole, limits, presolve=False)
        return matrices.unscaled(answer, getattr(answer, "mip_dual_bound", None))

    def refine(self, w: Vector, objective: Terms | None = None, *, seconds: float = inf) -> Answer:
        """The least point with the Booleans of a given one, to the finest tolerance of the solver.

        Parameters
        ----------
        w : array of shape (n,)
            Its Booleans are rounded and then stay.
        objective, seconds
            As in :meth:`search`.
        """
        from scipy.optimize import linprog

        matrices = self._scaled(self.rows, objective or {})
        if matrices is None:
            return _nothing(Status.NONE)
        if not self.n:
            return Answer(Status.FOUND, np.zeros(0), 0.0, 0.0, is_optimal=True)
        whole = np.array(self.integer, dtype=bool)
        matrices.lb[whole] = matrices.ub[whole] = np.round(w[whole])
        options: dict[str, float] = dict.fromkeys(_LP_OPTIONS, _LP_TOLERANCE)
        if seconds < inf:
            options["time_limit"] = max(seconds, 0.0)
        bounds = np.column_stack([matrices.lb, matrices.ub])
        answer = linprog(matrices.cost, **matrices.one_sided(), bounds=bounds, method="highs", options=options)
        return matrices.unscaled(answer, answer.fun if answer.status == 0 else None)

    def _scaled(self, rows: list[Row], objective: Terms) -> _Scaled | None:
        """The problem in numbers of size 1, None if a row or bound contradicts itself."""
        low, high, size = (np.array(side, dtype=float) for side in (self.low, self.high, self.size))
        if any(map(_cannot_hold, rows)) or (low > high).any():
            return None
        cost = np.zeros(self.n)
        for variable, coefficient in objective.items():
            cost[variable] = coefficient * self.size[variable]
        greatest = float(np.abs(cost).max(initial=0.0)) or 1.0
        A, least, most = _matrix(rows, self.size)
        return _Scaled(cost / greatest, A, least, most, low / size, high / size, size, greatest)


_SOLVE_ERROR = 4
"""Code of scipy.optimize.milp for trouble that is no limit."""

_LP_OPTIONS = ("primal_feasibility_tolerance", "dual_feasibility_tolerance")


@dataclass(frozen=True, eq=False, slots=True)
class _Scaled:
    """``min cost'v  subject to  low <= A v <= high, lb <= v <= ub``  where  ``w = size * v``."""

    cost: Vector
    A: Any
    low: Vector
    high: Vector
    lb: Vector
    ub: Vector
    size: Vector
    greatest: float

    def solve(self, integrality: Vector, limits: Mapping[str, float], *, presolve: bool) -> Any:
        """The answer of the solver."""
        from scipy.optimize import Bounds, LinearConstraint, milp

        with quiet():
            return milp(
                self.cost,
                integrality=integrality,
                bounds=Bounds(self.lb, self.ub),
                constraints=LinearConstraint(self.A, self.low, self.high) if len(self.low) else None,
                options={"mip_rel_gap": 0.0, "presolve": presolve, **limits},
            )

    def one_sided(self) -> dict[str, Any]:
        """The rows as equalities and upper sides, as linprog takes them."""
        from scipy.sparse import vstack

        equal = self.low == self.high
        upper, lower = ~equal & np.isfinite(self.high), ~equal & np.isfinite(self.low)
        found: dict[str, Any] = {}
        if equal.any():
            found |= {"A_eq": self.A[equal], "b_eq": self.high[equal]}
        if upper.any() or lower.any():
            found["A_ub"] = vstack([self.A[upper], -self.A[lower]], format="csr")
            found["b_ub"] = np.concatenate([self.high[upper], -self.low[lower]])
        return found

    def unscaled(self, answer: Any, bound: float | None) -> Answer:
        """The answer of the solver in the units of the problem."""
        if answer.x is None:
            return _nothing(Status.NONE if answer.status == 2 else Status.UNKNOWN)
        proven = -inf if bound is None or not isfinite(bound) else float(bound) * self.greatest
        w = np.asarray(answer.x, dtype=float) * self.size
        return Answer(Status.FOUND, w, float(answer.fun) * self.greatest, proven, answer.status == 0)


def _size(low: float, high: float) -> float:
    """Unit in which a variable with this range is solved for; never a coarser one than its own."""
    greatest = max((abs(end) for end in (low, high) if isfinite(end)), default=1.0)
    return min(greatest, 1.0) or 1.0


def _cannot_hold(row: Row) -> bool:
    """Whether a row contradicts itself, whatever the variables are."""
    return row.low > row.high or (not row.terms and not row.low <= 0.0 <= row.high)


def _nothing(status: Status) -> Answer:
    return Answer(status, np.zeros(0), inf, inf if status is Status.NONE else -inf)


def _matrix(rows: list[Row], size: list[float]) -> tuple[Any, Vector, Vector]:
    """Rows over the scaled columns, each scaled so that its greatest coefficient is 1."""
    from scipy.sparse import csr_array

    index, column, value = [], [], []
    low, high = np.empty(len(rows)), np.empty(len(rows))
    for number, row in enumerate(rows):
        scale = 1.0 / max((abs(c * size[i]) for i, c in row.terms), default=1.0)
        index += [number] * len(row.terms)
        column += [i for i, _ in row.terms]
        value += [c * size[i] * scale for i, c in row.terms]
        low[number], high[number] = row.low * scale, row.high * scale
    return csr_array((value, (index, column)), shape=(len(rows), len(size))), low, high
