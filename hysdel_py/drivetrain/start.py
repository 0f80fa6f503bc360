"""The state in which a simulation begins, from what a user gives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.drivetrain.checks import is_number
from hysdel_py.drivetrain.equations import Equations
from hysdel_py.errors import ArgumentError

__all__ = ["start_state"]

Matrix = NDArray[np.float64]


def start_state(equations: Equations, start: Mapping[str, float] | ArrayLike) -> tuple[Matrix, Matrix]:
    """Speeds u and twists e from what a user gives.

    Raises
    ------
    ArgumentError
        A speed is missing, unknown, not finite, or contradicts the gears.
    """
    names = equations.names
    if not isinstance(start, Mapping):
        every = (*names.coordinates, *names.springs)
        values = _start_vector(start, every)
        sizes = {len(names.coordinates), len(every)}
        if values.ndim != 1 or values.size not in sizes:
            raise ArgumentError(
                f"start has shape {values.shape}: {len(every)} numbers were expected: {', '.join(every)}"
            )
        start = dict(zip(every, values.tolist(), strict=False))
    return _from_names(equations, dict(start))


def _start_vector(start: ArrayLike, names: Sequence[str]) -> Matrix:
    try:
        return np.asarray(start, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(
            f"start is {start!r}: a mapping of names to numbers, or {len(names)} numbers were expected: "
            + ", ".join(names)
        ) from None


def _from_names(equations: Equations, start: dict[str, float]) -> tuple[Matrix, Matrix]:
    names = equations.names
    for name, value in start.items():
        if name not in names.shafts and name not in names.springs:
            known = ", ".join((*names.coordinates, *names.springs))
            raise ArgumentError(f"start names {name}, which is no shaft and no spring: it may name {known}")
        if not is_number(value):
            raise ArgumentError(f"start of {name} is {value!r}: a finite number was expected")
    missing = [name for name in names.coordinates if name not in start]
    if missing:
        raise ArgumentError(f"start has no speed for {', '.join(missing)}: independent shafts all need one")
    u = np.array([float(start[name]) for name in names.coordinates])
    e = np.array([float(start.get(name, 0.0)) for name in names.springs])
    speeds = equations.shaft_speeds(np.zeros(1), u[None, :])[0]
    for name, speed in zip(names.shafts, speeds, strict=True):
        given = float(start.get(name, speed))
        if abs(given - speed) > 1e-9 * max(1.0, abs(speed)):
            raise ArgumentError(f"start of {name} is {given:g}, but its gears make it {speed:g}: leave it out")
    return u, e
