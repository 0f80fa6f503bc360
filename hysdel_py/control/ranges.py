"""States that leave their range by no more than the solver's tolerance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.signals import Variable

__all__ = ["onto_range"]

Matrix = NDArray[np.float64]


def onto_range(x: Matrix, variables: Sequence[Variable], tolerance: float) -> tuple[Matrix, NDArray[np.bool_]]:
    """Move values that are hardly outside their range onto its end.

    Parameters
    ----------
    x : array of shape (n,)
    variables : sequence of Variable
    tolerance : float
        Relative to the size of the value, and at least absolute.

    Returns
    -------
    moved : array of shape (n,)
        All values inside their ranges, except those that were outside by more than the tolerance.
    outside : array of bool
        The latter.
    """
    low = np.array([v.low for v in variables], dtype=float)
    high = np.array([v.high for v in variables], dtype=float)
    inside = np.clip(x, low, high)
    outside: NDArray[np.bool_] = np.abs(x - inside) > tolerance * np.maximum(1.0, np.abs(x))
    return np.where(outside, x, inside), outside
