"""What a hybrid controller must keep to: limits of the signals, hard or softened."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.bands import NEVER_SOFT, POLYTOPE, Band, Bounds, ResolvedLimits, bands_of, polytope_of
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld

__all__ = ["Limits"]

Matrix = NDArray[np.float64]
DEFAULT_PRICE = 1e4
"""Price of a slack where none is given."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits on a plan, beside the declared ranges of the model, which always hold.

    ::

        ulow       <= u_k <= uhigh            k = 0..N-1
        dulow      <= u_k - u_{k-1} <= duhigh k = 0..N-1
        ylow - eps <= y_k <= yhigh + eps      k = 0..N-1
        xlow - eps <= x_k <= xhigh + eps      k = 1..N
        S x_N <= T + eps

    Each softened signal has a slack ``eps >= 0`` of its own, one for the whole horizon, which adds ``rho eps^2`` to
    the cost (``rho eps`` with the norms 1 and infinity); limits of a state, of the last state and of an output of the
    same name share it. (The original controllers share one slack among all limits; then one violated limit loosens all
    the others for nothing.) Declared ranges and limits of inputs and of their increments are never softened.

    A limit of ``y_0`` is left out where no input can influence that output in the same step: it would only make the
    problem infeasible for a reason that no controller can mend. The message of the move says when such an output is
    outside its limit.

    Attributes
    ----------
    x, y, u : mapping of name to (low, high)
        ``None`` or an infinite number stands for no limit on that side. An end may be an array of length N or N+1
        with one value for each time 0, 1, ...; the last one goes on holding.
    terminal : mapping of name to (low, high), or a pair (S, T), optional
        Further limits on the last state and on outputs of the last state, of those outputs that no input or auxiliary
        enters; S has one column per state, T one entry per row of S.
    soft : bool or sequence of str
        False for hard limits, True to soften all limits of states, outputs and the last state, or the names of the
        signals whose limits are softened (``"terminal"`` for a terminal polytope).
    rho : float or mapping of name to float
        Price of a slack, positive and finite; a signal missing from a mapping has the price 1e4.
    du : mapping of input name to (low, high)
        Limits of the change of an input from one step to the next, at time 0 from the input that was applied last,
        which :meth:`HybridMpc.solve` then asks for.

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
    du: Bounds = field(default_factory=dict)

    def resolve(self, mld: Mld, horizon: int | None = None) -> ResolvedLimits:
        """Check the limits against a model and number the slacks; arrays need the horizon.

        Raises
        ------
        ArgumentError
            See the class.
        """
        bands = [
            *bands_of(self.x, mld.x, "x", horizon),
            *bands_of(self.y, mld.y, "y", horizon),
            *bands_of(self.u, mld.u, "u", horizon),
            *bands_of(self.du, mld.u, "du", horizon),
            *_terminal_bands(self.terminal, mld, horizon),
        ]
        polytope = None if isinstance(self.terminal, Mapping) else polytope_of(self.terminal, mld.nx)
        slacks = _softened(self.soft, bands, polytope is not None)
        return ResolvedLimits(tuple(bands), polytope, slacks, _prices(self.rho, slacks))


def _terminal_bands(terminal: Any, mld: Mld, horizon: int | None) -> list[Band]:
    """Limits of the last state, and of the outputs that it alone determines."""
    if not isinstance(terminal, Mapping):
        return []
    states = {v.name for v in mld.x}
    outputs = {name: ends for name, ends in terminal.items() if name not in states}
    _check_outputs(outputs, mld)
    rest = {name: ends for name, ends in terminal.items() if name in states}
    return [*bands_of(rest, mld.x, "terminal", horizon), *bands_of(outputs, mld.y, "final", horizon)]


def _check_outputs(names: Iterable[str], mld: Mld) -> None:
    names_of_outputs = [v.name for v in mld.y]
    for name in names:
        if name not in names_of_outputs:
            known = ", ".join(v.name for v in (*mld.x, *mld.y)) or "(none)"
            raise ArgumentError(f"limits terminal: there is no state or output named {name}; expected {known}")
        i = names_of_outputs.index(name)
        if mld.D1[i].any() or mld.D2[i].any() or mld.D3[i].any():
            raise ArgumentError(
                f"limits terminal: the output {name} at the end of the horizon depends on an input or auxiliary of "
                "that time, which the plan does not hold; limit the states, or plan one step more"
            )


def _softened(soft: bool | Sequence[str], bands: Sequence[Band], has_polytope: bool) -> tuple[str, ...]:
    possible = dict.fromkeys(band.name for band in bands if band.group not in NEVER_SOFT)
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
