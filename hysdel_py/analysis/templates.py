"""Directions along which sets are enclosed."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["boxes", "template_of"]


def template_of(sets: str | ArrayLike, n: int) -> NDArray[np.float64] | None:
    """Rows of directions in n coordinates; None for exact sets.

    Raises
    ------
    ArgumentError
        For an unknown word or an array of another width.
    """
    if isinstance(sets, str):
        if sets not in _NAMED:
            raise ArgumentError(
                f"sets must be {', '.join(map(repr, _NAMED))} or an array of directions; found {sets!r}"
            )
        return _NAMED[sets](n)
    directions = np.atleast_2d(np.asarray(sets, dtype=float))
    if directions.ndim != 2 or directions.shape[1] != n or not np.isfinite(directions).all():
        raise ArgumentError(f"directions must be finite, of shape (count, {n}); found shape {directions.shape}")
    return directions


def boxes(n: int) -> NDArray[np.float64]:
    """Both directions of every coordinate."""
    return np.vstack([np.eye(n), -np.eye(n)])


def _octagons(n: int) -> NDArray[np.float64]:
    eye = np.eye(n)
    pairs = [a * eye[i] + b * eye[j] for i, j in combinations(range(n), 2) for a in (1, -1) for b in (1, -1)]
    return np.vstack([boxes(n), *pairs])


def _exact(n: int) -> None:  # noqa: ARG001
    return None


_NAMED = {"exact": _exact, "boxes": boxes, "octagons": _octagons}
