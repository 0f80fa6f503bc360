"""Units of variables in which the coefficients of a linear program are of about the same size."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["column_units"]

_SMALL_COLUMN, _SMALL_COEFFICIENT = 1e-3, 1e-9
"""Columns without a greater coefficient, or with a lesser one, are scaled."""
_NO_COEFFICIENT = 1e-13
"""What is below is rounding."""


def column_units(A: Any) -> NDArray[np.float64]:
    """Powers of two between the least and greatest coefficients of columns with small ones, 1 for the others.

    HiGHS takes what is below 1e-9 for zero, and a variable whose coefficients are small may be far from where the
    answers of the others are checked. Sparse rows are taken as they are.
    """
    if hasattr(A, "toarray") or not len(A):
        return np.ones(A.shape[1])
    sizes = np.abs(A)
    most = sizes.max(axis=0)
    least = np.where(sizes > _NO_COEFFICIENT, sizes, np.inf).min(axis=0)
    small = (least < np.inf) & ((most < _SMALL_COLUMN) | (least < _SMALL_COEFFICIENT))
    middle = 0.5 * (np.log2(np.where(small, least, 1.0)) + np.log2(np.where(small, most, 1.0)))
    return np.asarray(np.exp2(np.round(middle)))
