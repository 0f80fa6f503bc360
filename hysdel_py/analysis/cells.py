"""A piecewise affine system that runs by itself: without inputs, or with an explicit law in the loop."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.pwa_branches import Branch, branches_of
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.relations import includes
from hysdel_py.geometry.union import difference
from hysdel_py.systems.pwa import Pwa

__all__ = ["AffineLaw", "Cell", "cells_of", "escape", "thin_cells", "transitions"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


class AffineLaw(Protocol):
    """A law that is affine on polyhedra, as :class:`hysdel_py.ExplicitLaw` is; its parameters are the states."""

    @property
    def K(self) -> Any:
        """Gains of the regions, shape (count, n, p)."""

    @property
    def k(self) -> Any:
        """Constant parts, shape (count, n)."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""

    def rows(self, region: int, /) -> tuple[Matrix, Vector]:
        """Rows of a region."""


@dataclass(frozen=True, eq=False, slots=True)
class Cell:
    """``x+ = A x + f`` for x in a region.

    Attributes
    ----------
    region : Polyhedron
    A, f : arrays of shapes (n, n) and (n,)
    mode : int
        Mode of the system.
    law : int or None
        Region of the law.
    """

    region: Polyhedron
    A: Matrix
    f: Vector
    mode: int
    law: int | None = None


def cells_of(pwa: Pwa, law: AffineLaw | None = None, *, flat: bool = False) -> tuple[Cell, ...]:
    """Cells of a system without inputs, or of its closed loop with a law.

    Cells without inner points are left out. With `flat` those stay that belong to a mode without inner points, as an
    equality among the requirements makes it; what a law's region and a mode share on their borders does not.

    Raises
    ------
    ArgumentError
        For Boolean states or inputs, inputs without a law, and a law over other parameters than the states.
    """
    logical = [v.name for v in (*pwa.x, *pwa.u) if v.is_bool]
    if logical:
        raise ArgumentError(f"{', '.join(logical)}: Boolean states and inputs have no cells of real states alone")
    if law is None:
        if pwa.u:
            raise ArgumentError(f"the system has the inputs {', '.join(v.name for v in pwa.u)}: give a law for them")
        return tuple(Cell(b.region, b.A, b.f, b.mode) for b in branches_of(pwa) if _counts(b.region, b, flat))
    names = tuple(v.name for v in pwa.x)
    if not all(hasattr(law, part) for part in ("names", "K", "k", "rows")):
        raise ArgumentError(f"law: a {type(law).__name__} was given, an ExplicitLaw over the states was expected")
    if tuple(law.names) != names:
        raise ArgumentError(f"the law depends on {', '.join(law.names)}: a law of the states {names} was expected")
    branches = branches_of(pwa)
    return tuple(cell for number in range(len(law.K)) for cell in _closed(branches, law, number, len(pwa.u), flat))


def _closed(branches: Sequence[Branch], law: AffineLaw, number: int, moves: int, flat: bool) -> Iterator[Cell]:
    """Cells of one region of the law."""
    K, k = np.asarray(law.K[number][:moves]), np.asarray(law.k[number][:moves])
    own = Polyhedron(*law.rows(number))
    for branch in branches:
        lift = np.vstack([np.eye(own.n), K])
        region = own & branch.region.preimage(lift, np.concatenate([np.zeros(own.n), k]))
        if _counts(region, branch, flat):
            A, f = branch.A + branch.B @ K, branch.B @ k + branch.f
            yield Cell(region.minimal(), A, f, branch.mode, number)


def _is_full(region: Polyhedron) -> bool:
    return region.ball.radius > region.precision.empty


def _counts(region: Polyhedron, branch: Branch, flat: bool) -> bool:
    return _is_full(region) or (flat and not _is_full(branch.region) and not region.is_empty)


def thin_cells(cells: Sequence[Cell]) -> tuple[Cell, ...]:
    """Cells without inner points that step otherwise than the cells around them."""
    full = [cell for cell in cells if _is_full(cell.region)]
    thin = [cell for cell in cells if not _is_full(cell.region)]
    return tuple(cell for cell in thin if not any(_repeats(cell, other) for other in full))


def _repeats(cell: Cell, other: Cell) -> bool:
    """Whether all steps of a cell are those of another one."""
    same = np.allclose(cell.A, other.A) and np.allclose(cell.f, other.f)
    return same and includes(other.region, cell.region)


def transitions(cells: Sequence[Cell]) -> tuple[tuple[int, int, Polyhedron], ...]:
    """From where to where a step can lead, and the states for which it does.

    A single state, such as the equilibrium where all cells meet, is left out.
    """
    found = []
    for i, here in enumerate(cells):
        for j, there in enumerate(cells):
            states = here.region & there.region.preimage(here.A, here.f)
            if not states.is_empty and states.dimension > 0:
                found.append((i, j, states))
    return tuple(found)


def escape(cells: Sequence[Cell]) -> Vector | None:
    """A state in a cell whose step leads into no cell; None if there is none, up to sets without inner points.

    The states are compared before the step: after it they may have no inner points, where nothing could be compared.
    """
    for cell in cells:
        led_back = [there.region.preimage(cell.A, cell.f) for there in cells]
        left = difference(cell.region, led_back)
        if left:
            return left[0].ball.centre
    return None
