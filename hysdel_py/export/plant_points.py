"""Steps of a plant at random states and inputs, with what they violate, for programs that replay them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError, SimulationError
from hysdel_py.systems.dha import AffineRequirement, Dha, Event
from hysdel_py.systems.signals import Variable

__all__ = ["ReplayStep", "is_clear", "random_vector", "replay_steps", "violated"]

Vector = NDArray[np.float64]

_CLEAR = 1e-9
"""Events are at least so far from their thresholds, relative to the size of their terms."""

_WIDEST = 1e3
"""A range without an end ends here."""

_OVERSHOOT = 0.05
"""Share of a range by which points leave it."""

_TRIES = 20


@dataclass(frozen=True, eq=False, slots=True)
class ReplayStep:
    """One step.

    Attributes
    ----------
    x, u : arrays
    x1, y, d, z : arrays
        What :meth:`Dha.step` gives without checks.
    violated : tuple of str
        Names of status bits.
    """

    x: Vector
    u: Vector
    x1: Vector
    y: Vector
    d: Vector
    z: Vector
    violated: tuple[str, ...]


def replay_steps(dha: Dha, count: int, seed: int) -> tuple[ReplayStep, ...]:
    """Steps from random points none of which lies at a threshold; fewer where that cannot be had.

    Raises
    ------
    ArgumentError
        The count is negative.
    """
    if count < 0:
        raise ArgumentError(f"points is {count}: zero or more were expected")
    rng = np.random.default_rng(seed)
    found: list[ReplayStep] = []
    for _ in range(_TRIES * count):
        if len(found) == count:
            break
        x, u = random_vector(dha.x, rng), random_vector(dha.u, rng)
        x1, y, d, z = dha.step(x, u, check=False)
        if is_clear(dha, x, u, d, z):
            found.append(ReplayStep(x, u, x1, y, d, z, violated(dha, x, u)))
    return tuple(found)


def random_vector(variables: tuple[Variable, ...], rng: np.random.Generator) -> Vector:
    """A point within the ranges or a little outside; Booleans are 0 or 1."""
    return np.array([_random_value(v, rng) for v in variables], dtype=float)


def _random_value(variable: Variable, rng: np.random.Generator) -> float:
    if variable.is_bool:
        return float(rng.integers(2))
    low, high = max(variable.low, -_WIDEST), min(variable.high, _WIDEST)
    if low > high:  # a range beyond the widest
        low, high = (variable.low, variable.low + 1.0) if low > 0 else (variable.high - 1.0, variable.high)
    room = _OVERSHOOT * (high - low)
    return float(rng.uniform(low - room, high + room))


def violated(dha: Dha, x: Vector, u: Vector) -> tuple[str, ...]:
    """Status bits of a step."""
    try:
        dha.step(x, u)
    except SimulationError as error:
        words = {"state": "STATE_RANGE", "input": "INPUT_RANGE", "MUST": "MUST"}
        return tuple(dict.fromkeys(words[problem.split()[0]] for problem in error.problems))
    return ()


def is_clear(dha: Dha, x: Vector, u: Vector, d: Vector, z: Vector) -> bool:
    """Whether rounding cannot change an event or a requirement."""
    groups = zip((dha.x, dha.u, dha.d, dha.z), (x, u, d, z), strict=True)
    values = {v.name: float(number) for group, vector in groups for v, number in zip(group, vector, strict=True)}
    forms = [item.form for item in dha.items if isinstance(item, Event)]
    forms += [item.value for item in dha.items if isinstance(item, AffineRequirement)]
    for form in forms:
        size = abs(form.constant) + sum(abs(c * values[n]) for n, c in form.terms)
        slack = dha.tolerances.row + _CLEAR * size
        if form.terms and abs(form.value(values)) <= slack:
            return False
    return True
