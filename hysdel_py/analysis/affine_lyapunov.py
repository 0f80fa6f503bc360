"""Piecewise affine Lyapunov functions by one linear program.

In cell i ``V(x) = p_i'x + c_i``, with ``c_i = 0`` where the cell holds the equilibrium. V has to exceed the greatest
coordinate of x, and to fall by a share of it along each step; both are linear at the vertices of the cells and of the
pairs of cells, and hold between them because V is affine there and the norm is convex (for polyhedral functions F.
Blanchini and S. Miani, "Set-Theoretic Methods in Control", 2nd ed., Birkhäuser, 2015, chapter 4). Cutting the cells
along their steps gives V more pieces.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.cells import Cell, transitions
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.lp import maximise
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.union import difference

__all__ = ["AffineSearch", "cut_along_steps", "cut_at_origin", "search_affine"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class AffineSearch:
    """Slopes p of shape (count, n), constants c of shape (count,), and the rate of the decrease that the rows leave.

    The rate is minus infinity where the program has no solution.
    """

    p: Matrix
    c: Vector
    rate: float
    message: str


def cut_at_origin(cells: Sequence[Cell], at_origin: Sequence[bool]) -> tuple[Cell, ...]:
    """Cells that hold the equilibrium cut by the planes of the coordinates: V has no least value within a piece."""
    found: list[Cell] = []
    for cell, holds in zip(cells, at_origin, strict=True):
        regions = [cell.region]
        for row in np.eye(len(cell.f)) if holds else ():
            regions = [side for region in regions for side in _sides(region, row)]
        found += [Cell(region.minimal(), cell.A, cell.f, cell.mode, cell.law) for region in regions]
    return tuple(found)


def _sides(region: Polyhedron, row: Vector) -> Iterator[Polyhedron]:
    """What lies on each side of a plane through the origin and has inner points."""
    for sign in (1.0, -1.0):
        side = region.with_rows([sign * row], [0.0])
        if side.ball.radius > side.precision.empty:
            yield side


def cut_along_steps(cells: Sequence[Cell]) -> tuple[Cell, ...]:
    """Each cell in parts whose steps end in one cell, and what is left of it, from where steps leave the cells."""
    parts: list[list[Polyhedron]] = [[] for _ in cells]
    for i, _, states in transitions(cells):
        if states.ball.radius > states.precision.empty:
            parts[i].append(states.minimal())
    return tuple(
        Cell(part, cell.A, cell.f, cell.mode, cell.law)
        for own, cell in zip(parts, cells, strict=True)
        for part in (*own, *(rest.minimal() for rest in difference(cell.region, own)))
    )


def search_affine(cells: Sequence[Cell], at_origin: Sequence[bool], zero: float) -> AffineSearch:
    """Search V with ``V(x) >= |x|`` and the greatest rate r in ``V(x+) <= V(x) - r |x|``, for the greatest coordinate.

    Parameters
    ----------
    cells : sequence of Cell
        In coordinates whose origin is the equilibrium.
    at_origin : sequence of bool
        Whether each of them holds it.
    zero : float
        A vertex that is no farther from the equilibrium is it.

    Raises
    ------
    ArgumentError
        A cell is not bounded.
    """
    n = len(cells[0].f)
    corners = [_snapped(_corners(cell), zero) for cell in cells]
    rows, sides = [], []
    for i, points in enumerate(corners):
        block = _row_block(i, points, at_origin, n, len(cells))
        rows.append(np.column_stack([-block, np.zeros(len(points))]))
        sides.append(-_norms(points))
    for i, j, states in transitions(cells):
        points = _snapped(states.vertices, zero)
        after = _snapped(points @ cells[i].A.T + cells[i].f, zero)
        here = _row_block(i, points, at_origin, n, len(cells))
        there = _row_block(j, after, at_origin, n, len(cells))
        rows.append(np.column_stack([there - here, _norms(points)]))
        sides.append(np.zeros(len(points)))
    A, b = np.vstack(rows), np.concatenate(sides)
    return _solved(A, b, n, len(cells))


def _corners(cell: Cell) -> Matrix:
    if not cell.region.is_bounded:
        raise ArgumentError("a piecewise affine Lyapunov function needs bounded cells: give the states ranges")
    return cell.region.vertices


def _snapped(points: Matrix, zero: float) -> Matrix:
    return points * (_norms(points) > zero)[:, None]


def _norms(points: Matrix) -> Vector:
    return np.asarray(np.abs(points).max(axis=1, initial=0.0))


def _row_block(cell: int, points: Matrix, at_origin: Sequence[bool], n: int, count: int) -> Matrix:
    """V of a cell at some points as rows over all slopes and constants."""
    block = np.zeros((len(points), count * (n + 1)))
    first = cell * (n + 1)
    block[:, first : first + n] = points
    block[:, first + n] = 0.0 if at_origin[cell] else 1.0
    return block


def _solved(A: Matrix, b: Vector, n: int, count: int) -> AffineSearch:
    """Greatest rate; a V with any rate gives, times a factor, one with rate 1, which is enough."""
    cost = np.zeros(A.shape[1])
    cost[-1] = 1.0
    low, high = np.full(len(cost), -np.inf), np.full(len(cost), np.inf)
    high[-1] = 1.0
    found = maximise(cost, A, b, low, high, vertex=True)
    if not found.is_optimal:
        return AffineSearch(np.zeros((0, n)), np.zeros(0), -np.inf, found.status.value)
    V = found.w[:-1].reshape(count, n + 1)
    return AffineSearch(V[:, :n], V[:, n], _rate(A, b, found.w), found.status.value)


def _rate(A: Matrix, b: Vector, w: Vector) -> float:
    """The rate that all rows grant in floating point: the solver's, less what rows with a rate are broken by."""
    excess, norms = A @ w - b, A[:, -1]
    falling = norms > 0
    if np.any(excess[~falling] > -b[~falling] * _LEFT):
        return -np.inf
    return float(w[-1] - max(0.0, (excess[falling] / norms[falling]).max(initial=0.0)))


_LEFT = 0.5  # share of the demanded value of V that rounding of the solver may take
