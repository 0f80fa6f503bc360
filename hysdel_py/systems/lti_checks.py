"""Checks of what a linear system is built from."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Kind, Type, Variable

__all__ = ["checked_sample_time", "matrix", "named_variables", "numbers", "outputs_named"]

Matrix = NDArray[np.float64]


def checked_sample_time(ts: Any) -> float:
    """Return a sample time that is a positive finite number.

    Raises
    ------
    ArgumentError
    """
    if isinstance(ts, bool) or not isinstance(ts, Real) or not 0.0 < float(ts) < np.inf:
        raise ArgumentError(f"ts is {ts!r}: a positive number was expected")
    return float(ts)


def matrix(value: Any, what: str, rows: int | None = None, columns: int | None = None) -> Matrix:
    """Return a matrix of as many rows or columns as A has; a vector is one column of B and one row of C."""
    try:
        matrix = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {value!r}: a matrix of numbers was expected") from None
    if matrix.ndim == 0:
        matrix = matrix.reshape(1, 1)
    if matrix.ndim == 1:
        matrix = matrix[:, None] if rows is not None else matrix[None]
    if matrix.ndim != 2 or (rows is not None and len(matrix) != rows):
        expected = "a matrix was expected" if rows is None else f"a matrix of {rows} rows was expected, as A has {rows}"
        raise ArgumentError(f"{what} has shape {matrix.shape}: {expected}")
    if columns is not None and matrix.shape[1] != columns:
        raise ArgumentError(f"{what} has shape {matrix.shape}: {columns} columns were expected, as A has {columns}")
    return matrix


def numbers(value: Any, what: str, shape: tuple[int, ...]) -> Matrix:
    """Return a read-only copy of the expected shape; zeros for what was not given."""
    try:
        array = np.zeros(shape) if value is None else np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {value!r}: numbers of the shape {shape} were expected") from None
    if array.size == 1 and shape in ((1,), (1, 1)):
        array = array.reshape(shape)
    if array.shape != shape:
        raise ArgumentError(f"{what} has shape {array.shape}: {shape} was expected")
    if not np.isfinite(array).all():
        raise ArgumentError(f"{what} has an entry that is not a finite number")
    array.setflags(write=False)
    return array


def named_variables(given: Any, kind: Kind, count: int) -> tuple[Variable, ...]:
    """Return the variables of one vector, numbered where they have no names."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise ArgumentError(f"{kind.value} is {given!r}: a sequence of {count} names was expected")
    entries = tuple(given) or tuple(f"{kind.value}{i + 1}" for i in range(count))
    if len(entries) != count:
        raise ArgumentError(f"{kind.value} has {len(entries)} names: {count} were expected")
    variables = tuple(_variable(entry, kind) for entry in entries)
    names = [v.name for v in variables]
    if len(set(names)) < len(names):
        raise ArgumentError(f"{kind.value} names a signal twice: {', '.join(names)}")
    return variables


def _variable(entry: Any, kind: Kind) -> Variable:
    if isinstance(entry, Variable):
        if entry.is_bool:
            raise ArgumentError(f"{entry.name} is Boolean: a linear system has real signals only")
        return entry
    if not isinstance(entry, str) or not entry.strip():
        raise ArgumentError(f"{entry!r} is no name: text such as 'speed' or 'speed [rad/s]' was expected")
    name, bracket, unit = entry.strip().partition(" [")
    return Variable(name.strip(), Type.REAL, kind, unit=unit.strip().removesuffix("]") if bracket else "")


def outputs_named(states: tuple[Variable, ...]) -> tuple[Variable, ...]:
    """Return outputs that are the states."""
    return tuple(Variable(v.name, Type.REAL, Kind.OUTPUT, unit=v.unit, description=v.description) for v in states)
