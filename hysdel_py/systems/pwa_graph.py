"""Which modes lie side by side, and which can follow on which."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.solver import LpSolver
from hysdel_py.systems.mode import Mode
from hysdel_py.systems.sections import Section, compatible, facing_rows, section_of

if TYPE_CHECKING:
    import networkx as nx

    from hysdel_py.systems.pwa import Pwa

__all__ = ["adjacency", "transitions"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


def adjacency(pwa: Pwa) -> nx.Graph:
    """Graph of the modes with an edge where two regions share a facet, the gap of a threshold apart.

    Nodes are indices of modes. An edge has the attribute ``across``, the condition between the two. Modes whose
    Boolean coordinates have different values lie in different places and share no facet.
    """
    import networkx as nx

    graph = nx.Graph()
    graph.add_nodes_from(mode.index for mode in pwa.modes)
    solver = LpSolver()
    sections = [section_of(mode, (*pwa.x, *pwa.u)) for mode in pwa.modes]
    for first, second in combinations(sections, 2):
        if compatible(first, second) and _boxes_meet(first, second):
            row = _common_facet(first, second, solver)
            if row is not None:
                graph.add_edge(first.mode.index, second.mode.index, across=_condition(first, row))
    return graph


def _condition(section: Section, row: int) -> str:
    source = section.sources[row]
    return source.text or source.name


def _boxes_meet(first: Section, second: Section) -> bool:
    """Whether two boxes are at most the greatest gap apart in every coordinate."""
    reach = max(first.gaps.max(initial=0.0), second.gaps.max(initial=0.0)) / min(
        first.lengths.min(initial=1.0), second.lengths.min(initial=1.0)
    )
    return bool(np.all((first.low <= second.high + reach) & (second.low <= first.high + reach)))


def _common_facet(first: Section, second: Section, solver: LpSolver) -> int | None:
    """Row of the first section behind which the second one begins on a whole facet."""
    least = -solver.precision.touch if first.mode.is_flat or second.mode.is_flat else solver.precision.interior
    for i, j in facing_rows(first, second, solver.precision):
        A = np.vstack([first.A, second.A])
        widen, shrink = np.concatenate([first.gaps, second.gaps]), np.concatenate([first.lengths, second.lengths])
        faces = [i, len(first.b) + j]
        sides = np.concatenate([first.b, second.b])
        sides[faces] += widen[faces]
        shrink[faces] = 0.0
        if _greatest_slack(A, sides, shrink, solver) > least:
            return i
    return None


def _greatest_slack(A: Matrix, b: Vector, weights: Vector, solver: LpSolver) -> float:
    """Greatest t, up to 1, with ``A v + weights t <= b``; minus infinity if there is none."""
    free = np.full(A.shape[1] + 1, np.inf)
    most = np.append(free[:-1], 1.0)
    cost = np.append(np.zeros(A.shape[1]), 1.0)
    answer = solver.maximise(cost, np.column_stack([A, weights]), b, -free, most)
    return float(answer.w[-1]) if answer.is_optimal else -np.inf


def transitions(pwa: Pwa) -> nx.DiGraph:
    """Graph of the modes with an edge from i to j where some (x, u) of i leads to a state that j has an input for."""
    import networkx as nx

    graph = nx.DiGraph()
    graph.add_nodes_from(mode.index for mode in pwa.modes)
    solver = LpSolver()
    maps = _Maps(pwa)
    sections = [section_of(mode, (*pwa.x, *pwa.u)) for mode in pwa.modes]
    for first in sections:
        for offset in maps.offsets(first):
            reach = maps.reach(first, offset)
            for second in sections:
                if maps.may_follow(reach, offset, second) and maps.leads(first, offset, second, solver):
                    graph.add_edge(first.mode.index, second.mode.index)
    return graph


class _Maps:
    """Next states of a system over the real coordinates, with the Boolean ones as numbers."""

    def __init__(self, pwa: Pwa) -> None:
        variables = (*pwa.x, *pwa.u)
        self._reals = [i for i, v in enumerate(variables) if not v.is_bool]
        self._real_states = [i for i, v in enumerate(pwa.x) if not v.is_bool]
        self._boolean_states = [i for i, v in enumerate(pwa.x) if v.is_bool]

    def _state_map(self, mode: Mode) -> Matrix:
        return np.hstack([mode.A, mode.B])

    def offsets(self, section: Section) -> Iterator[Vector]:
        """The constant parts of the next state, one for each choice of the free Booleans that matter to it."""
        whole = self._state_map(section.mode)
        columns = [column for column, _ in section.booleans]
        choices = [
            ((0.0, 1.0) if whole[:, column].any() else (0.0,)) if value is None else (float(value),)
            for column, value in section.booleans
        ]
        for word in product(*choices):
            yield section.mode.f + whole[:, columns] @ np.array(word, dtype=float)

    def reach(self, section: Section, offset: Vector) -> tuple[Vector, Vector]:
        """Box around the real next states."""
        M = self._state_map(section.mode)[np.ix_(self._real_states, self._reals)]
        with np.errstate(invalid="ignore"):
            ends = np.stack([M * section.low, M * section.high])
        ends[:, M == 0] = 0.0
        constant = offset[self._real_states]
        return ends.min(axis=0).sum(axis=1) + constant, ends.max(axis=0).sum(axis=1) + constant

    def may_follow(self, reach: tuple[Vector, Vector], offset: Vector, section: Section) -> bool:
        """Whether the Booleans fit and the boxes meet."""
        values = dict(section.booleans)
        for state in self._boolean_states:
            if values[state] is not None and bool(offset[state] > 0.5) != values[state]:
                return False
        count = len(self._real_states)
        size = 1.0 + np.abs(section.low[:count]) + np.abs(section.high[:count])
        allowed = LpSolver().precision.touch * np.where(np.isfinite(size), size, 1.0)
        low, high = reach
        return bool(np.all((low <= section.high[:count] + allowed) & (high >= section.low[:count] - allowed)))

    def leads(self, first: Section, offset: Vector, second: Section, solver: LpSolver) -> bool:
        """Whether some point of the first section has its next state, with some input, in the second."""
        states = len(self._real_states)
        M = self._state_map(first.mode)[np.ix_(self._real_states, self._reals)]
        inputs = second.A.shape[1] - states
        arrive = np.hstack([second.A[:, :states] @ M, second.A[:, states:]])
        leave = np.hstack([first.A, np.zeros((len(first.b), inputs))])
        A = np.vstack([leave, arrive])
        b = np.concatenate([first.b, second.b - second.A[:, :states] @ offset[self._real_states]])
        lengths = np.maximum(np.linalg.norm(A, axis=1), solver.precision.interior)
        return _greatest_slack(A, b, lengths, solver) >= -solver.precision.touch
