"""A plant and a controller in a loop."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import nan
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.control.references import Reference
from hysdel_py.control.run import PlantStep, Run, as_plant
from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES, ControlTolerances
from hysdel_py.errors import ArgumentError, Interrupted
from hysdel_py.systems.signals import Variable, as_vector
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["OnFailure", "closed_loop"]

Matrix = NDArray[np.float64]
OnFailure: TypeAlias = Literal["stop", "hold"] | Callable[[int, Matrix, Any], ArrayLike]


def closed_loop(
    plant: Any,
    controller: Any,
    x0: ArrayLike | Mapping[str, float],
    steps: int,
    ref: Reference | Callable[[int], Reference] = None,
    *,
    on_failure: OnFailure = "stop",
    stop: Callable[[int, Matrix], bool] | None = None,
    progress: Callable[[int, int], Any] | None = None,
    tolerances: ControlTolerances = DEFAULT_CONTROL_TOLERANCES,
    last_input: ArrayLike | Mapping[str, float] | None = None,
) -> Trajectory:
    """Run a controller on a plant.

    Parameters
    ----------
    plant : Model, Dha, Mld, object with ``step``, or callable
        ``step(x, u)`` returns ``(x1, y, d, z)``; a callable ``(x, u)`` returns x1, or the same four.
    controller : HybridMpc, object with ``solve``, or callable
        ``solve(x, ref)`` returns a :class:`Move`; a callable ``(x, ref)`` returns an input, a Move, or None when it
        has no input.
    x0 : array_like of shape (nx,), or mapping of name to number
        First state.
    steps : int
        Number of steps.
    ref : reference, or callable k -> reference
        Handed to the controller; see :meth:`HybridMpc.solve`.
    on_failure : "stop", "hold" or callable
        When the controller has no input: end the run there, apply the last input again (the run ends when there is
        none yet), or ask ``on_failure(k, x, move)`` for an input.
    stop : callable, optional
        ``stop(k, x)`` is asked before each step; the run ends when it is true.
    progress : callable, optional
        ``progress(k, steps)`` is called after each step.
    tolerances : ControlTolerances, optional
        A state of a modelled plant that leaves its range by no more than ``measured`` is moved onto the range.
    last_input : array_like of shape (nu,), or mapping of name to number
        Input applied before the first step; needed exactly when the controller weighs or limits increments.

    Returns
    -------
    Trajectory
        With as many steps as were made. ``messages`` says at which step and why a run ended early, and lists every
        move that was not optimal, and a last line counts the inputs that came from a fallback; ``info`` has ``cost,
        bound, gap, nodes, qps, seconds``, ``status`` (:attr:`MoveStatus.code`) and ``fallback`` (1 where the input came
        from a fallback) per step, NaN for a controller that returns plain inputs.

    Raises
    ------
    ArgumentError
        Wrong arguments, or a plant or controller that returns something else.
    Interrupted
        Ctrl-C; it carries the steps that were made.
    """
    _check_arguments(steps, on_failure)
    _check_callable(
        getattr(controller, "solve", controller), "controller", "an object with solve(x, ref), or a callable,"
    )
    for name, function in (("stop", stop), ("progress", progress)):
        if function is not None:
            _check_callable(function, name, "a callable")
    step, variables = as_plant(plant, controller, tolerances.measured)
    run = Run(_first_state(x0, variables.get("x")))
    sample_time = getattr(plant, "sample_time", getattr(controller, "sample_time", 1.0))
    orders = _Orders(steps, ref, on_failure, stop, progress, last_input)
    try:
        _make_steps(run, step, controller, orders)
    except KeyboardInterrupt:
        run.interrupt()
        raise Interrupted(run.trajectory(variables, sample_time)) from None
    run.messages += _counted(run)
    return run.trajectory(variables, sample_time)


@dataclass(frozen=True, slots=True)
class _Orders:
    """What a loop is asked to do; fields as the arguments of :func:`closed_loop`."""

    steps: int
    ref: Any
    on_failure: OnFailure
    stop: Callable[[int, Matrix], bool] | None
    progress: Callable[[int, int], Any] | None
    last_input: Any


def _make_steps(run: Run, step: PlantStep, controller: Any, orders: _Orders) -> None:
    """Ask and advance until the end, or until something ends the run."""
    ref = orders.ref
    for k in range(orders.steps):
        x = run.x[-1]
        if orders.stop is not None and orders.stop(k, x.copy()):
            run.messages.append(f"step {k}: stopped as asked")
            return
        last = run.u[-1] if run.u else orders.last_input
        answer = _ask(controller, x.copy(), ref(k) if callable(ref) else ref, last)
        u = _choose_input(run, k, answer, orders.on_failure)
        if u is None or not run.advance(k, step, u, answer.record):
            return
        if orders.progress is not None:
            orders.progress(k + 1, orders.steps)


@dataclass(frozen=True, slots=True)
class _Answer:
    """What the controller said: an input or None, the move where it returns moves, and its time."""

    u: ArrayLike | None
    move: Move | None
    seconds: float

    @property
    def record(self) -> tuple[float, ...]:
        """The entries of :data:`~hysdel_py.control.run.RECORDED`."""
        if self.move is None:
            return (nan, nan, nan, nan, nan, self.seconds, nan, nan)
        m = self.move
        numbers = m.cost, m.bound, m.gap, float(m.nodes), float(m.qps), self.seconds, float(m.status.code)
        return *numbers, float(m.status is MoveStatus.FALLBACK)

    @property
    def message(self) -> str:
        """Why the move is not optimal, empty when it is."""
        if self.move is None:
            return "" if self.u is not None else "the controller returned no input"
        return "" if self.move.status is MoveStatus.OPTIMAL else self.move.message


def _counted(run: Run) -> list[str]:
    """A line that counts the inputs of a fallback, if there were any."""
    count = sum(record[-1] == 1.0 for record in run.records)
    return [f"{count} of {len(run.records)} inputs came from the fallback"] if count else []


def _ask(controller: Any, x: Matrix, ref: Reference, last: Any) -> _Answer:
    ask = getattr(controller, "solve", controller)
    more = {"last_input": last} if getattr(controller, "uses_last_input", False) else {}
    begin = time.perf_counter()
    answer = ask(x, ref, **more)
    seconds = time.perf_counter() - begin
    if isinstance(answer, Move):
        return _Answer(answer.u, answer, seconds)
    return _Answer(answer, None, seconds)


def _choose_input(run: Run, k: int, answer: _Answer, on_failure: OnFailure) -> Matrix | None:
    """Return the input to apply; None ends the run. Every departure from an optimal move leaves a message."""
    if answer.u is not None:
        if answer.message:
            run.messages.append(f"step {k}: {answer.message}")
        return _as_input(answer.u, "the controller")
    if callable(on_failure):
        run.messages.append(f"step {k}: {answer.message}; on_failure chose the input")
        return _as_input(on_failure(k, run.x[-1].copy(), answer.move), "on_failure")
    if on_failure == "hold" and run.u:
        run.messages.append(f"step {k}: {answer.message}; the last input is held")
        return run.u[-1]
    run.messages.append(f"step {k}: stopped, {answer.message}")
    return None


def _as_input(value: ArrayLike, giver: str) -> Matrix:
    try:
        u = np.atleast_1d(np.array(value, dtype=float))
    except (TypeError, ValueError):
        raise ArgumentError(f"{giver} returned {value!r}: an input vector was expected") from None
    if u.ndim != 1 or not np.isfinite(u).all():
        raise ArgumentError(f"{giver} returned {value!r}: a vector of finite numbers was expected")
    return u


def _first_state(x0: ArrayLike | Mapping[str, float], variables: tuple[Variable, ...] | None) -> Matrix:
    if variables is not None:
        return as_vector(x0, variables, "state")
    if isinstance(x0, Mapping):
        raise ArgumentError("x0 is a mapping, but neither plant nor controller names the states: numbers were expected")
    return _as_input(x0, "x0")


def _check_callable(value: Any, name: str, expected: str) -> None:
    if not callable(value):
        raise ArgumentError(f"{name} is a {type(value).__name__}: {expected} was expected")


def _check_arguments(steps: int, on_failure: OnFailure) -> None:
    if isinstance(steps, bool) or not isinstance(steps, int | np.integer) or steps < 0:
        raise ArgumentError(f"steps is {steps!r}: a whole number of at least 0 was expected")
    if not callable(on_failure) and on_failure not in ("stop", "hold"):
        raise ArgumentError(f'on_failure is {on_failure!r}: "stop", "hold" or a callable was expected')
