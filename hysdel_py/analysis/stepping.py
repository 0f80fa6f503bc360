"""One step of two forms at the same state and input, side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import SimulationError
from hysdel_py.systems.signals import Variable

__all__ = ["TOUCHING", "Outcome", "Stepping", "Values", "Witness", "clipped", "differing", "take_step"]

Vector = NDArray[np.float64]

TOUCHING = 1e-9
"""A value that near to an end of its range, relative to the width, is meant to be the end."""

Values = tuple[tuple[str, float], ...]


class Stepping(Protocol):
    """A form with a step."""

    @property
    def x(self) -> tuple[Variable, ...]:
        """States."""

    @property
    def y(self) -> tuple[Variable, ...]:
        """Outputs."""

    @property
    def d(self) -> tuple[Variable, ...]:
        """Boolean auxiliaries."""

    @property
    def z(self) -> tuple[Variable, ...]:
        """Real auxiliaries."""

    def step(self, x: Any, u: Any) -> tuple[Vector, Vector, Vector, Vector]:
        """Next state, output and auxiliaries."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What one form makes of a state and input.

    Attributes
    ----------
    next, outputs, auxiliaries : tuple of (name, value)
        Empty if there is no step.
    problems : tuple of str
        Why there is no step, empty if there is one.
    """

    next: Values = ()
    outputs: Values = ()
    auxiliaries: Values = ()
    problems: tuple[str, ...] = ()

    @property
    def exists(self) -> bool:
        """Whether there is a step."""
        return not self.problems

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        if self.problems:
            return {"problems": list(self.problems)}
        return {"next": dict(self.next), "outputs": dict(self.outputs), "auxiliaries": dict(self.auxiliaries)}


@dataclass(frozen=True, slots=True)
class Witness:
    """A state and input at which two forms differ, and what each makes of it.

    Attributes
    ----------
    x, u : tuple of (name, value)
    first, second : Outcome
        Of the Dha and of the other form, or of the old and of the new model.
    differing : tuple of str
        Names whose values differ, empty where one form has no step; ``name'`` is the next value of a state.
    form : str
        The second form where a Dha is compared with one, empty between models.
    """

    x: Values
    u: Values
    first: Outcome
    second: Outcome
    differing: tuple[str, ...] = ()
    form: str = ""

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "x": dict(self.x),
            "u": dict(self.u),
            "first": self.first.as_data(),
            "second": self.second.as_data(),
            "differing": list(self.differing),
            **({"form": self.form} if self.form else {}),
        }


def take_step(form: Stepping, x: Mapping[str, float], u: Mapping[str, float]) -> Outcome:
    """Step a form; what keeps it from a step is part of the outcome."""
    try:
        x1, y, d, z = form.step(x, u)
    except SimulationError as error:
        return Outcome(problems=error.problems)
    return Outcome(_named(form.x, x1), _named(form.y, y), _named((*form.d, *form.z), [*d, *z]))


def _named(variables: Sequence[Variable], values: Any) -> Values:
    return tuple((v.name, float(value)) for v, value in zip(variables, values, strict=True))


def differing(first: Outcome, second: Outcome, tolerance: Callable[[str], float]) -> tuple[str, ...]:
    """Names in both outcomes whose values differ by more than their tolerance; next states are marked by a ``'``."""
    pairs = [
        (f"{name}{mark}", value, dict(other).get(name))
        for values, other, mark in (
            (first.auxiliaries, second.auxiliaries, ""),
            (first.next, second.next, "'"),
            (first.outputs, second.outputs, ""),
        )
        for name, value in values
    ]
    return tuple(
        shown for shown, value, other in pairs
        if other is not None and abs(value - other) > tolerance(shown)
    )  # fmt: skip


def clipped(variables: Sequence[Variable], values: Mapping[str, float]) -> dict[str, float]:
    """Values of states or inputs with Booleans rounded, in their ranges, and on an end where they all but touch it."""
    return {v.name: _clipped(v, float(values[v.name])) for v in variables}


def _clipped(variable: Variable, value: float) -> float:
    if variable.is_bool:
        return float(round(value))
    width = variable.high - variable.low
    for end in (variable.low, variable.high):
        if isfinite(width) and abs(value - end) <= TOUCHING * width:
            return end
    return min(max(value, variable.low), variable.high)
