"""What the options of schemes may be."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from hysdel_py.drivetrain.checks import is_number
from hysdel_py.errors import ArgumentError

__all__ = ["DECOMPOSITIONS", "INTEGRATORS", "LCP_SOLVERS", "VARIABLE_INTEGRATORS", "check_options", "check_theta"]

INTEGRATORS = ("euler", "rk3", "rk4")
VARIABLE_INTEGRATORS = ("dop853", "rk45", "radau")
DECOMPOSITIONS = ("leine-nijmeijer", "pfeiffer-glocker", "boxed")
LCP_SOLVERS = ("auto", "enumerative", "lemke", "pgs", "newton")


def check_options(scheme: Any, **rules: tuple[Any, ...] | float) -> None:
    """Check options: a tuple lists what is allowed, a number is what they have to exceed; a default of None passes."""
    defaults = {field.name: field.default for field in fields(scheme)}
    for name, rule in rules.items():
        value = getattr(scheme, name)
        if value is None and defaults[name] is None:
            continue
        if isinstance(rule, tuple):
            good, words = value in rule, "one of " + ", ".join(map(str, rule))
        else:
            good = is_number(value) and value > rule
            words = f"a number above {rule:g}"
        if not good:
            raise ArgumentError(f"{type(scheme).__name__}: {name} is {value!r}, {words} was expected")


def check_theta(scheme: Any) -> None:
    """Check the weight of the new state."""
    if scheme.theta is not None and not (is_number(scheme.theta) and 0.5 <= scheme.theta <= 1.0):
        raise ArgumentError(f"{type(scheme).__name__}: theta is {scheme.theta!r}, a number in [0.5, 1] was expected")
