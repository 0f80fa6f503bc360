"""Limits of the signals of a particular model, constant or varying over the horizon."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable

__all__ = ["Band", "Bounds", "Polytope", "ResolvedLimits", "bands_of", "polytope_of"]

Matrix = NDArray[np.float64]
End: TypeAlias = ArrayLike | None
Bounds: TypeAlias = Mapping[str, tuple[End, End]]
POLYTOPE = "terminal"
"""Name of the slack of a terminal polytope."""
SIGNAL_OF = {"x": "x", "terminal": "x", "y": "y"}
"""Group of the signal that a group of limits limits, where a measured state can settle it."""
NEVER_SOFT = ("u", "du")
"""Groups whose limits an actuator sets; they are never softened."""


@dataclass(frozen=True, slots=True)
class Band:
    """Limit of one signal.

    Attributes
    ----------
    group : str
        ``"x"``, ``"y"``, ``"u"``, ``"du"``, ``"terminal"`` (last state) or ``"final"`` (output of the last state).
    column : int
        Index of the signal in its vector.
    name : str
    lows, highs : tuple of float
        One entry for a constant limit, one per time otherwise.
    """

    group: str
    column: int
    name: str
    lows: tuple[float, ...]
    highs: tuple[float, ...]

    @property
    def low(self) -> float:
        """Least lower end over the horizon."""
        return min(self.lows)

    @property
    def high(self) -> float:
        """Greatest upper end over the horizon."""
        return max(self.highs)

    def at(self, time: int) -> tuple[float, float]:
        """Lower and upper end at a time; the last entry goes on holding."""
        return self.lows[min(time, len(self.lows) - 1)], self.highs[min(time, len(self.highs) - 1)]

    def text(self, time: int | None = None) -> str:
        """The interval in words: at a time, or over the horizon."""
        low, high = (self.low, self.high) if time is None else self.at(time)
        varying = time is None and len(self.lows) + len(self.highs) > 2
        return f"[{low:g}, {high:g}]" + (" (varying)" if varying else "")


@dataclass(frozen=True, slots=True, eq=False)
class Polytope:
    """The set of the last states with ``S x <= T``."""

    S: Matrix
    T: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class ResolvedLimits:
    """Limits of a particular model.

    Attributes
    ----------
    bands : tuple of Band
    polytope : Polytope or None
    slacks : tuple of str
        Name of each slack variable.
    rho : array, one price per slack
    settled : set of (group, column, time)
        Signals that no input of a plan can move at a time.
    allowance : float
        By how much a hard limit of these is wider, relative to the size of its ends and at least absolute.
    """

    bands: tuple[Band, ...]
    polytope: Polytope | None
    slacks: tuple[str, ...]
    rho: Matrix
    settled: frozenset[tuple[str, int, int]] = frozenset()
    allowance: float = 0.0

    def is_settled(self, band: Band, time: int) -> bool:
        """Whether a limit is hard and no input of a plan can move its signal at a time."""
        return (SIGNAL_OF.get(band.group), band.column, time) in self.settled and self.slack_of(band) is None

    def ends(self, band: Band, time: int) -> tuple[float, float]:
        """Ends of a limit at a time, with the allowance where no input can move the signal."""
        low, high = band.at(time)
        if not self.is_settled(band, time):
            return low, high
        room = self.allowance * max(1.0, *(abs(end) for end in (low, high) if isfinite(end)), 1.0)
        return low - room, high + room

    def slack_of(self, band: Band) -> int | None:
        """Index of the slack that softens a limit, None for a hard one."""
        soft = band.group not in NEVER_SOFT and band.name in self.slacks
        return self.slacks.index(band.name) if soft else None

    @property
    def polytope_slack(self) -> int | None:
        """Index of the slack of the terminal polytope, None when it is hard."""
        return self.slacks.index(POLYTOPE) if POLYTOPE in self.slacks and self.polytope is not None else None

    @property
    def limits_increments(self) -> bool:
        """Whether the change of an input is limited."""
        return any(band.group == "du" for band in self.bands)


def bands_of(bounds: Bounds, variables: Sequence[Variable], group: str, horizon: int | None) -> list[Band]:
    """Check the limits of one group and return them in the order of the model.

    Parameters
    ----------
    bounds : mapping of name to (low, high)
        Each end a number, None, or an array over the horizon.
    variables : sequence of Variable
    group : str
    horizon : int or None
        Number N of steps: arrays have N or N+1 entries. Without it arrays are refused.

    Raises
    ------
    ArgumentError
        Unknown name, a low above a high, not a number, a wrong length, or nothing in common with the declared range.
    """
    names = [v.name for v in variables]
    if not isinstance(bounds, Mapping):
        raise ArgumentError(f"limits {group} is {bounds!r}: a mapping of names to (low, high) was expected")
    unknown = [str(name) for name in bounds if name not in names]
    if unknown:
        raise ArgumentError(
            f"limits {group}: there is no signal named {', '.join(unknown)}; expected {', '.join(names) or '(none)'}"
        )
    return [_band(bounds[v.name], v, column, group, horizon) for column, v in enumerate(variables) if v.name in bounds]


def _band(bounds: tuple[End, End], variable: Variable, column: int, group: str, horizon: int | None) -> Band:
    what = f"limit {group} of {variable.name}"
    lows, highs = _ends(bounds, what, horizon)
    band = Band(group, column, variable.name, lows, highs)
    for time in range(max(len(lows), len(highs))):
        _check_ends(*band.at(time), variable, group, what)
    return band


def _check_ends(low: float, high: float, variable: Variable, group: str, what: str) -> None:
    if low > high:
        raise ArgumentError(f"{what} is [{low:g}, {high:g}]: a low end that is not above the high end was expected")
    least, most = _declared(variable, group)
    if low > most or high < least:
        raise ArgumentError(
            f"{what} is [{low:g}, {high:g}]: it has no number in common with the declared range [{least:g}, {most:g}]"
        )


def _declared(variable: Variable, group: str) -> tuple[float, float]:
    """The values that the declared range of a signal leaves."""
    if group in ("y", "final"):
        return -inf, inf
    width = variable.high - variable.low
    return (-width, width) if group == "du" else (variable.low, variable.high)


def _ends(bounds: tuple[End, End], what: str, horizon: int | None) -> tuple[tuple[float, ...], tuple[float, ...]]:
    try:
        low, high = bounds
        lows, highs = (
            np.array(without if end is None else end, dtype=float) for end, without in ((low, -inf), (high, inf))
        )
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {bounds!r}: a pair (low, high) of numbers or None was expected") from None
    for end in (lows, highs):
        _check_length(end, what, horizon)
    if np.isnan(lows).any() or np.isnan(highs).any():
        raise ArgumentError(f"{what} is {bounds!r}: numbers were expected, NaN was found")
    if np.isposinf(lows).any() or np.isneginf(highs).any():
        raise ArgumentError(f"{what} is {bounds!r}: no number satisfies it")
    return tuple(np.atleast_1d(lows).tolist()), tuple(np.atleast_1d(highs).tolist())


def _check_length(end: Matrix, what: str, horizon: int | None) -> None:
    allowed = [()] if horizon is None else [(), (horizon,), (horizon + 1,)]
    if end.shape not in allowed:
        lengths = "" if horizon is None else f" or an array of length {horizon} or {horizon + 1}"
        raise ArgumentError(f"{what} has an end of shape {end.shape}: a number{lengths} was expected")


def polytope_of(pair: tuple[ArrayLike, ArrayLike], nx: int) -> Polytope:
    """Check a terminal polytope ``(S, T)``.

    Raises
    ------
    ArgumentError
        Wrong shapes, or entries that are not numbers.
    """
    try:
        S, T = (np.array(part, dtype=float) for part in pair)
    except (TypeError, ValueError):
        raise ArgumentError("limits terminal: a mapping of names to (low, high), or a pair (S, T), expected") from None
    S, T = np.atleast_2d(S), np.atleast_1d(T)
    if S.shape[1:] != (nx,) or T.shape != (len(S),):
        raise ArgumentError(
            f"limits terminal: S has shape {S.shape} and T {T.shape}; S with {nx} columns and T with one entry per row "
            "of S were expected"
        )
    if not np.isfinite(S).all() or np.isnan(T).any() or np.isneginf(T).any():
        raise ArgumentError("limits terminal: S must be finite, and T without NaN and minus infinity")
    return Polytope(S, T)
