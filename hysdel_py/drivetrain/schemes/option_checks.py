"""What the options of schemes may be."""

from __future__ import annotations

from math import isfinite
from typing import Any

from hysdel_py.errors import ArgumentError

__all__ = ["DECOMPOSITIONS", "INTEGRATORS", "LCP_SOLVERS", "check_options", "check_theta"]

INTEGRATORS = ("euler", "rk3", "rk4")
DECOMPOSITIONS = ("leine-nijmeijer", "pfeiffer-glocker", "boxed")
LCP_SOLVERS = ("auto", "enumerative", "lemke", "pgs", "newton")


def check_options(scheme: Any, **rules: tuple[Any, ...] | float) -> None:
    """Check options: a tuple lists what is allowed, a number is what they have to exceed, None passes."""
    for name, rule in rules.items():
        value = getattr(scheme, name)
        if value is None:
            continue
        if isinstance(rule, tuple):
            good, words = value in rule, "one of " + ", ".join(map(str, rule))
        else:
            good = isinstance(value, int | float) and isfinite(value) and value > rule
            words = f"a number above {rule:g}"
        if not good:
            raise ArgumentError(f"{type(scheme).__name__}: {name} is {value!r}, {words} was expected")


def check_theta(scheme: Any) -> None:
    """Check the weight of the new state."""
    if scheme.theta is not None and not 0.5 <= scheme.theta <= 1.0:
        raise ArgumentError(f"{type(scheme).__name__}: theta is {scheme.theta}, a number in [0.5, 1] was expected")
