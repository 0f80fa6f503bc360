"""The functions of a problem, called with many points at once and with their answers checked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.dynamic_programming.grids import Mesh
from hysdel_py.errors import ArgumentError, SimulationError

__all__ = ["Functions", "as_plant"]

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class RowByRow:
    """A plant that knows single steps only, applied to every row; NaN where it has no step."""

    form: Any

    def __call__(self, x: Matrix, u: Matrix) -> Matrix:
        """Next states."""
        after = np.full(x.shape, np.nan)
        for i, (state, given) in enumerate(zip(x, u, strict=True)):
            try:
                after[i] = self.form.step(state, given)[0]
            except SimulationError:
                continue
        return after


def as_plant(plant: Any) -> Callable[..., Matrix]:
    """A plant as a function of many points."""
    for form in (plant, getattr(plant, "dha", None), getattr(plant, "mld", None)):
        if hasattr(form, "step"):
            return RowByRow(form)
    if not callable(plant):
        raise ArgumentError(
            f"plant is a {type(plant).__name__}: a callable (x, u) over rows, or a Model, Dha, Mld or Pwa was expected"
        )
    return plant  # type: ignore[no-any-return]


@dataclass(frozen=True)
class Functions:
    """Plant, costs and constraints of a problem; see :class:`DynamicProgram`."""

    plant: Callable[..., Matrix]
    cost: Callable[..., Matrix]
    end_cost: Callable[..., Matrix] | None
    end_set: Callable[..., Mask] | None
    admissible: Callable[..., Mask] | None
    change_cost: Callable[..., Matrix] | None
    nx: int
    time_varying: bool

    def step(self, k: int, x: Matrix, u: Matrix, mesh: Mesh | None = None) -> tuple[Matrix, Matrix]:
        """Next states and costs of the step, infinite where the step is not admissible.

        Parameters
        ----------
        x : array of shape (M, nx)
        u : array of shape (M, nu)
        mesh : Mesh, optional
            Next states outside are not admissible either; costs are never asked for such states, and the place of the
            state before stands in for them.
        """
        after = np.asarray(self._call("plant", k, x, u), dtype=float)
        if after.shape != x.shape:
            raise ArgumentError(f"plant returned shape {after.shape} for {len(x)} states: {x.shape} was expected")
        sound = np.isfinite(after).all(axis=1) if mesh is None else mesh.holds(after)
        if not sound.all():
            after = np.where(sound[:, None], after, x)
        cost = self._numbers("cost", k, x, u, after)
        if self.admissible is not None:
            cost = np.where(self._truths("admissible", k, x, u, after), cost, np.inf)
        return after, np.where(sound, cost, np.inf)

    def end(self, x: Matrix) -> Matrix:
        """Cost of last states, infinite outside the end set."""
        cost = np.zeros(len(x)) if self.end_cost is None else self._numbers("end_cost", None, x)
        return cost if self.end_set is None else np.where(self._truths("end_set", None, x), cost, np.inf)

    def changes(self, before: Matrix | None, inputs: Matrix) -> Matrix:
        """Cost of each change of input, of shape (len(before), len(inputs)); one row of zeros without such a cost."""
        if self.change_cost is None or before is None:
            return np.zeros((1, len(inputs)))
        first, second = np.repeat(before, len(inputs), axis=0), np.tile(inputs, (len(before), 1))
        return self._numbers("change_cost", None, first, second).reshape(len(before), len(inputs))

    def _call(self, name: str, k: int | None, *arguments: Matrix) -> Any:
        more = (k,) if self.time_varying and k is not None else ()
        return getattr(self, name)(*arguments, *more)

    def _numbers(self, name: str, k: int | None, *arguments: Matrix) -> Matrix:
        count = len(arguments[0])
        values = np.asarray(self._call(name, k, *arguments), dtype=float)
        if values.shape not in ((), (count,)):
            raise ArgumentError(f"{name} returned shape {values.shape} for {count} points: {(count,)} was expected")
        if np.isnan(values).any() or np.isneginf(values).any():
            raise ArgumentError(
                f"{name} returned NaN or minus infinity: numbers, or infinity where forbidden, expected"
            )
        return np.broadcast_to(values, (count,))

    def _truths(self, name: str, k: int | None, *arguments: Matrix) -> Mask:
        count = len(arguments[0])
        values = np.asarray(self._call(name, k, *arguments))
        if values.shape not in ((), (count,)) or values.dtype != bool:
            raise ArgumentError(
                f"{name} returned {values.dtype} of shape {values.shape} for {count} points: truth values of shape "
                f"{(count,)} were expected"
            )
        return np.broadcast_to(values, (count,))
