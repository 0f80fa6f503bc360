"""Feedback tables: values and best inputs at every node of every stage, and what can be asked of them."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.dynamic_programming.evaluation import Functions
from hysdel_py.control.dynamic_programming.plan import DpPlan, DpStatus, checked_vector, replayed
from hysdel_py.control.dynamic_programming.recursion import NO_INPUT, interpolated
from hysdel_py.control.dynamic_programming.schedule import Stage
from hysdel_py.control.dynamic_programming.settings import DpSettings
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable

if TYPE_CHECKING:
    from hysdel_py.control.dynamic_programming.controller import TableController

__all__ = ["FeedbackTable", "TableLaw"]

Matrix = NDArray[np.float64]
TableLaw: TypeAlias = Literal["lookahead", "interpolate", "nearest"]


@dataclass(frozen=True, eq=False)
class FeedbackTable:
    """Answer of the backward recursion.

    Attributes
    ----------
    schedule : tuple of Stage
        Grids of the N+1 stages.
    values : list of arrays of shape (nodes, columns)
        Cost to go, infinite where there is no way to the end set; one column for each input before.
    policy : list of integer arrays of the same shapes
        Index of the best input, -1 where there is none; N of them.
    first : int
        First stage that was finished; 0 unless the run was interrupted.
    variables : mapping of "x", "u" to tuples of Variable
    sample_time : float
    functions : Functions or None
        None in a table that was read from a file: then without ``lookahead`` and :meth:`plan`.
    settings : DpSettings
    """

    schedule: tuple[Stage, ...]
    values: list[Matrix]
    policy: list[NDArray[Any]]
    first: int
    variables: dict[str, tuple[Variable, ...]]
    sample_time: float
    functions: Functions | None
    settings: DpSettings

    @property
    def stages(self) -> int:
        """Number of steps."""
        return len(self.policy)

    @property
    def complete(self) -> bool:
        """Whether all stages were finished."""
        return self.first == 0

    def value(self, x: ArrayLike, stage: int = 0, last_input: ArrayLike | None = None) -> float:
        """Cost to go from a state, infinite where there is no way."""
        return self.ahead(stage, self._state(x), self._input(last_input))[1]

    def __call__(
        self,
        x: ArrayLike,
        stage: int = 0,
        last_input: ArrayLike | None = None,
        law: TableLaw | None = None,
    ) -> Matrix | None:
        """Input at a state, or None where the table has none.

        Parameters
        ----------
        x : array_like of shape (nx,)
        stage : int
        last_input : array_like of shape (nu,), optional
            Needed by "interpolate" and "nearest" where changes of input cost something.
        law : {"lookahead", "interpolate", "nearest"}, optional
            "lookahead", the default where the plant is known, tries all inputs on the plant and takes the best by the
            cost to go after the step. "interpolate" mixes the stored inputs of the corners of the cell; it needs no
            plant and is what the C code does. "nearest" takes the stored input of the nearest node.
        """
        chosen = law or ("lookahead" if self.functions is not None else "interpolate")
        self._require_stage(stage)
        state, before = self._state(x), self._input(last_input)
        match chosen:
            case "lookahead":
                return self.ahead(stage, state, before)[0]
            case "interpolate" | "nearest":
                return self._stored(stage, state, before, chosen)
            case _:
                raise ArgumentError(f'law is {law!r}: "lookahead", "interpolate" or "nearest" was expected')

    def ahead(self, stage: int, x: Matrix, before: Matrix | None) -> tuple[Matrix | None, float]:
        """Best input and its cost by one step of the plant and the cost to go after it."""
        functions = self._known_functions()
        self._require_stage(stage)
        here, following = self.schedule[stage], self.schedule[stage + 1]
        inputs = here.inputs
        after, cost = functions.step(stage, np.repeat(x[None], len(inputs), axis=0), inputs, following.mesh)
        change = functions.changes(None if before is None else before[None], inputs)[0]
        total = cost + change + self._cost_to_go(stage + 1, following, after)
        best = int(np.argmin(total))
        return (inputs[best].copy(), float(total[best])) if np.isfinite(total[best]) else (None, float("inf"))

    def _cost_to_go(self, k: int, stage: Stage, x: Matrix) -> Matrix:
        """Of the states that the inputs lead to, in the order of the inputs."""
        if k == self.stages:
            return self._known_functions().end(x)
        place = *stage.mesh.cell(x), stage.column_after()
        return interpolated(stage, self.values[k], *place, self.settings.least_weight)

    def _stored(self, k: int, x: Matrix, before: Matrix | None, law: str) -> Matrix | None:
        stage = self.schedule[k]
        if not stage.mesh.holds(x):
            return None
        base, fraction = stage.mesh.cell(x)
        column = self._column(stage, before)
        places = [(int(stage.mesh.nearest(x)), 1.0)] if law == "nearest" else [
            (int(base) + offset, float(weight)) for offset, weight in stage.mesh.corners(fraction) if weight > 0
        ]  # fmt: skip
        found = [(weight, self.policy[k][node, column]) for node, weight in places]
        kept = [(weight, index) for weight, index in found if index != NO_INPUT]
        share = sum(weight for weight, _ in kept)
        if share < self.settings.least_weight:
            return None
        return np.asarray(sum(weight * stage.inputs[index] for weight, index in kept) / share)

    def _column(self, stage: Stage, before: Matrix | None) -> int:
        """Column of the nearest input before, each input measured by its range."""
        if stage.before is None:
            return 0
        if before is None:
            raise ArgumentError("last_input is missing: changes of input cost something in this table")
        known = stage.before.inputs
        width = np.maximum(np.ptp(known, axis=0), 1e-300)
        return int(stage.before.group[np.argmin(np.abs((known - before) / width).sum(axis=1))])

    def plan(self, x0: ArrayLike, last_input: ArrayLike | None = None) -> DpPlan:
        """The run from a state by "lookahead".

        Returns
        -------
        DpPlan
            ``planned`` is the cost to go of the table, ``cost`` what the run really costs.
        """
        x, before = self._state(x0), self._input(last_input)
        if not self.complete:
            return DpPlan(DpStatus.INTERRUPTED, f"interrupted: only the stages from {self.first} on are known")
        functions = self._known_functions()
        inputs, state, last = [], x, before
        planned = np.inf
        for k in range(self.stages):
            u, cost = self.ahead(k, state, last)
            planned = cost if k == 0 else planned
            if u is None:
                return DpPlan(DpStatus.INFEASIBLE, self._dead_end(k, state), planned=planned)
            inputs.append(u)
            state, last = functions.step(k, state[None], u[None])[0][0], u
        return replayed(functions, x, np.array(inputs), before, self.variables, self.sample_time, planned)

    def _dead_end(self, k: int, x: Matrix) -> str:
        named = ", ".join(f"{v.name} = {value:.6g}" for v, value in zip(self.variables["x"], x, strict=True))
        cause = "the first state" if k == 0 else f"the state of stage {k}"
        return (
            f"infeasible: from {cause}, {named}, no input of the grid leads into the end set within the constraints; "
            "widen the axes, take finer ones, or allow more stages"
        )

    def controller(self, law: TableLaw | None = None, *, receding: bool = False) -> TableController:
        """A controller for :func:`closed_loop`; see :class:`TableController`."""
        from hysdel_py.control.dynamic_programming.controller import TableController

        return TableController(self, law, receding=receding)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the table as an .npz file, without the functions of the problem."""
        from hysdel_py.control.dynamic_programming.table_file import save_table

        save_table(self, path)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> FeedbackTable:
        """Read a table from an .npz file."""
        from hysdel_py.control.dynamic_programming.table_file import load_table

        return load_table(path)

    def to_c(self, path: str | PathLike[str], prefix: str | None = None) -> tuple[Path, Path]:
        """Write the table as C99 with the law "interpolate"; returns source and header."""
        from hysdel_py.export.table_c import table_to_c

        return table_to_c(self, path, prefix)

    def describe(self) -> str:
        """Sizes and ranges as text."""
        axes = [
            f"  {kind} {v.label}: {v.low:g} to {v.high:g}"
            for kind, key in (("state", "x"), ("input", "u"))
            for v in self.variables[key]
        ]
        nodes = sum(stage.mesh.size for stage in self.schedule[:-1])
        return "\n".join([f"feedback table: {self.stages} stages, {nodes} nodes", *axes])

    def _state(self, x: ArrayLike) -> Matrix:
        state = checked_vector(x, self.variables["x"], "state")
        assert state is not None
        return state

    def _input(self, u: ArrayLike | None) -> Matrix | None:
        return checked_vector(u, self.variables["u"], "last input")

    def _known_functions(self) -> Functions:
        if self.functions is None:
            raise ArgumentError('a table from a file does not know the plant: use law="interpolate" or "nearest"')
        return self.functions

    def _require_stage(self, stage: int) -> None:
        if not self.first <= stage < self.stages:
            raise ArgumentError(f"stage is {stage}: one from {self.first} to {self.stages - 1} was expected")
