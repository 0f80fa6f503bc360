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
    moved, outside = np.array(x, dtype=float), np.zeros(len(x), dtype=np.bool_)
    for i, (value, variable) in enumerate(zip(moved.tolist(), variables, strict=True)):
        inside = min(max(value, variable.low), variable.high)
        if abs(value - inside) > tolerance * max(1.0, abs(value)):
            outside[i] = True
        else:
            moved[i] = inside
    return moved, outside
