"""The problem: a sampled plant on grids, with costs, hard constraints and an end set."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.dynamic_programming.evaluation import Functions, as_plant
from hysdel_py.control.dynamic_programming.forward import ForwardSearch, search_forward
from hysdel_py.control.dynamic_programming.grids import Axis, Mesh, input_points
from hysdel_py.control.dynamic_programming.recursion import Recursion
from hysdel_py.control.dynamic_programming.refinement import Refined, refined
from hysdel_py.control.dynamic_programming.schedule import Stage, remembered
from hysdel_py.control.dynamic_programming.settings import DpSettings
from hysdel_py.control.dynamic_programming.table import FeedbackTable
from hysdel_py.errors import ArgumentError, SimulationError
from hysdel_py.systems.signals import Kind, Variable

__all__ = ["DynamicProgram"]

Matrix = NDArray[np.float64]
Progress = Callable[[int, int], Any]


@dataclass(frozen=True, eq=False)
class DynamicProgram:
    """Find inputs of least cost over a fixed number of steps.

    ::

        min  sum_k cost(x_k, u_k, x_k+1) + change_cost(u_k-1, u_k) + end_cost(x_N)
        with x_k+1 = plant(x_k, u_k), x_k on its axes, admissible(x_k, u_k, x_k+1), x_N in end_set

    All functions work on many points at once: arrays of shapes (M, nx) and (M, nu) in, an array of shape (M,) out, or
    (M, nx) from the plant. They must be importable by name where a pool of processes is used.

    Attributes
    ----------
    plant : callable ``(x, u) -> x1``, Model, Dha, Mld or Pwa
        A compiled model is stepped row by row, which is slow; rows without a step, or with a NaN, are not admissible.
    states, inputs : sequences of Axis
    stages : int
        Number N of steps.
    cost : callable ``(x, u, x1) -> (M,)``
        Infinite where forbidden.
    end_cost, end_set : callables ``(x) -> (M,)``, optional
        Cost of the last state; whether it is allowed.
    admissible : callable ``(x, u, x1) -> (M,)`` of bool, optional
        Hard constraints on states and inputs beyond the ranges of the axes.
    change_cost : callable ``(u_before, u) -> (M,)``, optional
        Cost of a change of input, infinite where the change is too large. The input applied last is then part of the
        state: without it the principle of optimality fails, and a cheap path is thrown away.
    sample_time : float
    time_varying : bool
        The functions get the stage k as one more argument.
    settings : DpSettings

    Raises
    ------
    ArgumentError
        Wrong arguments. What the functions return is checked when they are called.
    """

    plant: Any
    states: Sequence[Axis]
    inputs: Sequence[Axis]
    stages: int
    cost: Callable[..., Matrix]
    end_cost: Callable[..., Matrix] | None = None
    end_set: Callable[..., NDArray[np.bool_]] | None = None
    admissible: Callable[..., NDArray[np.bool_]] | None = None
    change_cost: Callable[..., Matrix] | None = None
    sample_time: float = 1.0
    time_varying: bool = False
    settings: DpSettings = field(default_factory=DpSettings)

    def __post_init__(self) -> None:
        for name in ("states", "inputs"):
            object.__setattr__(self, name, _axes(getattr(self, name), name))
        if isinstance(self.stages, bool) or self.stages != int(self.stages) or self.stages < 1:
            raise ArgumentError(f"stages is {self.stages}: a whole number of at least 1 was expected")
        if not (np.isfinite(self.sample_time) and self.sample_time > 0):
            raise ArgumentError(f"sample_time is {self.sample_time}: a positive number was expected")
        names = [axis.name for axis in (*self.states, *self.inputs)]
        if len(set(names)) < len(names):
            raise ArgumentError(f"names of axes are used twice: {', '.join(names)}")
        if not callable(self.cost):
            raise ArgumentError(f"cost is a {type(self.cost).__name__}: a callable (x, u, x1) was expected")

    @property
    def functions(self) -> Functions:
        """Plant, costs and constraints, with their answers checked."""
        return Functions(
            as_plant(self.plant), self.cost, self.end_cost, self.end_set, self.admissible, self.change_cost,
            len(self.states), self.time_varying,
        )  # fmt: skip

    @property
    def schedule(self) -> tuple[Stage, ...]:
        """The same grids at every stage."""
        points = input_points(self.inputs)
        before = remembered(self.functions, points, points)
        return (Stage(Mesh(tuple(self.states)), points, before),) * (self.stages + 1)

    @property
    def variables(self) -> dict[str, Any]:
        """States and inputs as variables of a system."""
        return {"x": self.x, "u": self.u}

    @property
    def x(self) -> tuple[Variable, ...]:
        """The states, named as on their axes."""
        return tuple(axis.variable(Kind.STATE) for axis in self.states)

    @property
    def u(self) -> tuple[Variable, ...]:
        """The inputs, named as on their axes."""
        return tuple(axis.variable(Kind.INPUT) for axis in self.inputs)

    def step(self, x: ArrayLike, u: ArrayLike) -> Matrix:
        """The plant at one state and input, so that a problem can be the plant of :func:`closed_loop`.

        Raises
        ------
        SimulationError
            The plant has no step here.
        ArgumentError
            The plant depends on the stage.
        """
        if self.time_varying:
            raise ArgumentError("the plant depends on the stage: give closed_loop a plant that counts its steps")
        rows = np.array(x, dtype=float)[None], np.array(u, dtype=float)[None]
        after: Matrix = np.asarray(self.functions.plant(*rows), dtype=float)[0]
        if not np.isfinite(after).all():
            raise SimulationError((f"the plant returned {after.tolist()}",))
        return after

    def memory(self) -> dict[str, int]:
        """Bytes that :meth:`backward` needs: ``table``, ``transitions`` (kept between stages) and ``work``."""
        return self._recursion(self.schedule).memory()

    def backward(self, *, executor: Executor | None = None, progress: Progress | None = None) -> FeedbackTable:
        """Backward recursion with interpolation.

        Parameters
        ----------
        executor : Executor, optional
            Anything with ``submit``; the table does not depend on it.
        progress : callable, optional
            Called with the number of stages done and of all stages.

        Returns
        -------
        FeedbackTable
            After an interruption from the keyboard, the stages that were finished.

        Raises
        ------
        ArgumentError
            A function returned something wrong, or the table needs more memory than the settings allow.
        """
        return self.backward_on(self.schedule, executor=executor, progress=progress)

    def backward_on(
        self, schedule: tuple[Stage, ...], *, executor: Executor | None = None, progress: Progress | None = None
    ) -> FeedbackTable:
        """Backward recursion on grids that differ from stage to stage."""
        recursion = self._recursion(schedule)
        values, policy, first = recursion.run(executor, progress)
        return FeedbackTable(
            schedule, values, policy, first, self.variables, self.sample_time, self.functions, self.settings
        )  # fmt: skip

    def forward(
        self,
        x0: ArrayLike,
        *,
        last_input: ArrayLike | None = None,
        snap: bool = False,
        remember_input: bool = True,
        progress: Progress | None = None,
    ) -> ForwardSearch:
        """Forward search from one state: the cheapest path into each cell that is reached.

        Parameters
        ----------
        x0 : array_like of shape (nx,)
        last_input : array_like of shape (nu,), optional
            Input before the first step; without it the first change costs nothing.
        snap : bool
            Move every reached state onto its node, as a table of the document does. Costs are then those of a rounded
            plant. Without it a cell keeps the state that the path really reaches, and costs are exact.
        remember_input : bool
            Tell paths into one cell apart by their last input where changes of input cost something. False
            reproduces the search of the document, which may throw the optimum away.
        progress : callable, optional
            Called with the number of stages done and of all stages.

        Returns
        -------
        ForwardSearch
            The plan and all end states with their costs.
        """
        return search_forward(
            self.functions, self.schedule, self.variables, self.sample_time, self.settings,
            x0, last_input, snap=snap, remember_input=remember_input, progress=progress,
        )  # fmt: skip

    def refine(
        self,
        x0: ArrayLike,
        passes: int = 3,
        *,
        last_input: ArrayLike | None = None,
        band: int = 4,
        factor: int = 2,
        executor: Executor | None = None,
        progress: Progress | None = None,
    ) -> Refined:
        """Several passes, each on a finer grid in a band around the plan of the one before.

        Parameters
        ----------
        passes : int
            Number of passes, the first one on the whole grid included.
        band : int
            Half width of the band in cells of the pass before.
        factor : int
            How many times finer each pass is.
        x0, last_input, executor, progress
            As for :meth:`forward` and :meth:`backward`.
        """
        return refined(
            self, x0, passes, last_input=last_input, band=band, factor=factor, executor=executor, progress=progress
        )  # fmt: skip

    def _recursion(self, schedule: tuple[Stage, ...]) -> Recursion:
        return Recursion(self.functions, schedule, self.settings)


def _axes(axes: Sequence[Axis], name: str) -> tuple[Axis, ...]:
    given = (axes,) if isinstance(axes, Axis) else tuple(axes)
    if not given or not all(isinstance(axis, Axis) for axis in given):
        raise ArgumentError(f"{name} is {axes!r}: one or several Axis objects were expected")
    return given
