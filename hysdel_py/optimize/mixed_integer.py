"""The mixed-integer quadratic program, the settings of its solver and its answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from math import inf
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.propagation import PropagationSettings
from hysdel_py.optimize.qp import Qp, QpSettings

__all__ = [
    "KERNELS",
    "Cover",
    "Miqp",
    "MiqpResult",
    "MiqpSettings",
    "MiqpStatus",
    "NodeFate",
    "NodeRecord",
    "SearchInfo",
]

Vector = NDArray[np.float64]
Indices = NDArray[np.intp]


KERNELS = ("auto", "dense")
"""Names of back ends that are not a sparse solver."""


class MiqpStatus(Enum):
    """How the search ended."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    TIME_LIMIT = "time limit"
    NODE_LIMIT = "node limit"
    INTERRUPTED = "interrupted"
    NUMERICAL = "numerical trouble"


@dataclass(frozen=True, eq=False)
class Miqp:
    """A convex quadratic program some of whose variables are 0 or 1.

    Attributes
    ----------
    qp : Qp
        Its bounds are cut to [0, 1] for the binaries.
    binaries : array of int
        Indices of the binary variables, each once.
    priorities : array of shape (number of binaries,), optional
        The binary with the lowest value is decided first: the stage, in predictive control. All equal by default.
    drivers : array of int
        Real variables whose values settle most others through the rows, as the inputs do in predictive control: the
        relaxed inputs pushed through the rows are a good guess of the binaries.
    """

    qp: Qp
    binaries: Any
    priorities: Any = None
    drivers: Any = ()

    def __post_init__(self) -> None:
        binaries = _indices(self.binaries, self.qp.n, "binaries")
        count = len(binaries)
        priorities = np.zeros(count) if self.priorities is None else np.asarray(self.priorities, dtype=float)
        if priorities.shape != (count,) or np.isnan(priorities).any():
            raise ArgumentError(f"priorities has shape {priorities.shape}: {count} numbers were expected")
        object.__setattr__(self, "binaries", binaries)
        object.__setattr__(self, "priorities", priorities)
        object.__setattr__(self, "drivers", _indices(self.drivers, self.qp.n, "drivers"))


@dataclass(frozen=True, slots=True)
class MiqpSettings:
    """Everything that can be set in the search.

    Attributes
    ----------
    backend : {"auto", "dense", "piqp", "osqp"}
        What solves the relaxations first: the dense kernels or one of the sparse solvers. ``"auto"`` takes the kernels
        where they are compiled, PIQP elsewhere. What one cannot settle goes to another.
    gap_abs, gap_rel : float
        The search ends once the objective is proven to be within the larger of ``gap_abs`` and
        ``gap_rel * |objective|`` of the optimum.
    integrality : float
        A relaxed binary this close to 0 or 1 is not branched on while others are not.
    feasibility : float
        A solution may violate a row or bound by this much, relative to the size of its side and at least absolute.
    time_limit : float
        Seconds of wall-clock time.
    node_limit : int
        Number of nodes.
    rounding : int
        Depth between two calls of the rounding heuristics; 0 switches them off.
    probing : int
        Nodes after which both values of every open binary are tried in the whole problem, and again after four times
        as many; 0 for never. Only the dense kernels probe.
    narrowing : bool
        Whether bounds of variables follow from the value of the incumbent. Only the dense kernels do that.
    leaves : int
        Ends of the tree that are noted for the search of a similar problem, at most; 0 for none, else 2 or more. Where
        a tree has more, the deepest are merged. Only the dense kernels do this.
    qp : QpSettings
    propagation : PropagationSettings
    """

    backend: str = "auto"
    gap_abs: float = 1e-6
    gap_rel: float = 1e-6
    integrality: float = 1e-6
    feasibility: float = 1e-7
    time_limit: float = inf
    node_limit: int = 1_000_000
    rounding: int = 4
    probing: int = 8
    narrowing: bool = True
    leaves: int = 0
    qp: QpSettings = field(default_factory=QpSettings)
    propagation: PropagationSettings = field(default_factory=PropagationSettings)

    def __post_init__(self) -> None:
        for name in ("gap_abs", "gap_rel", "time_limit", "node_limit", "rounding", "probing", "leaves"):
            if not (isinstance(getattr(self, name), Real) and getattr(self, name) >= 0):
                raise ArgumentError(f"{name} is {getattr(self, name)!r}: a number that is not negative was expected")
        if not isinstance(self.leaves, int) or self.leaves == 1:
            raise ArgumentError(f"leaves is {self.leaves!r}: 0, or a whole number from 2 on, was expected")
        for name in ("integrality", "feasibility"):
            if not (isinstance(getattr(self, name), Real) and 0 < getattr(self, name) < 0.5):
                raise ArgumentError(f"{name} is {getattr(self, name)!r}: a number between 0 and 0.5 was expected")

    @property
    def solver(self) -> str:
        """The sparse solver that is asked first."""
        return "piqp" if self.backend in KERNELS else self.backend


class NodeFate(Enum):
    """What became of a node."""

    SPLIT = "split"
    """Its two halves were put on the stack."""
    CUT_OFF = "cut off"
    """Its bound reaches the incumbent."""
    INFEASIBLE = "infeasible"
    """It is proven to be empty."""
    LEAF = "leaf"
    """All its binaries are fixed; it was solved."""


@dataclass(frozen=True, slots=True)
class NodeRecord:
    """A node that was looked at.

    Attributes
    ----------
    number : int
        From 1, in the order of the search.
    parent : int
        Number of its parent, 0 for the root.
    variable : int
        Binary that was fixed on the way here, -1 at the root.
    value : float
        What it was fixed at.
    bound : float
        Certified lower bound, infinite where the node is empty.
    fate : NodeFate
    """

    number: int
    parent: int
    variable: int
    value: float
    bound: float
    fate: NodeFate


@dataclass(frozen=True, slots=True)
class SearchInfo:
    """State of a running search, for the progress callback.

    Attributes
    ----------
    nodes, qps, open : int
        Nodes visited, quadratic programs solved, nodes still to be visited.
    objective, bound : float
        Best objective so far and certified lower bound.
    seconds : float
    node : NodeRecord or None
        The node that was looked at last; None from a search that does not tell.
    """

    nodes: int
    qps: int
    open: int
    objective: float
    bound: float
    seconds: float
    node: NodeRecord | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Cover:
    """The ends of a tree, which divide all words of binaries among them.

    Attributes
    ----------
    ways : array of shape (ends, number of binaries)
        Decisions on the way to each end as numbers ``2 * variable + value``.
    lengths : array of shape (ends,)
        How many of them count.
    points, multipliers : arrays of shape (ends, n), (ends, m)
        What an end was closed with.
    kinds : array of shape (ends,)
        0 where there are no multipliers, 1 where they give a bound, 2 where they are a ray of Farkas.
    """

    ways: NDArray[np.int64]
    lengths: NDArray[np.int64]
    points: Vector
    multipliers: Vector
    kinds: NDArray[np.int64]

    def arrays(self) -> tuple[Any, ...]:
        """The fields in their order."""
        return self.ways, self.lengths, self.points, self.multipliers, self.kinds


@dataclass(frozen=True, eq=False, slots=True)
class MiqpResult:
    """Answer of the search.

    Attributes
    ----------
    status : MiqpStatus
    x : array of shape (n,), or None
        Best point found, its binaries exactly 0 or 1; None if none was found.
    objective : float
        Value at x with the constant; infinite without a point, minus infinite if UNBOUNDED.
    bound : float
        Certified lower bound of the optimum.
    gap : float
        ``objective - bound``, not below 0; infinite without a point.
    nodes, qps : int
    seconds : float
    message : str
    residual : float
        Largest absolute violation of a row or bound by x.
    active : array of shape (rows, 2), or None
        Active inequalities at the relaxed solution of the whole problem, where the dense kernels found them: a row, or
        m + variable, and 1 for the upper side or -1 for the lower one.
    pseudo_costs : array of shape (n, 4), or None
        What the compiled loop has learnt about splitting at each variable: the sum of the growths of the bound per unit
        and their number, for the value 0, then for 1.
    cover : Cover or None
        The ends of the tree, where the settings ask for them and it has more than one.
    """

    status: MiqpStatus
    x: Vector | None
    objective: float
    bound: float
    gap: float
    nodes: int
    qps: int
    seconds: float
    message: str
    residual: float
    active: NDArray[np.int64] | None = None
    pseudo_costs: Vector | None = None
    cover: Cover | None = None


def _indices(value: ArrayLike | Sequence[int], n: int, name: str) -> Indices:
    raw = np.asarray(value)
    if raw.size == 0:
        return np.zeros(0, dtype=np.intp)
    if raw.ndim != 1 or raw.dtype.kind not in "iu":
        raise ArgumentError(f"{name} must be a list of indices: found {raw.dtype} of shape {raw.shape}")
    if raw.min() < 0 or raw.max() >= n:
        raise ArgumentError(f"{name} has the index {raw[(raw < 0) | (raw >= n)][0]}: 0 to {n - 1} was expected")
    if len(np.unique(raw)) != len(raw):
        raise ArgumentError(f"{name} names a variable twice")
    return raw.astype(np.intp)
