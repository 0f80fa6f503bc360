"""What a hybrid controller must keep to: limits of the signals, hard or softened."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, isnan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

__all__ = ["Band", "Bounds", "Limits", "Polytope", "ResolvedLimits"]

Matrix = NDArray[np.float64]
Bounds = Mapping[str, tuple[float | None, float | None]]
POLYTOPE = "terminal"
"""Name of the slack of a terminal polytope."""
DEFAULT_PRICE = 1e4
"""Price of a slack where none is given."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits on a plan, beside the declared ranges of the model, which always hold.

    ::

        ulow       <= u_k <= uhigh            k = 0..N-1
        ylow - eps <= y_k <= yhigh + eps      k = 0..N-1
        xlow - eps <= x_k <= xhigh + eps      k = 1..N
        S x_N <= T + eps

    Each softened signal has a slack ``eps >= 0`` of its own, one for the whole horizon, which adds ``rho eps^2`` to
    the cost; limits of a state, of the last state and of an output of the same name share it. (The original
    controllers share one slack among all limits; then one violated limit loosens all the others for nothing.)
    Declared ranges and limits of inputs are never softened.

    A limit of ``y_0`` is left out where no input can influence that output in the same step: it would only make the
    problem infeasible for a reason that no controller can mend. The message of the move says when such an output is
    outside its limit.

    Attributes
    ----------
    x, y, u : mapping of name to (low, high)
        ``None`` or an infinite number stands for no limit on that side.
    terminal : mapping of state name to (low, high), or a pair (S, T), optional
        Further limits on the last state; S has one column per state, T one entry per row of S.
    soft : bool or sequence of str
        False for hard limits, True to soften all limits of states, outputs and the last state, or the names of the
        signals whose limits are softened (``"terminal"`` for a terminal polytope).
    rho : float or mapping of name to float
        Price of a slack, positive and finite; a signal missing from a mapping has the price 1e4.

    Raises
    ------
    ArgumentError
        When a controller is built: unknown name, a low above a high, not a number, or a limit that leaves nothing of
        the declared range.

    Examples
    --------
    >>> limits = Limits(y={"speed": (80, 200)}, u={"brake": (0, None)}, soft=("speed",), rho=1e3)
    """

    x: Bounds = field(default_factory=dict)
    y: Bounds = field(default_factory=dict)
    u: Bounds = field(default_factory=dict)
    terminal: Bounds | tuple[ArrayLike, ArrayLike] = field(default_factory=dict)
    soft: bool | Sequence[str] = False
    rho: float | Mapping[str, float] = DEFAULT_PRICE

    def resolve(self, mld: Mld) -> ResolvedLimits:
        """Check the limits against a model and number the slacks.

        Raises
        ------
        ArgumentError
            See the class.
        """
        terminal = self.terminal if isinstance(self.terminal, Mapping) else {}
        bands = [
            *_bands(self.x, mld.x, "x"),
            *_bands(self.y, mld.y, "y"),
            *_bands(self.u, mld.u, "u"),
            *_bands(terminal, mld.x, "terminal"),
        ]
        polytope = None if isinstance(self.terminal, Mapping) else _polytope(self.terminal, mld.nx)
        slacks = _softened(self.soft, bands, polytope is not None)
        return ResolvedLimits(tuple(bands), polytope, slacks, _prices(self.rho, slacks))


@dataclass(frozen=True, slots=True)
class Band:
    """Limit of one signal.

    Attributes
    ----------
    group : str
        ``"x"``, ``"y"``, ``"u"`` or ``"terminal"``.
    column : int
        Index of the signal in its vector.
    name : str
    low, high : float
    """

    group: str
    column: int
    name: str
    low: float
    high: float


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
    """

    bands: tuple[Band, ...]
    polytope: Polytope | None
    slacks: tuple[str, ...]
    rho: Matrix

    def slack_of(self, band: Band) -> int | None:
        """Index of the slack that softens a limit, None for a hard one."""
        soft = band.group != "u" and band.name in self.slacks
        return self.slacks.index(band.name) if soft else None

    @property
    def polytope_slack(self) -> int | None:
        """Index of the slack of the terminal polytope, None when it is hard."""
        return self.slacks.index(POLYTOPE) if POLYTOPE in self.slacks and self.polytope is not None else None


def _bands(bounds: Bounds, variables: Sequence[Variable], group: str) -> list[Band]:
    names = [v.name for v in variables]
    if not isinstance(bounds, Mapping):
        raise ArgumentError(f"limits {group} is {bounds!r}: a mapping of names to (low, high) was expected")
    unknown = [str(name) for name in bounds if name not in names]
    if unknown:
        raise ArgumentError(
            f"limits {group}: there is no signal named {', '.join(unknown)}; expected {', '.join(names) or '(none)'}"
        )
    return [_band(bounds[v.name], v, column, group) for column, v in enumerate(variables) if v.name in bounds]


def _band(bounds: tuple[float | None, float | None], variable: Variable, column: int, group: str) -> Band:
    what = f"limit {group} of {variable.name}"
    low, high = _ends(bounds, what)
    if low > high:
        raise ArgumentError(f"{what} is [{low:g}, {high:g}]: a low end that is not above the high end was expected")
    if group != "y" and (low > variable.high or high < variable.low):
        raise ArgumentError(
            f"{what} is [{low:g}, {high:g}]: it has no number in common with the declared range "
            f"[{variable.low:g}, {variable.high:g}]"
        )
    return Band(group, column, variable.name, low, high)


def _ends(bounds: tuple[float | None, float | None], what: str) -> tuple[float, float]:
    try:
        low, high = bounds
        ends = -inf if low is None else float(low), inf if high is None else float(high)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {bounds!r}: a pair (low, high) of numbers or None was expected") from None
    if isnan(ends[0]) or isnan(ends[1]):
        raise ArgumentError(f"{what} is {bounds!r}: numbers were expected, NaN was found")
    if ends[0] == inf or ends[1] == -inf:
        raise ArgumentError(f"{what} is {bounds!r}: no number satisfies it")
    return ends


def _polytope(pair: tuple[ArrayLike, ArrayLike], nx: int) -> Polytope:
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


def _softened(soft: bool | Sequence[str], bands: Sequence[Band], has_polytope: bool) -> tuple[str, ...]:
    possible = dict.fromkeys(band.name for band in bands if band.group != "u")
    if has_polytope:
        possible[POLYTOPE] = None
    if isinstance(soft, bool):
        return tuple(possible) if soft else ()
    wanted = (soft,) if isinstance(soft, str) else soft
    if not isinstance(wanted, Iterable):
        raise ArgumentError(f"soft is {soft!r}: True, False or names of signals were expected")
    wanted = tuple(wanted)
    unknown = [str(name) for name in wanted if name not in possible]
    if unknown:
        raise ArgumentError(
            f"soft names {', '.join(unknown)}, which has no limit that can be softened; those that can be: "
            f"{', '.join(possible) or '(none)'}"
        )
    return tuple(name for name in possible if name in wanted)


def _prices(rho: float | Mapping[str, float], slacks: tuple[str, ...]) -> Matrix:
    if not isinstance(rho, Mapping):
        return np.full(len(slacks), _price(rho, "rho"))
    unknown = [str(name) for name in rho if name not in slacks]
    if unknown:
        raise ArgumentError(
            f"rho names {', '.join(unknown)}, which is not softened; softened: {', '.join(slacks) or '(none)'}"
        )
    return np.array([_price(rho.get(name, DEFAULT_PRICE), f"rho of {name}") for name in slacks], dtype=np.float64)


def _price(value: float, what: str) -> float:
    try:
        price = float(value)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {value!r}: a number was expected") from None
    if not (np.isfinite(price) and price > 0):
        raise ArgumentError(
            f"{what} is {price:g}: a positive finite number was expected (use soft=False for hard limits)"
        )
    return price
