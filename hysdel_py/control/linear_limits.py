"""What a linear controller must keep to, and at what price it may exceed it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.bands import Band, Bounds, Polytope, bands_of, polytope_of
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.signals import Variable

__all__ = ["LinearLimits", "ResolvedLinearLimits", "Sharing"]

Matrix = NDArray[np.float64]
Sharing: TypeAlias = Literal["all", "signal", "stage"]
Ends: TypeAlias = Bounds | tuple[ArrayLike | None, ArrayLike | None]

DEFAULT_PRICE = 1e4
SHARINGS = ("all", "signal", "stage")
SOFT = ("y", "x")
"""Groups whose limits are softened; those of inputs are set by an actuator."""


@dataclass(frozen=True, slots=True)
class LinearLimits:
    """Limits on a plan of :class:`LinearMpc`.

    ::

        ulow       <= u_k <= uhigh            k = 0..Ncu
        dulow      <= u_k - u_{k-1} <= duhigh k = 0..Ncu
        ylow - eps <= y_k <= yhigh + eps      k = 1..Ncy (0..Ncy if asked for)
        xlow - eps <= x_k <= xhigh + eps      k = 1..Ncy
        S x_N <= T

    Ranges that the model declares for its inputs hold too.

    Attributes
    ----------
    u, du, y, x : mapping of name to (low, high), or a pair (low, high) of numbers or vectors
        ``None`` or an infinite number stands for no limit on that side. In a mapping, an end may be an array of length
        N or N+1 with one value for each time; the last one goes on holding.
    terminal : "invariant", mapping of state to (low, high), or a pair (S, T), optional
        Limits on the last state of a regulator, which are hard. ``"invariant"`` is the set of all states from which
        u = K x keeps the limits for ever.
    rho : float
        Price of the limits of outputs and states: ``rho eps^2`` is added to the cost. Infinite for hard limits.
    rho_linear : float
        A price ``rho_linear eps`` beside it, with which `rho` may be zero. One that is large enough keeps the limits
        exactly where that is possible.
    slack : "all", "signal" or "stage"
        What shares a slack: all limits, those of one signal, or each limit at each time has its own.
    """

    u: Ends = field(default_factory=dict)
    du: Ends = field(default_factory=dict)
    y: Ends = field(default_factory=dict)
    x: Ends = field(default_factory=dict)
    terminal: str | Bounds | tuple[ArrayLike, ArrayLike] = field(default_factory=dict)
    rho: float = DEFAULT_PRICE
    rho_linear: float = 0.0
    slack: Sharing = "all"

    def resolve(self, lti: Lti, horizon: int) -> ResolvedLinearLimits:
        """Check the limits against a model.

        Raises
        ------
        ArgumentError
            Unknown names, wrong shapes, a low above a high, or a price that is not positive.
        """
        if self.slack not in SHARINGS:
            raise ArgumentError(f"slack is {self.slack!r}: one of {', '.join(map(repr, SHARINGS))} was expected")
        groups = {"y": lti.y, "x": lti.x, "u": lti.u, "du": lti.u}
        bands = [
            band
            for group, variables in groups.items()
            for band in bands_of(_by_name(getattr(self, group), variables, group), variables, group, horizon)
        ]
        linear = _price(self.rho_linear, "rho_linear", zero=True, infinite=False)
        rho = _price(self.rho, "rho", zero=linear > 0, infinite=True)
        return ResolvedLinearLimits(
            tuple(_within_range(bands, lti)), self._polytope(lti, horizon), rho, linear, self.slack, self._invariant()
        )

    def _invariant(self) -> bool:
        if not isinstance(self.terminal, str):
            return False
        if self.terminal != "invariant":
            raise ArgumentError(f"terminal is {self.terminal!r}: 'invariant', limits of states or (S, T) were expected")
        return True

    def _polytope(self, lti: Lti, horizon: int) -> Polytope | None:
        if isinstance(self.terminal, str) or (isinstance(self.terminal, Mapping) and not self.terminal):
            return None
        if not isinstance(self.terminal, Mapping):
            return polytope_of(self.terminal, lti.nx)
        bands = bands_of(self.terminal, lti.x, "terminal", horizon)
        eye = np.eye(lti.nx)[[band.column for band in bands]]
        lows, highs = (np.array([band.at(horizon)[end] for band in bands]) for end in (0, 1))
        S, T = np.vstack([eye, -eye]), np.concatenate([highs, -lows])
        return Polytope(S[np.isfinite(T)], T[np.isfinite(T)])


@dataclass(frozen=True, slots=True, eq=False)
class ResolvedLinearLimits:
    """Limits of a particular model.

    Attributes
    ----------
    bands : tuple of Band
    terminal : Polytope or None
    rho, rho_linear : float
        Infinite `rho`: hard limits.
    slack : str
    invariant : bool
        Whether the last state shall lie in the greatest set in which the gain keeps the limits.
    """

    bands: tuple[Band, ...]
    terminal: Polytope | None
    rho: float
    rho_linear: float
    slack: Sharing
    invariant: bool

    @property
    def limits_increments(self) -> bool:
        """Whether the change of an input is limited."""
        return any(band.group == "du" for band in self.bands)

    def of(self, group: str) -> tuple[Band, ...]:
        """The limits of one group."""
        return tuple(band for band in self.bands if band.group == group)


def _by_name(ends: Any, variables: tuple[Variable, ...], group: str) -> Any:
    """Limits given as two vectors, by name."""
    if isinstance(ends, Mapping):
        return ends
    if isinstance(ends, str) or not isinstance(ends, Iterable) or len(pair := tuple(ends)) != 2:
        raise ArgumentError(
            f"limits {group} is {ends!r}: a mapping of names to (low, high) or (low, high) was expected"
        )
    lows, highs = (_vector(end, group, len(variables), without) for end, without in zip(pair, (-inf, inf), strict=True))
    return {v.name: (low, high) for v, low, high in zip(variables, lows, highs, strict=True)}


def _vector(end: Any, group: str, count: int, without: float) -> list[float]:
    try:
        array = np.array(without if end is None else end, dtype=float)
        return [float(entry) for entry in np.broadcast_to(array, (count,))]
    except (TypeError, ValueError):
        raise ArgumentError(f"limits {group}: {end!r} is no number and no vector of {count} numbers") from None


def _within_range(bands: list[Band], lti: Lti) -> list[Band]:
    """The limits, with ranges that the model declares for its inputs."""
    limited = {band.column: band for band in bands if band.group == "u"}
    inputs = []
    for column, v in enumerate(lti.u):
        given = limited.get(column, Band("u", column, v.name, (-inf,), (inf,)))
        band = Band(
            "u", column, v.name, tuple(max(v.low, a) for a in given.lows), tuple(min(v.high, b) for b in given.highs)
        )
        if np.isfinite([*band.lows, *band.highs]).any():
            inputs.append(band)
    return [*(band for band in bands if band.group != "u"), *inputs]


def _price(value: Any, what: str, *, zero: bool, infinite: bool) -> float:
    """Return a price; `zero` and `infinite` say which ends are allowed."""
    try:
        price = float(value)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {value!r}: a number was expected") from None
    if not (price > 0 or (zero and price == 0)) or (price == inf and not infinite):
        kind = "a number of at least 0" if zero else "a positive number"
        more = ", infinite for hard limits," if infinite else ", finite,"
        raise ArgumentError(f"{what} is {price:g}: {kind}{more} was expected")
    return price
