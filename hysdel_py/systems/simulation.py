"""Runs of any system that can step."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from numbers import Real
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError, Interrupted, SimulationError
from hysdel_py.systems.signals import Variable, as_vector
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["MAX_STEPS", "Steppable", "assemble_trajectory", "simulate"]

MAX_STEPS = 10_000_000
"""Longest run that is tried."""

Vector = NDArray[np.float64]
Step = tuple[Vector, Vector, Vector, Vector]


class Steppable(Protocol):
    """A sampled system with named variables."""

    @property
    def x(self) -> tuple[Variable, ...]: ...  # noqa: D102 -- named like the vectors of the form
    @property
    def u(self) -> tuple[Variable, ...]: ...  # noqa: D102
    @property
    def y(self) -> tuple[Variable, ...]: ...  # noqa: D102
    @property
    def d(self) -> tuple[Variable, ...]: ...  # noqa: D102
    @property
    def z(self) -> tuple[Variable, ...]: ...  # noqa: D102

    def step(
        self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = ..., *, check: bool = ...
    ) -> Step:
        """Next state, output and auxiliaries."""
        ...


def simulate(
    system: Steppable,
    x0: ArrayLike | Mapping[str, float],
    inputs: ArrayLike,
    *,
    ts: float = 1.0,
    check: bool = True,
    progress: Callable[[int, int], Any] | None = None,
) -> Trajectory:
    """Run a system from a state under a sequence of inputs.

    Parameters
    ----------
    system : Dha or Mld
    x0 : array_like of shape (nx,), or mapping
    inputs : array_like of shape (N, nu), or int
        One row per step; a number of steps for a system without inputs.
    ts : float
        Sample time, only for the time axis.
    check : bool
        Whether leaving a declared range or violating a requirement is an error.
    progress : callable, optional
        ``progress(k, steps)`` is called after each step.

    Raises
    ------
    ArgumentError
        Wrong shapes or values.
    SimulationError
        A step is not defined; the message starts with the number of the step.
    Interrupted
        Ctrl-C; it carries the steps that were made.
    """
    if not (isinstance(ts, Real) and 0.0 < ts < np.inf):
        raise ArgumentError(f"ts is {ts!r}: a positive number was expected")
    state = as_vector(x0, system.x, "state")
    controls = _input_sequence(inputs, system.u)
    steps: list[Step] = []
    try:
        for step in _steps(system, state, controls, check=check):
            steps.append(step)
            if progress is not None:
                progress(len(steps), len(controls))
    except KeyboardInterrupt:
        partial = assemble_trajectory(system, state, controls, steps, ts=ts)
        raise Interrupted(replace(partial, messages=(f"step {len(steps)}: interrupted",))) from None
    return assemble_trajectory(system, state, controls, steps, ts=ts)


def _steps(system: Steppable, state: Vector, controls: Vector, *, check: bool) -> Iterator[Step]:
    """One step after the other; errors name theirs."""
    for k, control in enumerate(controls):
        try:
            step = system.step(state, control, check=check)
        except SimulationError as error:
            raise SimulationError(tuple(f"step {k}: {problem}" for problem in error.problems)) from None
        except ArgumentError as error:
            raise ArgumentError(f"step {k}: {error}") from None
        yield step
        state = step[0]


def _input_sequence(inputs: ArrayLike, variables: tuple[Variable, ...]) -> Vector:
    if isinstance(inputs, int | np.integer) and not variables:
        if not 0 <= inputs <= MAX_STEPS:
            raise ArgumentError(f"the number of steps is {inputs}: 0 to {MAX_STEPS} were expected")
        return np.zeros((int(inputs), 0))
    try:
        sequence = np.array(inputs, dtype=float)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"inputs must be an array of {len(variables)} columns: {error}") from None
    if sequence.ndim == 1 and len(variables) == 1:
        sequence = sequence[:, None]
    if sequence.ndim != 2 or sequence.shape[1] != len(variables):
        names = ", ".join(v.name for v in variables) or "(none)"
        raise ArgumentError(
            f"inputs has shape {sequence.shape}: one row per step and {len(variables)} columns ({names}) were expected"
        )
    return sequence


def assemble_trajectory(
    system: Steppable, x0: Vector, controls: Vector, steps: list[Step], *, ts: float = 1.0
) -> Trajectory:
    """Put the results of successive steps into a Trajectory; there may be fewer steps than controls."""
    count = len(steps)
    columns = [[step[part] for step in steps] for part in range(4)]
    x = np.array([x0, *columns[0]], dtype=float).reshape(count + 1, len(system.x))
    y, d, z = (
        np.array(column, dtype=float).reshape(count, len(group))
        for column, group in zip(columns[1:], (system.y, system.d, system.z), strict=True)
    )
    u = np.array(controls[:count], dtype=float).reshape(count, len(system.u))
    variables = {"x": system.x, "u": system.u, "y": system.y, "d": system.d, "z": system.z}
    return Trajectory(ts * np.arange(count + 1, dtype=float), x, u, y, d, z, variables)
