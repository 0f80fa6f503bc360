"""Dha to Pwa.

Input: a Dha. Output: its modes, found by exploring its definitions in an order in which each reads what is known.
Preserved: the meaning of a step wherever the MLD form has one, that is outside the gaps of the thresholds; names, and
for each row of a region the condition behind it.

A threshold cuts the cell that is being explored, logic is evaluated, a switch takes a branch, a requirement cuts or
prunes (A. Bemporad, "Efficient conversion of mixed logical dynamical systems into an equivalent piecewise affine form",
IEEE Trans. Automatic Control 49, 2004, does the same on the MLD form).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hysdel_py.errors import SimulationError
from hysdel_py.geometry.cell import Cell, Sides
from hysdel_py.geometry.search_tree import SearchTreeBuilder, Slot
from hysdel_py.geometry.solver import LpSolver
from hysdel_py.lowering.mode_conditions import of_boolean, of_event, of_requirement
from hysdel_py.lowering.mode_loops import solutions
from hysdel_py.lowering.mode_maps import Knowledge
from hysdel_py.lowering.mode_plan import Choose, Loop, Step, decisive_booleans, plan
from hysdel_py.lowering.mode_space import Space
from hysdel_py.systems.dha import AffineRequirement, Dha, Event, LogicEquation, LogicRequirement
from hysdel_py.systems.mode import Auxiliaries, Condition, Mode
from hysdel_py.systems.pwa import Effort, Pwa

__all__ = ["MAX_MODES", "Progress", "dha_to_pwa"]

MAX_MODES = 100_000
"""Number of modes at which a search stops by default."""

Progress = Callable[[int, int, int], None]
"""Called with the modes so far, the cells that wait, and the linear programs so far."""


@dataclass(frozen=True, eq=False, slots=True)
class _Branch:
    """A part of the search that waits: the next step of the plan, what is known, the cell, its place in the tree."""

    position: int
    knowledge: Knowledge
    cell: Cell
    slot: Slot


def dha_to_pwa(
    dha: Dha, *, split_booleans: bool = False, max_modes: int = MAX_MODES, progress: Progress | None = None
) -> Pwa:
    """Find the modes of a Dha.

    Parameters
    ----------
    split_booleans : bool
        Give a value to every Boolean state and input in each mode, also to those that no region depends on.
    max_modes : int
        Stop at this number of modes; the result says that it is not complete.
    progress : callable, optional
        Called at each mode with the modes so far, the cells that wait, and the linear programs so far.

    Raises
    ------
    SimulationError
        An auxiliary is used but never defined, or an algebraic loop is singular.
    """
    if dha.undefined_but_used:
        names = dha.undefined_but_used
        raise SimulationError(tuple(f"the auxiliary variable {name} is used but never defined" for name in names))
    return _Search(dha, split_booleans=split_booleans).run(max_modes, progress)


class _Search:
    """One search: the plan, the branches that wait, and what was found."""

    def __init__(self, dha: Dha, *, split_booleans: bool) -> None:
        every = tuple(v.name for v in (*dha.x, *dha.u) if v.is_bool)
        chosen = every if split_booleans else decisive_booleans(dha)
        self._dha = dha
        self._plan = plan(dha, chosen)
        self._space = Space(dha.x, dha.u, (*every, *(v.name for v in dha.d)))
        self._solver = LpSolver()
        self._builder = SearchTreeBuilder(len(self._space.names))
        self._has_loop = any(isinstance(step, Loop) for step in self._plan)
        self._tests: list[Condition] = []
        self._dead_ends: list[Condition] = []
        self._modes: list[Mode] = []
        self._leaves: list[Auxiliaries] = []
        self._needed: dict[int, tuple[Cell, Cell]] = {}
        self._cells = 0

    def run(self, max_modes: int, progress: Progress | None) -> Pwa:
        """Explore branch after branch, the side on which a condition holds first."""
        pending = [_Branch(0, self._known_at_first(), self._space.root, None)]
        while pending and len(self._modes) < max_modes:
            branch = pending.pop()
            self._cells += 1
            if branch.position < len(self._plan):
                pending += self._explored(branch)[::-1]
                continue
            self._add_mode(branch)
            if progress is not None:
                progress(len(self._modes), len(pending), self._solver.solved)
        return self._pwa(is_complete=not pending)

    def _known_at_first(self) -> Knowledge:
        knowledge = Knowledge.of_coordinates(self._space.names)
        undefined = [v for v in (*self._dha.d, *self._dha.z) if v.name not in self._dha.definitions]
        for variable in undefined:
            if variable.is_bool:
                knowledge = knowledge.with_truth(variable.name, value=False)
            else:
                knowledge = knowledge.with_map(variable.name, knowledge.constant(0.0))
        return knowledge

    def _explored(self, branch: _Branch) -> list[_Branch]:
        """What is left of a branch after the next step of the plan."""
        step = self._plan[branch.position]
        branch = replace(branch, position=branch.position + 1)
        match step:
            case Choose(name=name):
                return self._chosen(name, branch)
            case Event():
                return self._split(step, branch)
            case Loop():
                return self._settled(step, branch)
            case AffineRequirement() | LogicRequirement():
                return self._required(step, branch)
            case _:
                return [replace(branch, knowledge=_defined(step, branch.knowledge))]

    def _chosen(self, name: str, branch: _Branch) -> list[_Branch]:
        column = self._space.boolean_columns[name]
        normal = np.zeros(len(self._space.names))
        normal[column] = -1.0
        source = of_boolean(self._space.variables[column], value=True)[1]
        slots = self._test(branch.slot, normal, 0.5, 0.0, source)
        return [
            replace(branch, knowledge=branch.knowledge.with_truth(name, value), slot=slot)
            for value, slot in zip((True, False), slots, strict=True)
        ]

    def _test(self, slot: Slot, normal: np.ndarray, offset: float, gap: float, source: Condition) -> tuple[Slot, Slot]:
        if self._has_loop:
            return None, None
        self._tests.append(source)
        return self._builder.test(slot, normal, offset, gap)

    def _split(self, event: Event, branch: _Branch) -> list[_Branch]:
        form = self._folded(event.form, branch.knowledge)
        sides = zip((True, False), self._sides(event, form, branch.cell), strict=True)
        parts = [(value, cell.minimal(self._solver)) for value, cell in sides if cell is not None]
        if not parts:
            return self._dead(branch, of_event(event))
        slots: tuple[Slot, ...] = (branch.slot,)
        if len(parts) == 2:
            slots = self._test(branch.slot, form[:-1], float(form[-1]), event.epsilon, of_event(event))
        return [
            _Branch(branch.position, branch.knowledge.with_truth(event.name, value), cell, slot)
            for (value, cell), slot in zip(parts, slots, strict=True)
        ]

    def _sides(self, event: Event, form: np.ndarray, cell: Cell) -> Sides:
        """The parts of a cell on both sides of a threshold."""
        a, c = form[self._space.reals], float(form[-1])
        if not a.any():
            return self._side(event, form, cell, holds=True), self._side(event, form, cell, holds=False)
        tags = of_event(event), of_event(event, holds=False)
        return cell.split(a, c, event.epsilon, tags, self._solver)

    def _side(self, event: Event, form: np.ndarray, cell: Cell, *, holds: bool) -> Cell | None:
        """The part of a cell on one side of a threshold."""
        a, c = form[self._space.reals], float(form[-1])
        if not a.any():
            fits = c <= self._dha.tolerances.row if holds else c >= event.epsilon - self._dha.tolerances.row
            return cell if fits else None
        sign, side = (1.0, -c) if holds else (-1.0, c - event.epsilon)
        return cell.cut(sign * a, side, of_event(event, holds=holds), self._solver)

    def _folded(self, form: object, knowledge: Knowledge) -> np.ndarray:
        return knowledge.folded(knowledge.map_of(form), self._space.boolean_columns)  # type: ignore[arg-type]

    def _settled(self, loop: Loop, branch: _Branch) -> list[_Branch]:
        """One branch for each way to close a circle of definitions."""
        branches = []
        for knowledge, events in solutions(loop, branch.knowledge):
            cell: Cell | None = branch.cell
            for event in events:
                if cell is not None:
                    form = self._folded(event.form, knowledge)
                    cell = self._side(event, form, cell, holds=bool(knowledge.truths[event.name]))
            if cell is not None:
                branches.append(_Branch(branch.position, knowledge, cell, None))
        return branches

    def _required(self, requirement: AffineRequirement | LogicRequirement, branch: _Branch) -> list[_Branch]:
        if isinstance(requirement, LogicRequirement):
            holds = requirement.value.value(branch.knowledge.truths)
            return [branch] if holds else self._dead(branch, of_requirement(requirement))
        form = self._folded(requirement.value, branch.knowledge)
        a, c = form[self._space.reals], float(form[-1])
        if a.any():
            cell = branch.cell.cut(a, -c, of_requirement(requirement), self._solver)
        else:
            cell = branch.cell if c <= self._dha.tolerances.row else None
        return self._dead(branch, of_requirement(requirement)) if cell is None else [replace(branch, cell=cell)]

    def _dead(self, branch: _Branch, cause: Condition) -> list[_Branch]:
        if not self._has_loop:
            self._builder.dead_end(branch.slot)
            self._dead_ends.append(cause)
        return []

    def _add_mode(self, branch: _Branch) -> None:
        if not self._has_loop:
            self._builder.leaf(branch.slot)
        knowledge, space = branch.knowledge, self._space
        maps = tuple([self._update(v.name, knowledge) for v in group] for group in (self._dha.x, self._dha.y))
        cell = self._minimal(branch.cell)
        index = len(self._modes)
        self._modes.append(space.mode(index, knowledge.truths, (maps[0], maps[1]), cell, self._solver.precision))
        d = [knowledge.truths[v.name] for v in self._dha.d]
        self._leaves.append(space.auxiliaries(d, [knowledge.maps[v.name] for v in self._dha.z]))

    def _update(self, name: str, knowledge: Knowledge) -> np.ndarray:
        return knowledge.value_of(self._dha.definitions.get(name))

    def _minimal(self, cell: Cell) -> Cell:
        """The cell without rows that others imply; modes that differ in Booleans alone have the same one."""
        if id(cell) not in self._needed:
            self._needed[id(cell)] = cell, cell.minimal(self._solver)
        return self._needed[id(cell)][1]

    def _pwa(self, *, is_complete: bool) -> Pwa:
        dha = self._dha
        return Pwa(
            dha.name, dha.x, dha.u, dha.y, dha.d, dha.z, tuple(self._modes),
            None if self._has_loop else self._builder.build(), tuple(self._tests), tuple(self._leaves),
            tuple(range(len(self._modes))), tuple(self._dead_ends), dha.source, is_complete,
            Effort(self._solver.solved, self._cells), dha.tolerances,
        )  # fmt: skip


def _defined(step: Step, knowledge: Knowledge) -> Knowledge:
    """What a switch, an affine equation or logic adds."""
    if isinstance(step, LogicEquation):
        return knowledge.with_truth(step.name, step.value.value(knowledge.truths))
    assert not isinstance(step, Choose | Loop | AffineRequirement | LogicRequirement)  # the caller took these
    return knowledge.with_map(step.name, knowledge.value_of(step))
