"""One run of branch and bound: open nodes, incumbent, and the bound that is proven so far.

A leaf is a node whose binaries are all fixed. Its relaxation is the problem that remains, so that the incumbents and
the leaves are the same thing; each combination of binaries is solved once, whether the tree or a guess came first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import inf
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.kernels.residual import violations
from hysdel_py.optimize.mixed_integer import (
    Cover,
    MiqpResult,
    MiqpSettings,
    MiqpStatus,
    NodeFate,
    NodeRecord,
    SearchInfo,
)
from hysdel_py.optimize.propagation import Box
from hysdel_py.optimize.qp import Qp, objective_value, violation
from hysdel_py.optimize.verified import Start, Verdict

if TYPE_CHECKING:
    from hysdel_py.optimize.miqp import MiqpSolver

__all__ = ["Node", "Search"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Node:
    """A part of the problem that has not been looked at yet.

    Attributes
    ----------
    box : Box
        Propagated bounds of the parent.
    variable : int
        Binary that is fixed here, -1 at the root.
    value : float
        0 or 1.
    bound : float
        Certified lower bound of the parent.
    depth : int
    guess : Start or None
        From the parent's relaxation.
    parent : int
        Number of the parent in the order of the search, 0 at the root.
    """

    box: Box
    variable: int
    value: float
    bound: float
    depth: int
    guess: Start | None
    parent: int = 0


class Search:
    """State of one run.

    Attributes
    ----------
    stack : list of Node
        Open nodes, the next one last.
    x, objective : array or None, float
        Incumbent.
    floor : float
        Least certified bound of the parts that are done.
    known : float
        Lower bound that the caller knows.
    active, pseudo_costs, cover : arrays, Cover, or None
        What the compiled loop hands on, see :class:`MiqpResult`.
    rows : tuple of arrays, or None
        A in compressed rows, where there are kernels that work on it.
    elsewhere, pending, solves_elsewhere : int, float, int
        Open nodes that the compiled loop keeps, their least bound, and the programs that it solved.
    """

    def __init__(self, solver: MiqpSolver, qp: Qp, start: float) -> None:
        self.solver, self.qp, self.start = solver, qp, start
        self.settings: MiqpSettings = solver.settings
        self.binaries, self.priorities = solver.miqp.binaries, solver.miqp.priorities
        self.heuristic: Callable[[Vector, Vector, Vector], Any] | None = None
        self.stack: list[Node] = []
        self.x: Vector | None = None
        self.objective, self.floor, self.known = inf, inf, -inf
        self.nodes, self.solves_before = 0, solver.verified.solves
        self.leaves: dict[bytes, float] = {}
        self.unsettled, self.unbounded = "", False
        self.elsewhere, self.pending, self.solves_elsewhere = 0, inf, 0
        self.record: NodeRecord | None = None
        self.rows: Any = None
        self.active: NDArray[np.int64] | None = None
        self.pseudo_costs: Vector | None = None
        self.cover: Cover | None = None

    # ---------------------------------------------------------------- steps of the main loop

    def open_root(self) -> None:
        """Propagate the whole problem; without a conflict it becomes the first node."""
        self.root = self._propagate(self.qp.lb, self.qp.ub)
        if self.root.conflict is None:
            self.stack.append(Node(self.root, -1, 0.0, self.known, 0, None))

    def explore(self, node: Node) -> None:
        """Look at one node: drop it, settle it, or put its two halves on the stack; record what became of it."""
        self.nodes += 1
        fate, bound = self.fate(node)
        if fate is not NodeFate.SPLIT:
            self.close(bound)
        self.record = NodeRecord(self.nodes, node.parent, node.variable, node.value, bound, fate)

    def fate(self, node: Node) -> tuple[NodeFate, float]:
        """What becomes of a node, with its certified bound."""
        if self.is_cut_off(node.bound):
            return NodeFate.CUT_OFF, node.bound
        box = self.restrict(node)
        if box.conflict is not None:
            return NodeFate.INFEASIBLE, inf
        if self.is_leaf(box):
            return NodeFate.LEAF, max(node.bound, self.settle(box, node.guess))
        verdict = self.relax(box, node.guess)
        if verdict.infeasible:
            return NodeFate.INFEASIBLE, inf
        bound = max(node.bound, verdict.bound)
        if not self.is_cut_off(bound):
            self.look_for_incumbents(node, box, verdict.answer.x)
        if self.is_cut_off(bound):
            return NodeFate.CUT_OFF, bound
        self.branch(node, box, verdict, bound)
        return NodeFate.SPLIT, bound

    def restrict(self, node: Node) -> Box:
        """Bounds of the node: the parent's with one more binary fixed, propagated."""
        if node.variable < 0:
            return node.box
        lb, ub = node.box.lb.copy(), node.box.ub.copy()
        lb[node.variable] = ub[node.variable] = node.value
        return self._propagate(lb, ub, np.array([node.variable]))

    def relax(self, box: Box, guess: Start | None) -> Verdict:
        """Solve the relaxation; the certificates use the implied bounds, the solver only those of the binaries."""
        return self.solver.verified.solve(
            self._within(box), (box.lb, box.ub), guess, self._enough_to_branch, thorough=False
        )

    def settle(self, box: Box, guess: Start | None = None) -> float:
        """Solve with all binaries fixed, keep the point if it is better; return a certified lower bound."""
        key = (box.lb[self.binaries] + 0.0).tobytes()
        if key not in self.leaves:
            self.leaves[key] = self._settle(box, guess)
        return self.leaves[key]

    def look_for_incumbents(self, node: Node, box: Box, x: Vector) -> None:
        """Ask the heuristics every few levels, until one of their guesses is better than the incumbent."""
        every = self.settings.rounding
        if not np.isfinite(x).all() or (node.depth and (every == 0 or node.depth % every)):
            return
        before = self.objective
        for values in self._candidates(box, x):
            self.try_guess(values)
            if self.objective < before:
                return

    def branch(self, node: Node, box: Box, verdict: Verdict, bound: float) -> None:
        """Split at the binary of the lowest priority that is not integral, the nearer value to be visited first."""
        x, guess = verdict.answer.x, verdict.start
        variable = self._branching_variable(box, x)
        near = 1.0 if x[variable] > 0.5 else 0.0
        for value in (1.0 - near, near):
            self.stack.append(Node(box, variable, value, bound, node.depth + 1, guess, self.nodes))

    def close(self, bound: float) -> None:
        """Remember the bound of a part that is done."""
        self.floor = min(self.floor, bound)

    def try_guess(self, values: Vector | None) -> None:
        """Settle a guess of all binaries if the bounds and the propagation allow it."""
        if values is None or self.root.conflict is not None:
            return
        lb, ub, at = self.root.lb.copy(), self.root.ub.copy(), self.binaries
        values = np.round(values) + 0.0
        if not (np.all(values >= lb[at]) and np.all(values <= ub[at])):
            return
        changed = at[lb[at] < ub[at]]
        lb[at] = ub[at] = values
        box = self._propagate(lb, ub, changed)
        if box.conflict is None:
            self.settle(box)

    # ---------------------------------------------------------------- tests

    def is_cut_off(self, bound: float) -> bool:
        """Whether nothing below the bound could be better than the incumbent by more than the gap."""
        return bound >= self.objective - self.allowed_gap()

    def is_leaf(self, box: Box) -> bool:
        """Whether all binaries are fixed."""
        return bool(np.all(box.lb[self.binaries] == box.ub[self.binaries]))

    def allowed_gap(self) -> float:
        """Absolute gap at which the search may end."""
        size = abs(self.objective) if np.isfinite(self.objective) else 0.0
        return max(self.settings.gap_abs, self.settings.gap_rel * size)

    def reason_to_stop(self, progress: Callable[[SearchInfo], bool | None] | None) -> MiqpStatus | None:
        """Status with which the run has to end now, or None."""
        if self.unbounded:
            return MiqpStatus.UNBOUNDED
        if progress is not None and progress(self.info()) is False:
            return MiqpStatus.INTERRUPTED
        if self.open and perf_counter() - self.start >= self.settings.time_limit:
            return MiqpStatus.TIME_LIMIT
        if self.open and self.nodes >= self.settings.node_limit:
            return MiqpStatus.NODE_LIMIT
        return None

    # ---------------------------------------------------------------- results

    def bound(self) -> float:
        """Certified lower bound of the whole problem: the least of what is open and what is done."""
        open_bound = min((node.bound for node in self.stack), default=inf)
        return min(self.floor, open_bound, self.pending, self.objective)

    @property
    def open(self) -> int:
        """Number of open nodes."""
        return len(self.stack) + self.elsewhere

    def info(self) -> SearchInfo:
        """State for the progress callback."""
        seconds = perf_counter() - self.start
        return SearchInfo(self.nodes, self._solves(), self.open, self.objective, self.bound(), seconds, self.record)

    def stopped(self, status: MiqpStatus) -> MiqpResult:
        """Result of a run that ended before its time."""
        if status is MiqpStatus.UNBOUNDED:
            return self._result(status, -inf, -inf, "the real variables have a direction of descent without end")
        message = f"stopped ({status.value}) with {self.open} open nodes"
        return self._result(status, self.objective, self.bound(), message)

    def finished(self) -> MiqpResult:
        """Result of a run that has no open nodes left."""
        bound = self.bound()
        if self.unbounded:
            return self.stopped(MiqpStatus.UNBOUNDED)
        if self.x is None and bound == inf:
            return self._result(MiqpStatus.INFEASIBLE, inf, inf, "every part is proven infeasible")
        if self.objective - bound <= self.allowed_gap():
            return self._result(MiqpStatus.OPTIMAL, self.objective, bound, "optimal within the gap")
        reason = self.unsettled or "the certificates do not close the gap"
        return self._result(MiqpStatus.NUMERICAL, self.objective, bound, reason)

    # ---------------------------------------------------------------- inside

    def _propagate(self, lb: Vector, ub: Vector, changed: NDArray[np.intp] | None = None) -> Box:
        return self.solver.propagator.propagate(lb, ub, self.qp.l, self.qp.u, changed)

    def _within(self, box: Box) -> Qp:
        lb, ub, at = self.qp.lb.copy(), self.qp.ub.copy(), self.binaries
        lb[at], ub[at] = box.lb[at], box.ub[at]
        return self.qp.with_vectors(lb=lb, ub=ub)

    def _settle(self, box: Box, guess: Start | None) -> float:
        qp = self._within(box)
        verdict = self.solver.verified.solve(qp, (box.lb, box.ub), guess, self._enough_to_settle)
        if verdict.infeasible:
            return inf
        if verdict.unbounded and self.known == -inf:
            self.unbounded = True
            return -inf
        self._offer(verdict.answer.x, box.lb[self.binaries] + 0.0)
        return verdict.bound

    def _offer(self, x: Vector, values: Vector) -> None:
        """Make a point the incumbent if it is feasible with exact binaries, and better."""
        point = x.copy()
        point[self.binaries] = values
        excess = violation(self.qp, point)
        if not excess <= self.settings.feasibility:
            self.unsettled = f"a leaf is neither solved (violation {excess:.2g}) nor proven infeasible"
            return
        value = objective_value(self.qp, point)
        if value < self.objective:
            self.x, self.objective = point, value

    def _enough_to_branch(self, verdict: Verdict) -> bool:
        """Whatever its residuals, a feasible point that meets its certified bound is solved."""
        return verdict.optimal or self.is_cut_off(verdict.bound) or self._meets_its_bound(verdict)

    def _enough_to_settle(self, verdict: Verdict) -> bool:
        """A leaf needs a feasible point and a bound that meets it, unless the bound alone cuts it off."""
        return self.is_cut_off(verdict.bound) or self._meets_its_bound(verdict)

    def _meets_its_bound(self, verdict: Verdict) -> bool:
        if not violation(self.qp, verdict.answer.x) <= self.settings.feasibility:
            return False
        allowed = max(self.settings.gap_abs, self.settings.gap_rel * abs(verdict.answer.objective))
        return verdict.answer.objective - verdict.bound <= allowed

    def _candidates(self, box: Box, x: Vector) -> Iterator[Vector]:
        yield from self.words_of_heuristic(box, x)
        if self.settings.rounding:
            yield from self.solver.guesser.guesses(box, (self.qp.l, self.qp.u), x)

    def words_of_heuristic(self, box: Box, x: Vector) -> Iterator[Vector]:
        """Yield what the caller's heuristic makes of a relaxed point, if there is one."""
        given = None if self.heuristic is None else self.heuristic(x, box.lb, box.ub)
        if given is not None:
            yield from self._words(given)

    def _words(self, given: Any) -> Vector:
        words = np.atleast_2d(np.asarray(given, dtype=float))
        if words.ndim != 2 or words.shape[1] != len(self.binaries):
            raise ArgumentError(f"heuristic gave shape {np.shape(given)}: rows of {len(self.binaries)} were expected")
        return words

    def _branching_variable(self, box: Box, x: Vector) -> int:
        at = self.binaries
        free = box.lb[at] < box.ub[at]
        distance = np.abs(x[at] - np.round(x[at]))
        split = free & (distance > self.settings.integrality)
        among = np.flatnonzero(split if split.any() else free)
        first = among[self.priorities[among] == self.priorities[among].min()]
        return int(at[first[distance[first].argmax()]])

    def _solves(self) -> int:
        return self.solver.verified.solves - self.solves_before + self.solves_elsewhere

    def _result(self, status: MiqpStatus, objective: float, bound: float, message: str) -> MiqpResult:
        gap = max(0.0, objective - bound) if self.x is not None and status is not MiqpStatus.UNBOUNDED else inf
        residual = self._residual()
        seconds = perf_counter() - self.start
        return MiqpResult(
            status, self.x, objective, bound, gap, self.nodes, self._solves(), seconds, message, residual, self.active,
            self.pseudo_costs, self.cover,
        )  # fmt: skip

    def _residual(self) -> float:
        if self.x is None:
            return inf
        x, qp = self.x, self.qp
        if self.rows is not None:
            return float(violations(self.rows, qp.l, qp.u, qp.lb, qp.ub, x)[0])
        rows = qp.A @ x
        at_rows, at_bounds = np.maximum(qp.l - rows, rows - qp.u), np.maximum(qp.lb - x, x - qp.ub)
        return float(max(at_rows.max(initial=0.0), at_bounds.max(initial=0.0)))
