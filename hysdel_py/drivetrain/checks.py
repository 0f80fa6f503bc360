"""Checks of the numbers and signals of components."""

from __future__ import annotations

from math import isfinite
from typing import Any

from hysdel_py.drivetrain.signals import as_signal
from hysdel_py.errors import ArgumentError

__all__ = ["check_number", "set_signal"]


def check_number(component: Any, name: str, low: float, *, open_end: bool = False) -> None:
    """Check a number of a component against its lower end, which may be excluded."""
    value = getattr(component, name)
    words = f"above {low:g}" if open_end else f"{low:g} or more"
    good = isinstance(value, int | float) and isfinite(value) and (value > low if open_end else value >= low)
    if not good:
        raise ArgumentError(f"{type(component).__name__} {component.name}: {name} is {value!r}, {words} was expected")


def set_signal(component: Any, name: str) -> None:
    """Turn what was given for a signal into one."""
    given = getattr(component, name)
    object.__setattr__(component, name, as_signal(given, f"{name} of {type(component).__name__} {component.name}"))
