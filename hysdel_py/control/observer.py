"""A Kalman filter whose model is the affine map of the present mode.

Within one mode a hybrid system is affine, ``x+ = A x + B u + f`` and ``y = C x + D u + g``. The filter reads A and C
off the model's own step at the estimate, by differences that stay within the mode and are exact there. R. E. Kalman, "A
new approach to linear filtering and prediction problems", Journal of Basic Engineering 82, 1960.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.construction import mld_of
from hysdel_py.control.ranges import onto_range
from hysdel_py.errors import ArgumentError, SimulationError
from hysdel_py.systems.signals import as_vector

__all__ = ["KalmanObserver", "ModeMaps", "mode_maps", "variances"]

Matrix = NDArray[np.float64]
Step = Callable[[Matrix, Matrix], tuple[Matrix, Matrix, Matrix, Matrix]]
FIRST_STEP, SMALLEST_STEP = 1e-3, 1e-9
"""Differences are taken over this part of a state's range; smaller ones are tried where the mode changes."""


@dataclass(frozen=True, slots=True, eq=False)
class ModeMaps:
    """Slopes of the next state and of the output over the state, and their values, in the mode at a point."""

    A: Matrix
    C: Matrix
    x1: Matrix
    y: Matrix


class KalmanObserver:
    """Estimate the state from measured outputs.

    Parameters
    ----------
    model : Model or Mld
        Also one of :func:`~hysdel_py.control.disturbance.with_disturbances`.
    process, noise : mapping of name to number, or vector
        Variances of what disturbs each state per step (0 where not named) and of the noise of each measured output.
    x0 : array_like of shape (nx,), or mapping
        First estimate.
    variance : mapping of name to number, vector, or number
        Variances of the first estimate.
    measured : sequence of str, optional
        Outputs that are measured; all by default.

    Attributes
    ----------
    x : array of shape (nx,)
        Estimate, inside the declared ranges.
    P : array of shape (nx, nx)
        Covariance of its error; Boolean states have none: they are taken as the model gives them.
    """

    def __init__(
        self,
        model: Any,
        process: Mapping[str, float] | ArrayLike,
        noise: Mapping[str, float] | ArrayLike,
        x0: ArrayLike | Mapping[str, float],
        *,
        variance: Mapping[str, float] | ArrayLike = 1.0,
        measured: Sequence[str] | None = None,
    ) -> None:
        self.mld = mld_of(model)
        outputs = [v.name for v in self.mld.y]
        self.measured = tuple(outputs if measured is None else measured)
        unknown = [name for name in self.measured if name not in outputs]
        if unknown:
            raise ArgumentError(f"measured names {', '.join(unknown)}: outputs were expected, {', '.join(outputs)}")
        self._rows = [outputs.index(name) for name in self.measured]
        states = tuple(v.name for v in self.mld.x)
        self._real = np.array([not v.is_bool for v in self.mld.x], dtype=bool)
        self._process = np.diag(variances(process, states, "process") * self._real)
        self._noise = np.diag(variances(noise, self.measured, "noise", positive=True))
        self.P: Matrix = np.diag(variances(variance, states, "variance") * self._real)
        self.x: Matrix = as_vector(x0, self.mld.x, "state")
        self._step: Step = partial(self.mld.step, check=False)

    def correct(self, y: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] | None = None) -> Matrix:
        """Take a measurement into account and return the estimate.

        Parameters
        ----------
        y : array_like with one entry per measured output, or mapping
        u : array_like of shape (nu,), or mapping, optional
            Input of the same step, for outputs that depend on it; zeros (or the nearest allowed values) by default.
        """
        variables = tuple(self.mld.y[row] for row in self._rows)
        value = as_vector(y, variables, "output")
        maps = mode_maps(self._step, self.mld, self.x, self._input(u))
        C = maps.C[self._rows]
        S = C @ self.P @ C.T + self._noise
        gain = np.linalg.solve(S, C @ self.P).T
        self._set(self.x + gain @ (value - maps.y[self._rows]))
        joseph = np.eye(self.mld.nx) - gain @ C
        self.P = joseph @ self.P @ joseph.T + gain @ self._noise @ gain.T
        return self.x.copy()

    def predict(self, u: ArrayLike | Mapping[str, float]) -> Matrix:
        """Go one step on under an input and return the estimate."""
        maps = mode_maps(self._step, self.mld, self.x, self._input(u))
        self._set(maps.x1)
        self.P = maps.A @ self.P @ maps.A.T + self._process
        return self.x.copy()

    def _input(self, u: ArrayLike | Mapping[str, float] | None) -> Matrix:
        if u is not None:
            return as_vector(u, self.mld.u, "input")
        return np.array([min(max(0.0, v.low), v.high) for v in self.mld.u])

    def _set(self, x: Matrix) -> None:
        low, high = (np.array([getattr(v, end) for v in self.mld.x], dtype=float) for end in ("low", "high"))
        self.x = np.where(self._real, np.clip(x, low, high), np.round(x))


def mode_maps(step: Step, mld: Any, x: Matrix, u: Matrix) -> ModeMaps:
    """Read the affine maps of the mode at (x, u) off a step.

    Raises
    ------
    SimulationError
        The model has no step here, or its mode is thinner than the smallest difference that is tried.
    """
    x0, _ = onto_range(x, mld.x, np.inf)
    x1, y, d, _ = step(x0, u)
    A, C = np.zeros((len(x), len(x))), np.zeros((len(y), len(x)))
    for j, variable in enumerate(mld.x):
        if not variable.is_bool:
            moved, h = _moved(partial(_same_mode, step, u, d), x0, j, variable)
            A[:, j], C[:, j] = (moved[0] - x1) / h, (moved[1] - y) / h
    return ModeMaps(A, C, x1, y)


def _moved(
    answer: Callable[[Matrix], tuple[Matrix, Matrix] | None], x: Matrix, j: int, variable: Any
) -> tuple[tuple[Matrix, Matrix], float]:
    """Next state and output with one state moved within the mode, and by how much."""
    span = variable.high - variable.low
    h = FIRST_STEP * (span if np.isfinite(span) and span > 0 else max(1.0, abs(x[j])))
    smallest = h / FIRST_STEP * SMALLEST_STEP
    while h >= smallest:
        for signed in (h, -h):
            moved = x.copy()
            moved[j] += signed
            inside = variable.low <= moved[j] <= variable.high
            if inside and (found := answer(moved)) is not None:
                return found, signed
        h /= 10.0
    raise SimulationError((f"the mode at {variable.name} = {x[j]:g} is too thin to read its equations off",))


def _same_mode(step: Step, u: Matrix, d: Matrix, x: Matrix) -> tuple[Matrix, Matrix] | None:
    """Next state and output, None in another mode."""
    try:
        x1, y, found, _ = step(x, u)
    except SimulationError:
        return None
    return (x1, y) if np.array_equal(found, d) else None


def variances(
    given: Mapping[str, float] | ArrayLike,
    names: tuple[str, ...],
    what: str,
    *,
    positive: bool = False,
    infinite: bool = False,
) -> Matrix:
    """Check variances by name, in order, or one for all.

    Parameters
    ----------
    given : mapping of name to number, vector, or number
        A name that is left out has the variance 0, or an infinite one where `infinite` allows it.
    names : tuple of str
    what : str
        Word for messages.
    positive : bool
        Whether 0 is refused.
    infinite : bool
        Whether a variance may be infinite: nothing is known.

    Raises
    ------
    ArgumentError
        Unknown names, a wrong number, or a value that is not a variance.
    """
    if isinstance(given, Mapping):
        values = _by_name(given, names, what, np.inf if infinite else 0.0)
    else:
        values = _filled(given, names)
    least = "positive" if positive else "not negative"
    wrong = np.isnan(values).any() or (values < 0).any() or (positive and not (values > 0).all())
    if values.shape != (len(names),) or wrong or (not infinite and np.isinf(values).any()):
        raise ArgumentError(f"{what} is {given!r}: {len(names)} numbers, {least}, were expected ({', '.join(names)})")
    return values


def _by_name(given: Mapping[str, float], names: tuple[str, ...], what: str, without: float) -> Matrix:
    unknown = [name for name in given if name not in names]
    if unknown:
        raise ArgumentError(f"{what} names {', '.join(unknown)}: expected {', '.join(names)}")
    return np.array([given.get(name, without) for name in names], dtype=float)


def _filled(given: ArrayLike, names: tuple[str, ...]) -> Matrix:
    values = np.array(given, dtype=float)
    return np.full(len(names), float(values)) if values.ndim == 0 else values
