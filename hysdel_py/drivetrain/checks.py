"""Checks of numbers, signals, names and matrices."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import isfinite
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.signals import as_signal
from hysdel_py.errors import ArgumentError

__all__ = ["check_columns", "check_directions", "check_mass", "check_number", "is_number", "set_signal"]

Matrix = NDArray[np.float64]

_CLEARLY = 100.0
"""Times the least eigenvalue from which rounding cannot hide a smaller one."""


def is_number(value: Any) -> bool:
    """Whether a value is a finite real number, of Python or of numpy, and no truth value."""
    try:
        return isinstance(value, Real) and not isinstance(value, bool) and isfinite(value)
    except OverflowError:  # an integer beyond all floats
        return False


def check_number(component: Any, name: str, low: float, *, open_end: bool = False) -> None:
    """Check a number of a component against its lower end, which may be excluded."""
    value = getattr(component, name)
    words = f"above {low:g}" if open_end else f"{low:g} or more"
    good = is_number(value) and (value > low if open_end else value >= low)
    if not good:
        raise ArgumentError(f"{type(component).__name__} {component.name}: {name} is {value!r}, {words} was expected")


def set_signal(component: Any, name: str) -> None:
    """Turn what was given for a signal into one."""
    given = getattr(component, name)
    object.__setattr__(component, name, as_signal(given, f"{name} of {type(component).__name__} {component.name}"))


def check_columns(
    shafts: Sequence[str], springs: Sequence[str], contacts: Sequence[str], signals: Sequence[str]
) -> None:
    """Check that each signal of a run has a name of its own.

    Raises
    ------
    ArgumentError
        Two of them have the same, as where a shaft is named t or a contact as another one.
    """
    of_contacts = [f"{contact}.{part}" for contact in contacts for part in ("slip", "torque", "mode")]
    inputs = [f"{signal}.input" for signal in signals]
    names = Counter(["t", *shafts, *springs, *of_contacts, *inputs, "energy", "residual"])
    twice = [name for name, count in names.items() if count > 1]
    if twice:
        raise ArgumentError(f"{twice[0]} would name two signals of a run: another name was expected for a component")


def check_mass(M: Matrix, names: Sequence[str]) -> None:
    """Check that a mass matrix is symmetric and positive definite.

    Raises
    ------
    ArgumentError
        It is not; the message names a shaft that moves without inertia.
    """
    if not np.allclose(M, M.T, rtol=1e-12, atol=0.0):
        raise ArgumentError("the mass matrix is not symmetric")
    size = np.sqrt(np.maximum(np.diag(M), np.finfo(float).tiny))
    scaled = M / np.outer(size, size)  # in units in which every shaft that moves weighs 1
    least = len(M) * np.finfo(float).eps
    if _exceeds(scaled, _CLEARLY * least):
        return
    values, vectors = np.linalg.eigh(scaled)
    if len(M) and values[0] <= least:
        free = names[int(np.argmax(np.abs(vectors[:, 0])))]
        raise ArgumentError(f"shaft {free} can move without inertia: give it an Inertia or gear it to one that has")


def _exceeds(M: Matrix, least: float) -> bool:
    """Whether all eigenvalues exceed a number, at a small part of the cost of finding them."""
    try:
        np.linalg.cholesky(M - least * np.eye(len(M)))
    except np.linalg.LinAlgError:
        return False
    return True


def check_directions(W: Matrix, contacts: Sequence[str]) -> None:
    """Check that every contact has a slip."""
    still = [name for name, column in zip(contacts, W.T, strict=True) if not np.any(column)]
    if still:
        raise ArgumentError(f"contact {still[0]} has no slip: its column of W is zero")
