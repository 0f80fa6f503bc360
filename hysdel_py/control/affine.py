"""Vectors that depend affinely on the decision variables and on the parameters of a plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["Affine", "stack"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Affine:
    """The vector ``V v + X p + c`` with the parameters p, the measured state and the input applied last.

    Attributes
    ----------
    V : sparse array of shape (m, n)
        Dependence on the decision variables.
    X : array of shape (m, number of parameters)
        Dependence on the parameters.
    c : array of shape (m,)
    """

    V: csr_array
    X: Matrix
    c: Matrix

    def __add__(self, other: Affine) -> Affine:
        """Sum of two vectors of the same length."""
        return Affine(self.V + other.V, self.X + other.X, self.c + other.c)

    def __sub__(self, other: Affine) -> Affine:
        """Difference of two vectors of the same length."""
        return Affine(self.V - other.V, self.X - other.X, self.c - other.c)

    def negative(self) -> Affine:
        """The vector times minus one."""
        return Affine(-self.V, -self.X, -self.c)

    def times(self, matrix: Any) -> Affine:
        """Product of a dense or sparse matrix with the vector."""
        from scipy.sparse import csr_array

        left = csr_array(matrix)
        return Affine(left @ self.V, left @ self.X, left @ self.c)

    def shifted(self, constant: Matrix) -> Affine:
        """Sum with a constant vector."""
        return Affine(self.V, self.X, self.c + constant)

    def entry(self, index: int) -> Affine:
        """One entry, as a vector of length 1."""
        return self.entries(np.array([index]))

    def entries(self, indices: NDArray[np.intp]) -> Affine:
        """Some entries."""
        return Affine(self.V[indices, :], self.X[indices], self.c[indices])


def stack(parts: list[Affine], n: int, parameters: int) -> Affine:
    """Put vectors below each other; without any, the empty vector of `n` variables and so many parameters."""
    from scipy.sparse import csr_array, vstack

    empty = Affine(csr_array((0, n)), np.zeros((0, parameters)), np.zeros(0))
    every = [empty, *parts]
    V = csr_array(vstack([part.V for part in every], format="csr"))
    V.eliminate_zeros()
    return Affine(
        V,
        np.vstack([part.X for part in every]),
        np.concatenate([part.c for part in every]),
    )
