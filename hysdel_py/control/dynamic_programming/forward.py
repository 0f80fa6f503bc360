"""Forward search: the cheapest path into every cell that is reached from one state.

Section 9.1 of J.R.P. Kusters, "Modelling and coordinated control of advanced automotive transmissions", TU/e,
DCT 2005-58, with two changes: inputs are recovered by back pointers instead of a history per path, and the last input
belongs to the cell where changes of input cost something.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.dynamic_programming.evaluation import Functions
from hysdel_py.control.dynamic_programming.plan import DpPlan, DpStatus, checked_vector, replayed
from hysdel_py.control.dynamic_programming.schedule import Stage
from hysdel_py.control.dynamic_programming.settings import DpSettings
from hysdel_py.errors import ArgumentError

__all__ = ["ForwardSearch", "search_forward"]

Matrix = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Layer:
    """Cells reached at one stage: their states, costs, and how each was reached.

    Attributes
    ----------
    x : array of shape (n, nx)
    cost : array of shape (n,)
    chosen, parent : arrays of int, shape (n,)
        Input that led here (-1 at the start), and place in the layer before.
    """

    x: Matrix
    cost: Matrix
    chosen: Indices
    parent: Indices


@dataclass(frozen=True, eq=False, slots=True)
class ForwardSearch:
    """Answer of the forward search.

    Attributes
    ----------
    plan : DpPlan
        The cheapest path into the end set.
    ends : array of shape (n, nx)
        End states that were reached, the cheapest first.
    end_costs : array of shape (n,)
    reached : tuple of int
        Number of cells reached at each stage.
    transitions : int
        Number of steps of the plant.
    """

    plan: DpPlan
    ends: Matrix
    end_costs: Matrix
    reached: tuple[int, ...]
    transitions: int


@dataclass(slots=True)
class _Search:
    functions: Functions
    schedule: tuple[Stage, ...]
    settings: DpSettings
    snap: bool
    remember_input: bool
    layers: list[Layer]
    first_changes: Matrix
    transitions: int = 0
    changes: Matrix = field(init=False)

    def __post_init__(self) -> None:
        stage = self.schedule[0]
        before = stage.before
        self.changes = np.zeros((0, 0)) if before is None else before.changes[before.group]

    def extend(self, k: int) -> None:
        """Add the layer of the next stage."""
        layer, inputs = self.layers[-1], len(self.schedule[k].inputs)
        size = max(1, self.settings.chunk // inputs)
        best = self._empty()
        for start in range(0, len(layer.cost), size):
            candidates = self._steps(k, layer, start, min(start + size, len(layer.cost)))
            best = _cheapest(tuple(np.concatenate(pair) for pair in zip(best, candidates, strict=True)))
        _, cost, chosen, parent, x = best
        self.layers.append(Layer(x, cost, chosen, parent))

    def _empty(self) -> tuple[Any, ...]:
        none = np.zeros(0, dtype=np.int64)
        return none, np.zeros(0), none, none, np.zeros((0, self.functions.nx))

    def _steps(self, k: int, layer: Layer, start: int, stop: int) -> tuple[Any, ...]:
        """Keys, costs, inputs, parents and states of all admissible steps from some cells, one per cell reached."""
        inputs, mesh = self.schedule[k].inputs, self.schedule[k + 1].mesh
        change = self._change(layer.chosen[start:stop])
        parent, chosen = np.nonzero(np.isfinite(change))
        x = layer.x[start:stop][parent]
        after, cost = self.functions.step(k, x, inputs[chosen], mesh)
        self.transitions += len(x)
        cost = cost + change[parent, chosen] + layer.cost[start:stop][parent]
        sound = np.isfinite(cost)
        parent, chosen, after, cost = parent[sound] + start, chosen[sound], after[sound], cost[sound]
        node = mesh.nearest(after)
        if self.snap:
            after = _node_states(mesh, node)
        before = self.schedule[k + 1].before if self.remember_input else None
        key = node if before is None else node * len(before.changes) + before.group[chosen]
        return _cheapest((key, cost, chosen, parent, after))

    def _change(self, chosen: Indices) -> Matrix:
        if self.functions.change_cost is None:
            return np.zeros((len(chosen), len(self.schedule[0].inputs)))
        return np.where((chosen >= 0)[:, None], self.changes[chosen], self.first_changes)

    def end_costs(self) -> Matrix:
        """Costs of the last layer with the end cost, infinite outside the end set."""
        layer = self.layers[-1]
        return layer.cost + self.functions.end(layer.x) if len(layer.cost) else layer.cost

    def inputs_to(self, place: int) -> Matrix:
        """Inputs of the path to a place of the last layer."""
        found = []
        for k in reversed(range(1, len(self.layers))):
            layer = self.layers[k]
            found.append(self.schedule[k - 1].inputs[layer.chosen[place]])
            place = int(layer.parent[place])
        return np.array(found[::-1])


def search_forward(
    functions: Functions,
    schedule: tuple[Stage, ...],
    variables: Mapping[str, Any],
    sample_time: float,
    settings: DpSettings,
    x0: ArrayLike,
    last_input: ArrayLike | None,
    *,
    snap: bool,
    remember_input: bool,
    progress: Callable[[int, int], Any] | None,
) -> ForwardSearch:
    """See :meth:`DynamicProgram.forward`."""
    x = checked_vector(x0, variables["x"], "state")
    before = checked_vector(last_input, variables["u"], "last input")
    assert x is not None
    if not schedule[0].mesh.holds(x):
        raise ArgumentError(f"x0 is {x.tolist()}: a state on the axes was expected")
    first = functions.changes(None if before is None else before[None], schedule[0].inputs)
    start = Layer(x[None], np.zeros(1), np.array([-1]), np.array([0]))
    search = _Search(functions, schedule, settings, snap, remember_input, [start], first)
    N = len(schedule) - 1
    try:
        for k in range(N):
            search.extend(k)
            if progress is not None:
                progress(k + 1, N)
    except KeyboardInterrupt:
        return _result(search, DpPlan(DpStatus.INTERRUPTED, f"interrupted after {len(search.layers) - 1} stages"))
    costs = search.end_costs()
    order = np.argsort(costs, kind="stable")[: int(np.isfinite(costs).sum())]
    if not len(order):
        return _result(search, DpPlan(DpStatus.INFEASIBLE, _no_end(search)))
    inputs = search.inputs_to(int(order[0]))
    plan = replayed(functions, x, inputs, before, variables, sample_time, float(costs[order[0]]))
    return _result(search, plan, search.layers[-1].x[order], costs[order])


def _result(search: _Search, plan: DpPlan, ends: Matrix | None = None, costs: Matrix | None = None) -> ForwardSearch:
    none = np.zeros((0, search.functions.nx))
    reached = tuple(len(layer.cost) for layer in search.layers)
    return ForwardSearch(
        plan, none if ends is None else ends, np.zeros(0) if costs is None else costs, reached, search.transitions
    )  # fmt: skip


def _no_end(search: _Search) -> str:
    sizes = [len(layer.cost) for layer in search.layers]
    if 0 in sizes:
        where = f"no admissible step leads from stage {sizes.index(0) - 1} to stage {sizes.index(0)}"
    else:
        where = f"none of the {sizes[-1]} states reached at the end lies in the end set"
    return f"infeasible: {where}; widen the axes, take finer ones, or allow more stages"


def _cheapest(candidates: tuple[Any, ...]) -> tuple[Any, ...]:
    """For each key the cheapest candidate; of equal costs the first."""
    key, cost = candidates[0], candidates[1]
    order = np.lexsort((cost, key))
    ordered = key[order]
    first = np.ones(len(order), dtype=bool)
    first[1:] = ordered[1:] != ordered[:-1]
    kept = order[first]
    return tuple(column[kept] for column in candidates)


def _node_states(mesh: Any, node: Indices) -> Matrix:
    index = np.unravel_index(node, tuple(mesh.counts))
    return np.stack([axis.values[i] for axis, i in zip(mesh.axes, index, strict=True)], axis=-1)
