"""Backward recursion over stages, in chunks of states that are independent of each other.

For a node x and the input before, b,

::

    Q_k(x, u) = cost(x, u, x1) + V_k+1(x1, u)        interpolated over x1; exact end cost in the last step
    V_k(x, b) = min_u  Q_k(x, u) + change_cost(b, u)

so that a cost of changes needs no more evaluations of the plant than a problem without one. An executor evaluates the
plant; what is kept of it stays in this process, since sending it around would take longer than the minimum.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.dynamic_programming.evaluation import Functions
from hysdel_py.control.dynamic_programming.schedule import Stage
from hysdel_py.control.dynamic_programming.settings import DpSettings
from hysdel_py.errors import ArgumentError

__all__ = ["NO_INPUT", "Recursion", "interpolated", "policy_type"]

Matrix = NDArray[np.float64]
Policy = NDArray[Any]
Rows = tuple[int, int]

NO_INPUT = -1
"""Entry of a policy where no input is admissible."""


@dataclass(frozen=True, eq=False, slots=True)
class Transitions:
    """What all inputs do to some nodes: cost, and place of the next state on the grid of the next stage.

    Attributes
    ----------
    cost : array of shape (c, nU)
    base : array of int64, shape (c, nU)
    fraction : array of shape (c, nU, nx)
    end : array of shape (c, nU), or None
        Cost of the next state where it is the last one, exact and not interpolated.
    """

    cost: Matrix
    base: NDArray[np.int64]
    fraction: Matrix
    end: Matrix | None = None


@dataclass(frozen=True, eq=False)
class Recursion:
    """One backward run."""

    functions: Functions
    schedule: tuple[Stage, ...]
    settings: DpSettings

    @property
    def stages(self) -> int:
        """Number of steps."""
        return len(self.schedule) - 1

    def memory(self) -> dict[str, int]:
        """Bytes of the table, of the transitions that are kept, and of the work on one chunk."""
        table = 0
        for stage in self.schedule:
            nodes, columns = stage.shape
            table += nodes * columns * (8 + policy_type(len(stage.inputs)).itemsize)
        widest = max(self.schedule, key=lambda stage: len(stage.inputs) + stage.columns)
        per_transition = 8 * (8 + 4 * len(widest.mesh.axes))
        work = max(self.settings.chunk, len(widest.inputs)) * (per_transition + 24)
        return {"table": table, "transitions": self._kept_bytes() if self._keeps() else 0, "work": work}

    def run(
        self, executor: Executor | None = None, progress: Callable[[int, int], Any] | None = None
    ) -> tuple[list[Matrix], list[Policy], int]:
        """Values and policies of all stages, and the first stage that was finished."""
        self._require_memory()
        N = self.stages
        last = self.schedule[N]
        end = self.functions.end(last.mesh.nodes())
        values = [np.zeros((0, 0))] * N + [np.repeat(end[:, None], last.columns, axis=1)]
        policy: list[Policy] = [np.zeros((0, 0), dtype=np.int16)] * N
        first = N
        try:
            kept = list(self._built(executor, 0)) if self._keeps() and N > 1 else None
            for k in reversed(range(N)):
                values[k], policy[k] = self._stage(executor, k, values[k + 1], kept if k < N - 1 else None)
                first = k
                if progress is not None:
                    progress(N - k, N)
        except KeyboardInterrupt:
            pass
        return values, policy, first

    def _stage(
        self, executor: Executor | None, k: int, after: Matrix, kept: list[Transitions] | None
    ) -> tuple[Matrix, Policy]:
        stage, following = self.schedule[k], self.schedule[k + 1]
        value, chosen = np.empty(stage.shape), np.empty(stage.shape, dtype=policy_type(len(stage.inputs)))
        chunks = list(self._chunks(stage))
        common = (following, after, stage.changes, self.settings.least_weight)
        parts: Iterator[tuple[Matrix, Policy]]
        if kept is not None:
            parts = (swept(transitions, *common) for transitions in kept)
        else:
            is_last = k == self.stages - 1
            jobs = [(self.functions, k, stage, rows, is_last, *common) for rows in chunks]
            parts = _mapped(executor, built_and_swept, jobs)
        for (start, stop), (v, u) in zip(chunks, parts, strict=True):
            value[start:stop], chosen[start:stop] = v, u
        return value, chosen

    def _built(self, executor: Executor | None, k: int) -> Iterator[Transitions]:
        stage, following = self.schedule[k], self.schedule[k + 1]
        jobs = [(self.functions, k, stage, rows, False, following) for rows in self._chunks(stage)]
        return _mapped(executor, built, jobs)

    def _chunks(self, stage: Stage) -> Iterator[Rows]:
        size = max(1, self.settings.chunk // max(len(stage.inputs), stage.columns))
        for start in range(0, stage.mesh.size, size):
            yield start, min(start + size, stage.mesh.size)

    def _keeps(self) -> bool:
        """Whether the transitions are the same at all stages but the last, and few enough to be kept."""
        same = all(stage is self.schedule[0] for stage in self.schedule)
        return same and not self.functions.time_varying and self._kept_bytes() <= self.settings.keep

    def _kept_bytes(self) -> int:
        stage = self.schedule[0]
        return stage.mesh.size * len(stage.inputs) * 8 * (2 + len(stage.mesh.axes))

    def _require_memory(self) -> None:
        need = self.memory()
        total = sum(need.values())
        if total > self.settings.memory:
            shown = ", ".join(f"{name} {size / 1e9:.3g}" for name, size in need.items())
            raise ArgumentError(
                f"the run needs {total / 1e9:.3g} GB ({shown}), and {self.settings.memory / 1e9:.3g} GB are allowed: "
                "take coarser axes, search forward, refine in passes, or raise DpSettings(memory=...)"
            )


def policy_type(inputs: int) -> np.dtype[Any]:
    """Smallest type of integers that can count the inputs and say that there is none."""
    return np.dtype(np.int16 if inputs <= np.iinfo(np.int16).max else np.int32)


def built(functions: Functions, k: int, stage: Stage, rows: Rows, is_last: bool, following: Stage) -> Transitions:
    """Apply all inputs to some nodes."""
    x, u = stage.mesh.nodes(*rows), stage.inputs
    states, inputs = np.repeat(x, len(u), axis=0), np.tile(u, (len(x), 1))
    after, cost = functions.step(k, states, inputs, following.mesh)
    base, fraction = following.mesh.cell(after)
    shape = len(x), len(u)
    end = functions.end(after).reshape(shape) if is_last else None
    return Transitions(cost.reshape(shape), base.reshape(shape), fraction.reshape(*shape, -1), end)


def swept(
    transitions: Transitions, following: Stage, after: Matrix, changes: Matrix, least_weight: float
) -> tuple[Matrix, Policy]:
    """Values and best inputs of some nodes."""
    if transitions.end is not None:
        total = transitions.cost + transitions.end
    else:
        place = transitions.base, transitions.fraction, following.column_after()
        ahead = interpolated(following, after, *place, least_weight)
        total = transitions.cost + ahead
    return _least(total, changes)


def built_and_swept(
    functions: Functions, k: int, stage: Stage, rows: Rows, is_last: bool, *common: Any
) -> tuple[Matrix, Policy]:
    """Both at once, where transitions are not kept."""
    return swept(built(functions, k, stage, rows, is_last, common[0]), *common)


def interpolated(
    stage: Stage, values: Matrix, base: NDArray[np.int64], fraction: Matrix, column: Any, least_weight: float
) -> Matrix:
    """Values at points within cells, over the corners that have a value; infinite where there is none."""
    columns = values.shape[1]
    flat = values.ravel()
    has = np.isfinite(flat)
    some_missing = not has.all()
    finite = np.where(has, flat, 0.0)
    total, share = np.zeros(base.shape), np.zeros(base.shape)
    for offset, weight in stage.mesh.corners(fraction):
        index = (base + offset * (weight > 0)) * columns + column
        total += weight * finite[index]
        if some_missing:
            share += weight * has[index]
    if not some_missing:
        return total
    return np.where(share >= least_weight, total / np.where(share > 0, share, 1.0), np.inf)


def _least(total: Matrix, changes: Matrix) -> tuple[Matrix, Policy]:
    """Least cost over the inputs for every input before; of equal costs the first input."""
    shape = len(total), len(changes)
    value, chosen = np.empty(shape), np.empty(shape, dtype=policy_type(total.shape[1]))
    of_input = np.ascontiguousarray(total.T)
    for column, change in enumerate(changes):
        best = np.full(len(total), np.inf)
        index = np.full(len(total), NO_INPUT, dtype=chosen.dtype)
        for i in np.flatnonzero(np.isfinite(change)):
            candidate = of_input[i] + change[i]
            index[candidate < best] = i
            np.minimum(best, candidate, out=best)
        value[:, column], chosen[:, column] = best, index
    return value, chosen


def _mapped(executor: Executor | None, function: Callable[..., Any], jobs: list[tuple[Any, ...]]) -> Iterator[Any]:
    """Results in the order of the jobs."""
    if executor is None:
        return (function(*job) for job in jobs)
    futures = [executor.submit(function, *job) for job in jobs]
    return (future.result() for future in futures)
