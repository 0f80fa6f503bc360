"""Successors and predecessors of a piece of a set of states, exact or enclosed along directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.hybrid_set import Piece
from hysdel_py.analysis.pwa_branches import Branch
from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["Backward", "Forward", "enclosure", "greatest"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Forward:
    """Successors of a piece."""

    branches: tuple[Branch, ...]
    template: Matrix | None

    def __call__(self, numbered: tuple[int, Piece]) -> list[Piece]:
        """Pieces behind a piece, which comes with its number."""
        number, piece = numbered
        own = [branch for branch in self.branches if branch.word == piece.word]
        regions = [(branch, self._image(branch, piece.region)) for branch in own]
        return [Piece(b.next_word, region, b.mode, number) for b, region in regions if not region.is_empty]

    def _image(self, branch: Branch, states: Polyhedron) -> Polyhedron:
        domain = _with_states(branch.region, states)
        M = np.hstack([branch.A, branch.B])
        if self.template is None:
            return domain.image(M, branch.f)
        return enclosure(domain, self.template @ M, self.template, self.template @ branch.f)


@dataclass(frozen=True, eq=False, slots=True)
class Backward:
    """Predecessors of a piece."""

    branches: tuple[Branch, ...]
    template: Matrix | None

    def __call__(self, numbered: tuple[int, Piece]) -> list[Piece]:
        """Pieces before a piece, which comes with its number."""
        number, piece = numbered
        leading = [branch for branch in self.branches if branch.next_word == piece.word]
        regions = [(branch, self._shadow(branch, piece.region)) for branch in leading]
        return [Piece(b.word, region, b.mode, number) for b, region in regions if not region.is_empty]

    def _shadow(self, branch: Branch, target: Polyhedron) -> Polyhedron:
        n = len(branch.f)
        domain = branch.region & target.preimage(np.hstack([branch.A, branch.B]), branch.f)
        if self.template is None:
            return domain.project(range(n))
        along = np.hstack([self.template, np.zeros((len(self.template), domain.n - n))])
        return enclosure(domain, along, self.template, np.zeros(len(self.template)))


def _with_states(region: Polyhedron, states: Polyhedron) -> Polyhedron:
    """Points of a region over (v, s) whose states lie in a polyhedron."""
    return region.with_rows(np.hstack([states.A, np.zeros((states.m, region.n - states.n))]), states.b)


def enclosure(domain: Polyhedron, along: Matrix, directions: Matrix, offset: NDArray[np.float64]) -> Polyhedron:
    """``{v : directions v <= h}`` with h the greatest values of ``along w + offset`` over a domain."""
    if domain.is_empty:
        return Polyhedron.empty(directions.shape[1], domain.precision)
    sides = np.array([greatest(domain, row) for row in along]) + offset
    real = np.isfinite(sides)
    return Polyhedron(directions[real], sides[real], domain.precision)


def greatest(domain: Polyhedron, row: NDArray[np.float64]) -> float:
    """Greatest value of a linear function, widened by the precision of the linear program."""
    value = domain.maximise(row).value
    return float(value + domain.precision.lp * max(1.0, abs(value))) if np.isfinite(value) else np.inf
