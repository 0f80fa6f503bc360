"""By how much a point violates rows and bounds, absolutely and relative to the terms that were added."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import leaf

__all__ = ["violations"]

Vector = NDArray[np.float64]


@leaf
def violations(rows: Any, l: Vector, u: Vector, lb: Vector, ub: Vector, x: Vector) -> tuple[float, float]:
    """Largest violations of a point.

    Parameters
    ----------
    rows : (start, column, value)
        The matrix in compressed rows.
    l, u : arrays of shape (m,)
    lb, ub, x : arrays of shape (n,)

    Returns
    -------
    absolute, relative : float
        The latter relative to the sum of the absolute terms of the row, or to the size of the variable, and at least
        absolute. Both are infinite if an entry of x is not a number.
    """
    start, column, value = rows
    absolute = relative = 0.0
    for row in range(len(l)):
        total = size = 0.0
        for at in range(start[row], start[row + 1]):
            term = value[at] * x[column[at]]
            total += term
            size += abs(term)
        if np.isnan(total):
            return np.inf, np.inf
        over = max(l[row] - total, total - u[row])
        absolute, relative = max(absolute, over), max(relative, over / max(1.0, size))
    for j in range(len(x)):
        if np.isnan(x[j]):
            return np.inf, np.inf
        over = max(lb[j] - x[j], x[j] - ub[j])
        absolute, relative = max(absolute, over), max(relative, over / max(1.0, abs(x[j])))
    return absolute, relative
