"""Linear matrix inequalities ``M0 + sum x_k M_k`` positive semidefinite, solved by Clarabel."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["Inequalities"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(slots=True)
class Inequalities:
    """Inequalities under construction over real unknowns, some of which are not negative."""

    n: int = 0
    positive: list[int] = field(default_factory=list)
    blocks: list[tuple[Matrix, dict[int, Matrix]]] = field(default_factory=list)

    def symmetric(self, size: int) -> dict[int, Matrix]:
        """A new symmetric matrix: its unknowns with what each of them multiplies."""
        basis = {}
        for i in range(size):
            for j in range(i + 1):
                basis[self.n] = _unit(size, i, j)
                self.n += 1
        return basis

    def multipliers(self, rows: Matrix) -> dict[int, Matrix]:
        """``rows' U rows`` with a new symmetric U without negative entries: at least zero where ``rows x >= 0``."""
        terms = {}
        for i in range(len(rows)):
            for j in range(i + 1):
                terms[self.n] = np.asarray(rows.T @ _unit(len(rows), i, j) @ rows)
                self.positive.append(self.n)
                self.n += 1
        return terms

    def require(self, constant: Matrix, *terms: tuple[float, dict[int, Matrix]]) -> None:
        """Demand that the constant and the terms, each with its factor, add up to a semidefinite matrix."""
        total: dict[int, Matrix] = {}
        for factor, basis in terms:
            for k, M in basis.items():
                total[k] = total.get(k, 0.0) + factor * M
        self.blocks.append((constant, total))

    def solve(self) -> tuple[Vector | None, str]:
        """Values of the unknowns or None, and the word of the solver.

        Raises
        ------
        ArgumentError
            Clarabel is not installed.
        """
        clarabel = _solver()
        from scipy.sparse import csc_array

        A, b, cones = self._cones(clarabel)
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        size = csc_array((self.n, self.n))
        answer = clarabel.DefaultSolver(size, np.zeros(self.n), csc_array(A), b, cones, settings).solve()
        word = str(answer.status)
        return (np.asarray(answer.x) if word in ("Solved", "AlmostSolved") else None), word

    def _cones(self, clarabel: Any) -> tuple[Matrix, Vector, list[Any]]:
        """``b - A x`` lies in the cones: the half-axes, then one of semidefinite matrices for each block."""
        rows = [-np.eye(self.n)[self.positive]]
        sides = [np.zeros(len(self.positive))]
        cones = [clarabel.NonnegativeConeT(len(self.positive))] if self.positive else []
        for constant, terms in self.blocks:
            block = np.zeros((len(_packed(constant)), self.n))
            for k, M in terms.items():
                block[:, k] = -_packed(M)
            rows.append(block)
            sides.append(_packed(constant))
            cones.append(clarabel.PSDTriangleConeT(len(constant)))
        return np.vstack(rows), np.concatenate(sides), cones


def _solver() -> Any:
    try:
        import clarabel
    except ModuleNotFoundError:
        raise ArgumentError(
            "linear matrix inequalities need clarabel, which is not installed: pip install hysdel_py[stability]"
        ) from None
    return clarabel


def _unit(size: int, i: int, j: int) -> Matrix:
    M = np.zeros((size, size))
    M[i, j] = M[j, i] = 1.0
    return M


def _packed(M: Matrix) -> Vector:
    """Upper triangle column by column, off the diagonal times the root of two."""
    columns, rows = np.tril_indices(len(M))
    return np.asarray(M[rows, columns] * np.where(rows == columns, 1.0, np.sqrt(2.0)))
