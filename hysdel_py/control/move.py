"""The answer of a predictive controller: an input, how good it is, and what to do when there is none."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from enum import Enum
from math import inf, nan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from hysdel_py.control.formulation import Formulation, Vectors

__all__ = ["Case", "Deferred", "Move", "MoveStatus"]


class MoveStatus(Enum):
    """What an answer is worth.

    ``OPTIMAL``, ``FEASIBLE`` and ``FALLBACK`` come with an input, all others without. The order is that of
    :attr:`code`.
    """

    OPTIMAL = "optimal"
    """The plan is optimal up to the gap that was asked for."""
    FEASIBLE = "feasible"
    """The plan keeps the model and the limits; a limit of time or nodes, or trouble in the solver, ended the proof."""
    INFEASIBLE = "infeasible"
    """There is no plan, or the measured state is outside the model."""
    NO_PLAN = "no plan found"
    """A limit of time or nodes came before the first plan; there may be one."""
    NUMERICAL = "numerical trouble"
    """The solver could not answer, or its answer did not pass the check."""
    UNBOUNDED = "unbounded"
    """The cost has no lower bound, which a quadratic cost with finite ranges cannot have."""
    FALLBACK = "fallback"
    """There was no plan; the input comes from the fallback that was asked for."""

    @property
    def code(self) -> int:
        """Number of the status, 0 for optimal, as the closed loop records it."""
        return list(MoveStatus).index(self)

    @property
    def has_input(self) -> bool:
        """Whether a move with this status has an input."""
        return self in (MoveStatus.OPTIMAL, MoveStatus.FEASIBLE, MoveStatus.FALLBACK)


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """The program behind a move.

    Attributes
    ----------
    vectors : Vectors
        What the measured state, the input applied last and the references made of the program.
    v : array of shape (n,), or None
        The plan as decision variables.
    formulation : Formulation or None
        The program with the limits of the call.
    """

    vectors: Vectors
    v: NDArray[np.float64] | None = None
    formulation: Formulation | None = None


class Deferred:
    """Something that is worked out when somebody asks for it, and once only: a field of a move, or a plan."""

    __slots__ = ("_make", "_value")

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make: Callable[[], Any] | None = make
        self._value: Any = None

    def value(self) -> Any:
        """Work it out."""
        if self._make is not None:
            self._value, self._make = self._make(), None
        return self._value


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Move:
    """One answer of a controller.

    Attributes
    ----------
    status : MoveStatus
    message : str
        The status in plain words and what can be done about it.
    u : array of shape (nu,), or None
        First input of the plan, inside its range and with Boolean entries exactly 0 or 1; None when there is no plan.
    cost : float
        Cost of the plan, infinite without one.
    bound : float
        No plan costs less than this.
    gap : float
        Cost minus bound, infinite without a plan.
    nodes, qps : int
        Nodes of the branch and bound, and quadratic programs that it solved.
    seconds : float
        Wall-clock time of the whole answer.
    predicted : Trajectory or None
        The plan: N+1 states, N inputs, outputs and auxiliaries.
    slack : mapping of name to float
        By how much each softened limit is exceeded at most.
    approximate_from : int or None
        Stage from which the binaries of the plan are relaxed, None when all are 0 or 1. The cost is then that of the
        relaxed plan, which no plan with all binaries exact can undercut beyond the gap.
    fallback : str
        Which fallback gave the input, empty for a plan.
    cause : MoveStatus or None
        With a fallback: why there was no plan.
    residual : float
        Largest violation of a limit by the plan of a linear controller, relative to the limit and at least absolute;
        not a number where it was not computed.
    case : Case or None
        What was solved, for :meth:`HybridMpc.why` and :meth:`HybridMpc.dump_problem`.
    """

    status: MoveStatus
    message: str
    u: NDArray[np.float64] | None = None
    cost: float = inf
    bound: float = -inf
    gap: float = inf
    nodes: int = 0
    qps: int = 0
    seconds: float = nan
    predicted: Trajectory | None = None
    slack: Mapping[str, float] = field(default_factory=dict)
    approximate_from: int | None = None
    fallback: str = ""
    cause: MoveStatus | None = None
    residual: float = nan
    case: Case | None = field(default=None, repr=False)

    def __getattribute__(self, name: str) -> Any:
        """Work out a deferred field at its first use; the trajectory of a plan costs more than many a search."""
        value = object.__getattribute__(self, name)
        if value.__class__ is Deferred:
            value = value.value()
            object.__setattr__(self, name, value)
        return value

    def at(self, seconds: float) -> Move:
        """The same move with another time; what is deferred stays so."""
        twin = object.__new__(Move)
        for name in _FIELDS:
            object.__setattr__(twin, name, object.__getattribute__(self, name))
        object.__setattr__(twin, "seconds", seconds)
        return twin

    def __repr__(self) -> str:
        if self.u is None:
            return f"<Move {self.status.value}>"
        u = ", ".join(f"{value:.6g}" for value in self.u)
        return f"<Move {self.status.value}: u = [{u}], cost {self.cost:.6g}, gap {self.gap:.1e}, {self.nodes} nodes>"

    def _repr_html_(self) -> str:
        from hysdel_py.markup.cards import move_card

        return move_card(self)

    @property
    def ok(self) -> bool:
        """Whether there is an input."""
        return self.u is not None


_FIELDS = tuple(entry.name for entry in fields(Move))
