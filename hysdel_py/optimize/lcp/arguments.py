"""What a user gives for a problem, as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["bound_of", "matrix_of", "numbers_of", "vector_of"]

Vector = NDArray[np.float64]


def numbers_of(value: Any, name: str) -> Vector:
    """An array of what was given for an argument."""
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(f"{name} is {value!r}: real numbers were expected") from None


def vector_of(value: ArrayLike, name: str) -> Vector:
    """A vector of finite numbers."""
    vector = numbers_of(value, name)
    if vector.ndim != 1:
        raise ArgumentError(f"{name} has shape {vector.shape}: one dimension was expected")
    if not np.isfinite(vector).all():
        raise ArgumentError(f"{name}[{int(np.argmin(np.isfinite(vector)))}] is not a finite number")
    return vector


def bound_of(value: ArrayLike, n: int, name: str) -> Vector:
    """One bound for each of n unknowns, perhaps infinite."""
    given = numbers_of(value, name)
    if given.shape not in ((), (n,)):
        raise ArgumentError(
            f"{name} has shape {given.shape}: a number or shape {(n,)} was expected, as q has {n} entries"
        )
    if np.isnan(given).any():
        raise ArgumentError(f"{name} has an entry that is not a number")
    wrong = np.inf if name == "lo" else -np.inf
    if (given == wrong).any():
        raise ArgumentError(f"{name} has the entry {wrong}: no number keeps this bound")
    return np.array(np.broadcast_to(given, (n,)))


def matrix_of(value: Any, n: int) -> Any:
    """A square array, or a sparse one in compressed rows."""
    if hasattr(value, "tocsr"):
        from scipy.sparse import csr_array

        M: Any = csr_array(value, dtype=float)
        entries = M.data
    else:
        M = numbers_of(value, "M")
        entries = M
    if M.shape != (n, n):
        raise ArgumentError(f"M has shape {M.shape}: {(n, n)} was expected, as q has {n} entries")
    if not np.isfinite(entries).all():
        raise ArgumentError("M has an entry that is not a finite number")
    return M
