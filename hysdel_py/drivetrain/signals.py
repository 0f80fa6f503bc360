"""Inputs over time: constants, piecewise linear tables, and functions.

A table may jump: two knots with the same time are the values before and after. Integration between two knots has to see
the limits from inside, which is why schemes ask for a `Stretch` and not for single values there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["Function", "PiecewiseLinear", "Signal", "SignalLike", "as_signal", "knots_between", "sample"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PiecewiseLinear:
    """A signal given by knots, with straight lines between them and constant values outside.

    Parameters
    ----------
    times : sequence of float
        Times [s] in ascending order; a time that occurs twice is a jump.
    values : sequence of float
        One value for each time.

    Raises
    ------
    ArgumentError
        No knots, different lengths, a time that falls or occurs three times, or a number that is not finite.

    Examples
    --------
    >>> import hysdel_py as hys
    >>> ramp = hys.PiecewiseLinear((0, 1, 1, 2), (0, 10, 5, 5))
    >>> ramp.value(0.5), ramp.value(1.0)
    (5.0, 5.0)
    """

    times: Vector
    values: Vector

    def __init__(self, times: ArrayLike, values: ArrayLike) -> None:
        t, v = _finite_vector(times, "times"), _finite_vector(values, "values")
        if t.size == 0 or t.shape != v.shape:
            raise ArgumentError(f"a signal has {t.size} times and {v.size} values: one or more of each were expected")
        if np.any(np.diff(t) < 0):
            at = int(np.flatnonzero(np.diff(t) < 0)[0])
            raise ArgumentError(f"times of a signal fall from {t[at]:g} to {t[at + 1]:g}: ascending ones were expected")
        if t.size > 2 and np.any(t[2:] == t[:-2]):
            raise ArgumentError("a time of a signal occurs more than twice: a jump has one value before and one after")
        for name, array in (("times", t), ("values", v)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def value(self, t: float) -> float:
        """Value at a time; behind a jump at the jump itself."""
        return float(self.line(t)[0])

    def slope(self, t: float) -> float:
        """Slope to the right of a time."""
        return float(self.line(t)[1])

    def line(self, t: float) -> tuple[float, float]:
        """Value and slope to the right of a time."""
        times, values = self.times, self.values
        k = int(np.searchsorted(times, t, side="right")) - 1
        if k < 0:
            return float(values[0]), 0.0
        if k >= times.size - 1:
            return float(values[-1]), 0.0
        slope = (values[k + 1] - values[k]) / (times[k + 1] - times[k])
        return float(values[k] + slope * (t - times[k])), float(slope)

    def sample(self, t: Vector) -> Vector:
        """Values at many times, as :meth:`value` gives them."""
        times, values = self.times, self.values
        if times.size == 1:
            return np.full(t.shape, values[0])
        k = np.clip(np.searchsorted(times, t, side="right") - 1, 0, times.size - 2)
        width = times[k + 1] - times[k]
        share = np.clip((t - times[k]) / np.where(width > 0, width, 1.0), 0.0, 1.0)
        inside = values[k] + share * (values[k + 1] - values[k])
        return np.where(t < times[0], values[0], np.where(t >= times[-1], values[-1], inside))

    @property
    def knots(self) -> Vector:
        """Times at which value or slope may jump."""
        return np.unique(self.times) if self.times.size > 1 else np.empty(0)


@dataclass(frozen=True, eq=False, slots=True)
class Function:
    """A signal given by a function of time [s], assumed smooth between the times in `knots`."""

    call: Callable[[float], float]
    knots: Vector = field(default_factory=lambda: np.empty(0))

    def value(self, t: float) -> float:
        """Value at a time.

        Raises
        ------
        ArgumentError
            The function gives no finite number.
        """
        try:
            found = float(self.call(t))
        except (TypeError, ValueError) as error:
            raise ArgumentError(f"a function of time fails at t = {t:g}: {error}: one number was expected") from error
        if not np.isfinite(found):
            raise ArgumentError(f"a function of time gives {found} at t = {t:g}: a finite number was expected")
        return found

    def sample(self, t: Vector) -> Vector:
        """Values at many times."""
        return np.array([self.value(float(at)) for at in t.ravel()]).reshape(t.shape)


Signal = PiecewiseLinear | Function
SignalLike = float | Signal | Callable[[float], float] | Sequence[tuple[float, float]]


def as_signal(given: SignalLike, what: str) -> Signal:
    """A signal from a number, a sequence of (time, value) pairs, a signal, or a function of time.

    Raises
    ------
    ArgumentError
        It is none of these; `what` is the word for messages.
    """
    if isinstance(given, PiecewiseLinear | Function):
        return given
    if callable(given):
        return Function(given)
    try:
        if isinstance(given, Real):
            return PiecewiseLinear([0.0], [float(given)])
        return _from_pairs(given)
    except ArgumentError as error:
        raise ArgumentError(f"{what}: {error}") from None


def _from_pairs(given: Any) -> PiecewiseLinear:
    try:
        table = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        table = np.empty(0)
    if table.ndim != 2 or table.shape[1] != 2:
        raise ArgumentError(
            f"{given!r} is no signal: a number, pairs (time, value), a PiecewiseLinear or a function was expected"
        )
    return PiecewiseLinear(table[:, 0], table[:, 1])


def _finite_vector(given: ArrayLike, what: str) -> Vector:
    try:
        vector = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} of a signal are {given!r}: numbers were expected") from None
    if vector.ndim != 1:
        raise ArgumentError(f"{what} of a signal have shape {vector.shape}: a vector was expected")
    if not np.all(np.isfinite(vector)):
        raise ArgumentError(
            f"{what} of a signal contain {vector[~np.isfinite(vector)][0]}: finite numbers were expected"
        )
    return vector


def sample(signals: Sequence[Signal], t: Vector) -> Vector:
    """Values of all signals: shape of `t` with one more axis for the signals."""
    if not signals:
        return np.zeros((*t.shape, 0))
    return np.stack([signal.sample(t) for signal in signals], axis=-1)


def knots_between(signals: Sequence[Signal], start: float, end: float) -> list[float]:
    """Times strictly inside an interval at which an input has a kink or a jump, ascending."""
    every = np.unique(np.concatenate([np.empty(0), *(signal.knots for signal in signals)]))
    return [float(t) for t in every if start < t < end]
