"""A run of branch and bound by the compiled loop, with the search in Python for what the loop hands back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.optimize.compiled_propagation import CompiledPropagator
from hysdel_py.optimize.dense import NO_GUESS
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.mixed_integer import Cover, MiqpResult, NodeFate, NodeRecord, SearchInfo
from hysdel_py.optimize.propagation import Box
from hysdel_py.optimize.qp import Qp
from hysdel_py.optimize.search import Node, Search
from hysdel_py.optimize.workspace import Workspace

if TYPE_CHECKING:
    from hysdel_py.optimize.miqp import MiqpSolver

__all__ = ["CompiledSearch", "Hints"]

Vector = NDArray[np.float64]
SLICE = 256
"""Most nodes between two looks at the clock where nobody listens."""
PATIENCE = 0.5
"""Share of the time that is left which the nodes up to the next look at the clock may take."""
AS_LONG_AS = 6
"""Nodes that take as long as one probing of the whole problem, or a little longer."""
NOTHING = np.zeros(0)
_FATES = (NodeFate.SPLIT, NodeFate.CUT_OFF, NodeFate.INFEASIBLE, NodeFate.LEAF)
"""In the order of the numbers that the loop has for them."""


@dataclass(frozen=True, eq=False, slots=True)
class Hints:
    """What is known of the solution beforehand.

    Attributes
    ----------
    floor : float
        Lower bound of the objective.
    word : array of shape (number of binaries,), or None
    point : array of shape (n,), or None
        Only its drivers count.
    active : array of shape (rows, 2), or None
        Active inequalities.
    pseudo_costs : array of shape (n, 4), or None
        See :mod:`hysdel_py.optimize.kernels.branching`.
    cover : Cover or None
        Parts from which the tree begins.
    """

    floor: float = -inf
    word: Vector | None = None
    point: Vector | None = None
    active: NDArray[np.int64] | None = None
    pseudo_costs: Vector | None = None
    cover: Cover | None = None


class CompiledSearch:
    """One run of the compiled loop.

    Parameters
    ----------
    solver : MiqpSolver
    qp : Qp
    begin : float
        Time at which the call came.
    heuristic, progress
        See :meth:`hysdel_py.optimize.miqp.MiqpSolver.solve`.
    """

    def __init__(
        self, solver: MiqpSolver, qp: Qp, begin: float, heuristic: Any, progress: Callable[[SearchInfo], Any] | None
    ) -> None:
        assert solver.workspace is not None
        self.space: Workspace = solver.workspace
        self.search = Search(solver, qp, begin)
        self.search.heuristic, self.search.rows = heuristic, self.space.dense.rows
        self.progress = progress
        bounded = bool(np.isfinite(qp.lb).all() and np.isfinite(qp.ub).all())
        self.data = self.space.data(qp, None if bounded else solver.verified.certifier(qp).curvature)

    def run(self, hints: Hints) -> MiqpResult:
        """Search until the end or until a limit is reached."""
        if not self._start(hints):
            return self.search.finished()
        stop = None
        while stop is None and self.search.open:
            before = self.search.nodes
            self._advance()
            stop = self.search.reason_to_stop(self.progress if self.search.nodes > before else None)
        self.search.active, self.search.pseudo_costs = self._root_active(), self._learnt(hints)
        self.search.cover = self.space.noted()
        return self.search.finished() if stop is None else self.search.stopped(stop)

    def _learnt(self, hints: Hints) -> Vector | None:
        """The pseudo-costs, None as long as no node has been split."""
        learnt: Vector = self.space.state[its.COSTS]
        return learnt.copy() if hints.pseudo_costs is not None or self.search.nodes > 1 else None

    def rehearse(self) -> None:
        """Load or compile the loop and what comes after it, so that the first search does not have to wait for them."""
        from hysdel_py.optimize.kernels.cover import keep_open, later
        from hysdel_py.optimize.kernels.residual import violations
        from hysdel_py.optimize.kernels.tree import least_open

        self._start(Hints())  # may well find the program empty, without the numbers of a call
        self._loop(0)
        space, problem, (lb, ub) = self.space, self.data[its.PROBLEM], self.data[its.WIDE]
        nowhere = np.full(len(problem[3]), -1, dtype=np.int64)
        violations(space.dense.rows, problem[3], problem[4], lb, ub, np.zeros(len(lb)))
        keep_open(space.tree, np.zeros_like(space.state[its.COUNTERS]), space.recorded)
        least_open(space.tree[its.BOUNDS], space.tree[its.ORDER], np.zeros_like(space.state[its.COUNTERS]))
        later(space.nothing_carried, 0, np.zeros(len(lb)), 1, 1, nowhere)
        self._rehearse_help()

    def _rehearse_help(self) -> None:
        """The same for what is only needed where a node needs other means; the next start forgets what this leaves."""
        from hysdel_py.optimize.kernels.search import note_word

        self.space.dense.warm_up()
        if isinstance(self.search.solver.propagator, CompiledPropagator):
            self.search.solver.propagator.warm_up()
        lb, ub = self.data[its.WIDE]
        self.search.stack.append(Node(Box(lb, ub), -1, 0.0, -inf, 0, None))
        self._hand_over()
        self._keep_end()
        note_word(np.zeros(len(self.space.binaries)), self.space.state)

    def _start(self, hints: Hints) -> bool:
        """Open the root; False if propagation proves the problem empty."""
        from hysdel_py.optimize.kernels.search import start

        point = NOTHING if hints.point is None else np.array(hints.point, dtype=float)
        word = NOTHING if hints.word is None else np.array(hints.word, dtype=float)
        guess = (float(hints.floor), point, word, NO_GUESS if hints.active is None else hints.active)
        self.space.carry(hints.cover)
        self.space.state[its.COSTS][:] = 0.0 if hints.pseudo_costs is None else hints.pseudo_costs
        self.search.known, self.search.elsewhere = hints.floor, 1
        return bool(start(self.data, self.space.tree, self.space.state, self.space.settings, guess))

    def _advance(self) -> None:
        """One slice of the compiled loop, and what it needs afterwards."""
        from hysdel_py.optimize.kernels import search as kernel

        nodes = self._slice()
        self._postpone_probing(nodes)
        reason = self._loop(nodes)
        if self.progress is not None:
            self.search.record = self._record()
        if reason == kernel.FULL:
            self.space.grow()
        elif reason == kernel.HELP:
            self._help()
        elif self.search.heuristic is not None:
            self._ask_heuristic()

    def _loop(self, nodes: int) -> int:
        from hysdel_py.optimize.kernels.search import run

        reason: int = run(self.data, self.space.tree, self.space.state, self.space.settings, nodes)
        self._take_over()
        return reason

    def _record(self) -> NodeRecord:
        """The node that was visited last."""
        from hysdel_py.optimize.kernels import search as kernel
        from hysdel_py.optimize.kernels import tree

        numbers, counters = self.space.state[1:3]
        variable, value, parent = counters[tree.WAY : tree.WAY + 3].tolist()
        fate = _FATES[int(counters[tree.FATE])]
        bound = inf if fate is NodeFate.INFEASIBLE else float(numbers[kernel.BOUND])
        return NodeRecord(int(counters[tree.NODES]), parent, variable, float(value), bound, fate)

    def _root_active(self) -> NDArray[np.int64]:
        from hysdel_py.optimize.kernels import tree

        active: NDArray[np.int64] = self.space.state[its.ROOT_ACTIVE][
            : self.space.state[its.COUNTERS][tree.ACTIVE]
        ].copy()
        return active

    def _slice(self) -> int:
        """Nodes until somebody has to be told or the clock has to be read."""
        s = self.search
        if self.progress is not None or s.heuristic is not None or not kernels_are_compiled():
            return 1
        return int(max(1, min(SLICE, PATIENCE * self._affordable(), s.settings.node_limit - s.nodes)))

    def _affordable(self) -> float:
        """Nodes that fit into the time that is left, as far as those before tell; none at first."""
        s = self.search
        if s.settings.time_limit == inf:
            return inf
        spent = perf_counter() - s.start
        return (s.settings.time_limit - spent) * s.nodes / spent

    def _postpone_probing(self, nodes: int) -> None:
        """No probing among the next nodes where it would not end in time."""
        from hysdel_py.optimize.kernels import tree

        counters = self.space.state[its.COUNTERS]
        after = counters[tree.NODES] + nodes
        if after > counters[tree.PROBING] and self._affordable() < AS_LONG_AS:
            counters[tree.PROBING] = after

    def _take_over(self) -> None:
        """Tell the search in Python what the compiled loop has found."""
        from hysdel_py.optimize.kernels import search as kernel
        from hysdel_py.optimize.kernels import tree

        x, numbers, counters = self.space.state[:3]
        s = self.search
        if numbers[kernel.OBJECTIVE] < s.objective:
            s.x, s.objective = x.copy(), float(numbers[kernel.OBJECTIVE])
        s.floor = float(numbers[kernel.FLOOR])
        s.nodes, s.solves_elsewhere = int(counters[tree.NODES]), int(counters[tree.SOLVES])
        s.elsewhere = int(counters[tree.OPEN])
        s.pending = (
            float(tree.least_open(self.space.tree[its.BOUNDS], self.space.tree[its.ORDER], counters))
            if s.elsewhere
            else inf
        )

    def _hand_over(self) -> None:
        """Tell the compiled loop what the search in Python has found; the open nodes move there."""
        from hysdel_py.optimize.kernels import search as kernel
        from hysdel_py.optimize.kernels import tree

        x, numbers, counters = self.space.state[:3]
        s = self.search
        if s.x is not None:
            x[:] = s.x
        numbers[kernel.OBJECTIVE], numbers[kernel.FLOOR] = s.objective, s.floor
        for node in s.stack:
            if counters[tree.OPEN] >= len(self.space.tree[its.ORDER]):
                self.space.grow()
            box = node.box.lb, node.box.ub
            near = np.array(box[0] if node.guess is None else node.guess.x)
            near = np.where(np.isfinite(near), near, 0.0)
            fixed = int(node.variable), float(node.value)
            way = self.space.state[its.HERE]
            tree.push(self.space.tree, counters, box, float(node.bound), *fixed, NO_GUESS, near, way)
        counters[tree.DIVE] = len(s.stack) > 0
        s.stack.clear()

    def _help(self) -> None:
        """Explore the node that the loop could not certify with all other means."""
        from hysdel_py.optimize.kernels import search as kernel
        from hysdel_py.optimize.kernels import tree

        _, numbers, counters, box = self.space.state[:4]
        s = self.search
        if not hasattr(s, "root"):
            s.root = Box(self.space.state[its.ROOT][0].copy(), self.space.state[its.ROOT][1].copy())
        s.nodes -= 1  # the loop has counted this node
        before = s.record
        inside = Box(box[0].copy(), box[1].copy())
        s.explore(Node(inside, -1, 0.0, float(numbers[kernel.BOUND]), int(counters[tree.DEPTH]), None))
        if before is not None and s.record is not None:
            s.record = replace(s.record, parent=before.parent, variable=before.variable, value=before.value)
        if not s.stack:
            self._keep_end()
        self._hand_over()
        self._take_over()

    def _keep_end(self) -> None:
        """Note the node that was visited last among the ends of the tree."""
        from hysdel_py.optimize.kernels import cover, tree

        state = self.space.state
        cover.keep(
            self.space.recorded,
            state[its.HERE],
            int(state[its.COUNTERS][tree.DEPTH]),
            state[its.RELAXED],
            state[its.MULTIPLIERS],
            cover.OPEN_END,
        )

    def _ask_heuristic(self) -> None:
        """Let the caller's heuristic look at the relaxed point of the last node, if it had one."""
        from hysdel_py.optimize.kernels import search as kernel
        from hysdel_py.optimize.kernels import tree

        _, _, counters, box, relaxed = self.space.state[:5]
        s = self.search
        every, depth = s.settings.rounding, int(counters[tree.DEPTH])
        if np.isnan(relaxed[0]) or (depth and (every == 0 or depth % every)):
            return
        for word in s.words_of_heuristic(Box(box[0].copy(), box[1].copy()), relaxed.copy()):
            kernel.note_word(np.clip(np.round(word), 0.0, 1.0), self.space.state)
        self._loop(0)
