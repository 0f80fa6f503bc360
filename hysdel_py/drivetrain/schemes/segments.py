"""Inputs between two kinks: smooth, and with the limits from inside at both ends."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Inputs
from hysdel_py.drivetrain.signals import Function, PiecewiseLinear, knots_between

__all__ = ["Segment", "segments"]

Matrix = NDArray[np.float64]

_ZERO_PRESSURE = 1e-14
"""A pressure below this share of its greatest value is zero: the contact is open."""


@dataclass(frozen=True, eq=False, slots=True)
class Segment:
    """An interval without kinks.

    Attributes
    ----------
    start, end : float
    values, slopes : arrays of shape (ns,)
        Of the piecewise linear signals at the start, seen from inside; zero for functions.
    base, rate : Inputs
        What these contribute at the start, and its derivative; a pressure below zero is kept and rises from there.
    open : bool array of shape (nc,)
        Contacts without pressure in this interval; a pressure that is a function may come at any time.
    equations : Equations
    """

    start: float
    end: float
    values: Matrix
    slopes: Matrix
    base: Inputs
    rate: Inputs
    open: NDArray[np.bool_]
    equations: Equations

    @property
    def is_linear(self) -> bool:
        """Whether all inputs are straight lines here."""
        return not self.equations.has_functions

    def at(self, t: float) -> Inputs:
        """Inputs at a time of the interval, arrays of shape (size,)."""
        if self.is_linear:
            since = t - self.start
            found = Inputs(*(a + since * b for a, b in zip(self.base, self.rate, strict=True)))
            return found._replace(pressure=np.maximum(found.pressure, 0.0))
        values = self.values + (t - self.start) * self.slopes
        for i, signal in enumerate(self.equations.signals):
            if isinstance(signal, Function):
                values[i] = signal.value(t)
        return self.equations.inputs_of(values, self.slopes)


def segments(equations: Equations, until: float) -> list[Segment]:
    """The intervals between the kinks of all inputs, and the times at which a pressure begins or ceases."""
    kinks = {*knots_between(equations.signals, 0.0, until), *_pressure_zeros(equations, until)}
    times = [0.0, *sorted(kinks), until]
    return [_segment(equations, a, b) for a, b in pairwise(times) if b > a]


def _pressure_zeros(equations: Equations, until: float) -> list[float]:
    """Where a straight piece of a pressure crosses zero: below it the contact is open."""
    found: list[float] = []
    for i in np.flatnonzero(np.any(equations.gains.pressure != 0, axis=0)):
        signal = equations.signals[i]
        if isinstance(signal, PiecewiseLinear):
            t, v = signal.times, signal.values
            for k in np.flatnonzero(v[1:] * v[:-1] < 0):
                found.append(float(t[k] - v[k] * (t[k + 1] - t[k]) / (v[k + 1] - v[k])))
    return [time for time in found if 0.0 < time < until]


def _segment(equations: Equations, a: float, b: float) -> Segment:
    lines = [s.line(a) if isinstance(s, PiecewiseLinear) else (0.0, 0.0) for s in equations.signals]
    values, slopes = np.array([v for v, _ in lines]), np.array([s for _, s in lines])
    base = equations.inputs_of(values, slopes)._replace(pressure=values @ equations.gains.pressure.T)
    rate = Inputs(
        slopes @ equations.gains.force.T,
        slopes @ equations.gains.pressure.T,
        slopes @ equations.gains.twist.T,
        slopes @ equations.gains.slip.T,
        np.zeros(len(equations.laws)),
        slopes @ equations.gains.throttle.T,
    )
    segment = Segment(a, b, values, slopes, base, rate, np.zeros(len(equations.laws), dtype=bool), equations)
    greatest = np.maximum(segment.at(a).pressure, segment.at(b).pressure)
    middle = np.maximum(segment.at(0.5 * (a + b)).pressure, greatest)
    segment.open[:] = middle <= _ZERO_PRESSURE * max(1.0, float(middle.max(initial=0.0)))
    segment.open[equations.has_function_pressure] = False
    return segment
