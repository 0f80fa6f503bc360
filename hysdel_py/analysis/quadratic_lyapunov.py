"""Quadratic and piecewise quadratic Lyapunov functions by linear matrix inequalities.

Decrease from cell to cell is a linear matrix inequality, made less demanding by what is known of the cell (M. Johansson
and A. Rantzer, "Computation of piecewise quadratic Lyapunov functions for hybrid systems", IEEE Trans. Automatic
Control 43, 1998; discrete time: D. Mignone, G. Ferrari-Trecate and M. Morari, "Stability and stabilization of piecewise
affine and hybrid systems: an LMI approach", CDC 2000). What the solver returns is checked again by eigenvalues.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.cells import Cell, transitions
from hysdel_py.analysis.matrix_inequalities import Inequalities
from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["DEFAULT_LYAPUNOV_TOLERANCES", "LyapunovTolerances", "QuadraticSearch", "at_origin"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LyapunovTolerances:
    """Tolerances of the search.

    Attributes
    ----------
    origin : float
        A cell belongs to the equilibrium, and a row passes through it, up to this distance.
    margin : float
        Share of the demanded margins that must be left in the check of what the solver returned.
    """

    origin: float = 1e-7
    margin: float = 0.5


DEFAULT_LYAPUNOV_TOLERANCES = LyapunovTolerances()


def at_origin(cell: Cell, tolerances: LyapunovTolerances) -> bool:
    """Whether a cell holds the equilibrium, which is the origin of its coordinates."""
    return bool(np.all(cell.region.b >= -tolerances.origin * np.maximum(1.0, cell.region.lengths)))


class QuadraticSearch:
    """The inequalities of all cells and transitions."""

    def __init__(self, cells: Sequence[Cell], kind: str, tolerances: LyapunovTolerances) -> None:
        self._cells = cells
        self._tolerances = tolerances
        self._system = Inequalities()
        self._at_origin = [at_origin(cell, tolerances) for cell in cells]
        self._n = len(cells[0].f)
        common = self._system.symmetric(self._n) if kind == "quadratic" else None
        self._P = [self._function(i) if common is None else _padded(common) for i in range(len(cells))]

    def _function(self, cell: int) -> dict[int, Matrix]:
        """Unknowns of one function; it is zero at the equilibrium."""
        if self._at_origin[cell]:
            return _padded(self._system.symmetric(self._n))
        return self._system.symmetric(self._n + 1)

    def solve(self) -> tuple[Matrix, float, str]:
        """Functions, the least eigenvalue relative to what was demanded, and the word of the solver."""
        for i, cell in enumerate(self._cells):
            self._demand(self._rows(cell.region, self._at_origin[i]), (1.0, self._P[i]), at_origin=self._at_origin[i])
        for i, j, states in transitions(self._cells):
            step = np.block([[self._cells[i].A, self._cells[i].f[:, None]], [np.zeros((1, self._n)), 1.0]])
            after = {k: np.asarray(step.T @ M @ step) for k, M in self._P[j].items()}
            both = self._at_origin[i] and self._at_origin[j]
            self._demand(self._rows(states, both), (1.0, self._P[i]), (-1.0, after), at_origin=both)
        values, word = self._system.solve()
        if values is None:
            return np.zeros((0, self._n + 1, self._n + 1)), -np.inf, word
        P = np.array([sum(values[k] * M for k, M in basis.items()) for basis in self._P])
        return P, self._margin(values), word

    def _rows(self, region: Polyhedron, at_origin: bool) -> Matrix:
        """Forms that are not negative in a region; at the equilibrium only those that vanish there."""
        unit = region.minimal().normalised()
        if at_origin:
            through = np.abs(unit.b) <= self._tolerances.origin
            return np.column_stack([-unit.A[through], np.zeros(int(through.sum()))])
        return np.vstack([np.column_stack([-unit.A, unit.b]), np.eye(self._n + 1)[-1]])

    def _demand(self, rows: Matrix, *terms: tuple[float, dict[int, Matrix]], at_origin: bool) -> None:
        """The terms exceed the squared distance to the equilibrium wherever the rows are not negative."""
        size = self._n + (not at_origin)
        more = self._system.multipliers(rows)
        unit = np.eye(self._n + 1)[:size, :size]
        unit[self._n :] = 0.0
        self._system.require(-unit, *((f, _cut(basis, size)) for f, basis in (*terms, (-1.0, more))))

    def _margin(self, values: Vector) -> float:
        """Least eigenvalue of all inequalities with the demanded unit given back, and least multiplier."""
        least = 1.0
        clipped = values.copy()
        clipped[self._system.positive] = np.maximum(values[self._system.positive], 0.0)
        for constant, terms in self._system.blocks:
            total = constant + sum((clipped[k] * M for k, M in terms.items()), np.zeros_like(constant))
            least = min(least, 1.0 + float(np.linalg.eigvalsh(total)[0]))
        return least


def _padded(basis: dict[int, Matrix]) -> dict[int, Matrix]:
    """Quadratic forms in x as forms in (x, 1)."""
    return {k: np.pad(M, (0, 1)) for k, M in basis.items()}


def _cut(basis: dict[int, Matrix], size: int) -> dict[int, Matrix]:
    return {k: M[:size, :size] for k, M in basis.items()}
