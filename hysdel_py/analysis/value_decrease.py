"""Whether given quadratic functions of the cells are positive and fall along every step from cell to cell.

The steps are enumerated exactly as pairs of cells with the states that go from one to the other. On each the decrease
is a quadratic function, whose sign :mod:`hysdel_py.analysis.quadratic_bound` decides. Where both functions are purely
quadratic and the states hold the equilibrium, the sign is that on the facets which do not pass through it, since every
other state is a multiple of one there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.cells import Cell, transitions
from hysdel_py.analysis.quadratic_bound import Quadratic, is_nowhere_positive
from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["Decrease", "DecreaseSettings", "decrease_of"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class DecreaseSettings:
    """What is demanded, and limits of the work.

    Attributes
    ----------
    rate : float
        Demanded decrease, and value, as a share of the squared distance to the equilibrium; relative to the greatest
        curvature of the functions.
    zero : float
        Coefficients below this, relative to the greatest one, are rounding.
    parts : int
        Parts of one pair of cells that are looked at, at most.
    """

    rate: float = 1e-6
    zero: float = 1e-8
    parts: int = 2000


@dataclass(frozen=True, eq=False, slots=True)
class Decrease:
    """What was found about given functions.

    Attributes
    ----------
    holds : bool
        Whether all of them are positive and fall along all steps.
    witness : array of shape (n,) or None
        A state, from the equilibrium, where the function is not positive or does not fall.
    pairs : int
        Pairs of cells with a step between them.
    message : str
    """

    holds: bool
    witness: Vector | None
    pairs: int
    message: str


def decrease_of(cells: Sequence[Cell], P: Matrix, settings: DecreaseSettings) -> Decrease:
    """Check ``V(x) = (x, 1)' P_i (x, 1)`` in cell i, in coordinates whose origin is the equilibrium."""
    size = max(float(np.abs(P[:, :-1, :-1]).max(initial=0.0)), np.finfo(float).tiny)
    steps = transitions(cells)
    demands = [*_positive(cells, P, settings.rate * size), *_falling(cells, P, steps, settings.rate * size)]
    for function, region, what in demands:
        for part in _parts(function, region, settings.zero * size):
            if not part.is_bounded:
                return Decrease(False, None, len(steps), f"{what}: the states are not bounded")
            found = is_nowhere_positive(function, part, 0.0, settings.parts)
            if not found.holds:
                why = "not settled" if found.witness is None else "not so"
                return Decrease(False, found.witness, len(steps), f"{what}: {why}")
    return Decrease(True, None, len(steps), f"checked on {len(steps)} pairs of cells")


Demand = tuple[Quadratic, Polyhedron, str]


def _positive(cells: Sequence[Cell], P: Matrix, rate: float) -> Iterator[Demand]:
    for i, cell in enumerate(cells):
        yield _quadratic(-P[i], rate), cell.region, f"V is positive in cell {i}"


def _falling(
    cells: Sequence[Cell], P: Matrix, steps: Sequence[tuple[int, int, Polyhedron]], rate: float
) -> Iterator[Demand]:
    for i, j, states in steps:
        n = len(cells[i].f)
        step = np.block([[cells[i].A, cells[i].f[:, None]], [np.zeros((1, n)), 1.0]])
        yield _quadratic(step.T @ P[j] @ step - P[i], rate), states, f"V falls from cell {i} to cell {j}"


def _quadratic(M: Matrix, rate: float) -> Quadratic:
    """The form of a matrix in (x, 1), plus a share of the squared distance."""
    even = (M + M.T) / 2
    return Quadratic(even[:-1, :-1] + rate * np.eye(len(M) - 1), 2 * even[:-1, -1], float(even[-1, -1]))


def _parts(function: Quadratic, region: Polyhedron, zero: float) -> Iterator[Polyhedron]:
    """The region; at the equilibrium only its facets away from it."""
    pure = float(np.abs(function.g).max(initial=0.0)) <= zero and abs(function.c) <= zero
    unit = region.minimal().normalised()
    holds_origin = bool(np.all(unit.b >= -zero))
    if not (pure and holds_origin and region.is_bounded):
        yield region
        return
    for row in range(unit.m):
        if unit.b[row] > region.precision.empty:
            yield unit.facet(row)
