"""The parameters of an explicit law: which are fixed, and the polyhedron of the others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.law_signals import LawSignals
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["Box", "Fixed", "domain_of", "fixed_values", "substitution"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Interval: TypeAlias = tuple[ArrayLike, ArrayLike]
Box: TypeAlias = Mapping[str, Interval] | Interval | Polyhedron | None
Fixed: TypeAlias = Mapping[str, ArrayLike] | None


def fixed_values(fixed: Fixed, signals: LawSignals) -> dict[str, float]:
    """Numbers of the fixed parameters by name.

    Parameters
    ----------
    fixed : mapping of parameter, or of "x", "u", "r" for a whole group, to numbers
    signals : LawSignals

    Raises
    ------
    ArgumentError
        Unknown names, wrong lengths, values that are not finite, or no parameter left.
    """
    given: dict[str, float] = {}
    for key, value in _mapping({} if fixed is None else fixed, "fixed").items():
        names = _names(key, signals, "fixed")
        given |= dict(zip(names, _vector(value, len(names), f"fixed {key}"), strict=True))
    if given and len(given) == len(signals.names):
        raise ArgumentError("all parameters are fixed: nothing is left for a law to depend on; call solve instead")
    return {name: given[name] for name in signals.names if name in given}


def domain_of(box: Box, signals: LawSignals, known: Mapping[str, tuple[float, float]]) -> Polyhedron:
    """The free parameters that a law is asked for.

    Parameters
    ----------
    box : mapping, pair of vectors, Polyhedron or None
        Intervals by parameter, or by "x", "u", "r" for a whole group; two vectors over the free parameters in their
        order; or a polyhedron over them.
    signals : LawSignals
        With the fixed parameters.
    known : mapping of parameter to interval
        Ranges that the model and the limits give, for what the box leaves out.

    Raises
    ------
    ArgumentError
        Unknown names, wrong lengths, a low that is not below its high, or a parameter without an interval.
    """
    free = signals.free
    if isinstance(box, Polyhedron):
        if box.n != len(free):
            raise ArgumentError(f"box has {box.n} columns: {len(free)} were expected, {', '.join(free)}")
        return box
    intervals = _intervals(box, signals)
    missing = [name for name in free if name not in intervals and name not in known]
    if missing:
        raise ArgumentError(f"box has no interval for {', '.join(missing)}, and the model declares no range for it")
    ends = [intervals.get(name, known.get(name, (0.0, 0.0))) for name in free]
    _check_intervals(dict(zip(free, ends, strict=True)))
    low, high = (np.array(side) for side in zip(*ends, strict=True))
    return Polyhedron.box(low, high)


def substitution(signals: LawSignals) -> tuple[Matrix, Vector]:
    """``theta = chosen theta' + offset`` with theta' the free parameters."""
    given, free = dict(signals.fixed), signals.free
    chosen = np.array([[float(name == other) for other in free] for name in signals.names])
    return chosen.reshape(len(signals.names), len(free)), np.array([given.get(name, 0.0) for name in signals.names])


def _intervals(box: Any, signals: LawSignals) -> dict[str, tuple[float, float]]:
    if box is None:
        return {}
    if not isinstance(box, Mapping):
        return _two_vectors(box, signals.free)
    found: dict[str, tuple[float, float]] = {}
    for key, interval in box.items():
        names = _names(key, signals, "box")
        lows, highs = _pair(interval, f"box {key}")
        ends = [_vector(end, len(names), f"box {key}") for end in (lows, highs)]
        found |= {name: (a, b) for name, a, b in zip(names, *ends, strict=True)}
    fixed = [name for name, _ in signals.fixed]
    return {name: ends for name, ends in found.items() if name not in fixed}


def _two_vectors(box: Any, free: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    low, high = (_vector(end, len(free), "box") for end in _pair(box, "box"))
    return {name: (a, b) for name, a, b in zip(free, low, high, strict=True)}


def _names(key: Any, signals: LawSignals, what: str) -> tuple[str, ...]:
    """A parameter, or the parameters of a group."""
    if key in signals.names:
        return (key,)
    if signals.groups.get(key):
        return signals.groups[key]
    groups = ", ".join(f"{group} for {', '.join(names)}" for group, names in signals.groups.items() if names)
    raise ArgumentError(
        f"{what}: there is no parameter {key!r}; expected one of {', '.join(signals.names)}, or {groups}"
    )


def _pair(interval: Any, what: str) -> tuple[Any, Any]:
    try:
        low, high = interval
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {interval!r}: a pair (low, high) was expected") from None
    return low, high


def _vector(value: Any, count: int, what: str) -> list[float]:
    """Numbers, one for all or one each."""
    try:
        array = np.array(value, dtype=float)
        numbers = np.broadcast_to(array, (count,))
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {value!r}: a number or {count} numbers were expected") from None
    if not np.isfinite(numbers).all():
        raise ArgumentError(f"{what} is {value!r}: finite numbers were expected")
    return [float(entry) for entry in numbers]


def _mapping(value: Any, what: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise ArgumentError(f"{what} is {value!r}: a mapping of parameters to numbers was expected")
    return value


def _check_intervals(ends: Mapping[str, tuple[float, float]]) -> None:
    for name, (low, high) in ends.items():
        if not low < high:
            raise ArgumentError(
                f"box of {name} is [{low:g}, {high:g}]: a low end below the high end was expected; a parameter with "
                "one value belongs to fixed"
            )
