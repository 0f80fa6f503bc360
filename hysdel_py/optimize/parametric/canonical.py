"""The canonical problem: least distance in the curved directions, linear in the others."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Canonical"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Canonical:
    """``min 1/2 |v1|^2 + c(s)'v2  subject to  M1 v1 + M2 v2 <= b(s)``, for scaled parameters s in a domain.

    Attributes
    ----------
    M : array of shape (m, n)
        Rows of length one.
    b : array of shape (m, p + 2)
        Constant, coefficients of s, and coefficient of the infinitesimal that breaks ties.
    c : array of shape (n2, p + 2)
    domain : array of shape (r, p + 1)
        Side and normal of the rows of s.
    rows : int array of shape (m,)
        Each row's number in the problem as stated.
    back : array of shape (nz, n)
    shift : array of shape (nz, p + 1)
        ``z = back v + shift (1, s)``.
    centre, half : arrays of shape (p,)
        ``theta = centre + half s``.
    inner : array of shape (n + p,)
        A point that satisfies all rows with room.
    """

    M: Matrix
    b: Matrix
    c: Matrix
    domain: Matrix
    rows: NDArray[np.int64]
    back: Matrix
    shift: Matrix
    centre: Vector
    half: Vector
    inner: Vector

    def __post_init__(self) -> None:
        for item in fields(self):
            getattr(self, item.name).setflags(write=False)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Read-only in worker processes too: kernels are compiled for one kind of array."""
        for name, array in state.items():
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def n(self) -> int:
        """Number of variables."""
        return int(self.M.shape[1])

    @property
    def free(self) -> int:
        """Number of variables without curvature."""
        return len(self.c)

    @property
    def p(self) -> int:
        """Number of parameters."""
        return len(self.centre)

    @property
    def m(self) -> int:
        """Number of rows."""
        return len(self.M)

    def scaled(self, theta: Vector) -> Vector:
        """Scaled parameters."""
        return np.asarray((theta - self.centre) / self.half)

    def unscaled(self, s: Vector) -> Vector:
        """Parameters as stated."""
        return np.asarray(self.centre + self.half * s)
