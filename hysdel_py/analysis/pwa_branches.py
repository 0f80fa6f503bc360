"""A piecewise affine system with the Booleans taken out: for each of their values an affine map between real states."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.mode import Mode
from hysdel_py.systems.pwa import Pwa
from hysdel_py.systems.sections import Section, section_of

__all__ = ["Branch", "branches_of"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Word = tuple[bool, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Branch:
    """``v+ = A v + B s + f`` for real states v and real inputs s in a region.

    Attributes
    ----------
    mode : int
        Index of the mode of the system.
    word, inputs : tuple of bool
        Boolean states and inputs.
    region : Polyhedron
        Over (v, s); the gap of a threshold belongs to its false side as well.
    A, B, f : arrays of shapes (n, n), (n, m), (n,)
    next_word : tuple of bool
        Boolean states after the step.
    """

    mode: int
    word: Word
    inputs: Word
    region: Polyhedron
    A: Matrix
    B: Matrix
    f: Vector
    next_word: Word


def branches_of(pwa: Pwa) -> tuple[Branch, ...]:
    """All branches, mode after mode; free Booleans give one branch for each of their values."""
    variables = (*pwa.x, *pwa.u)
    return tuple(branch for mode in pwa.modes for branch in _branches_of_mode(pwa, mode, section_of(mode, variables)))


def _branches_of_mode(pwa: Pwa, mode: Mode, section: Section) -> Iterator[Branch]:
    columns = [column for column, _ in section.booleans]
    choices = [(False, True) if value is None else (value,) for _, value in section.booleans]
    filled = np.array([0.0 if source.holds else source.gap for source in section.sources])
    region = Polyhedron(section.A, section.b + filled)
    for values in product(*choices):
        yield _branch(pwa, mode, region, dict(zip(columns, values, strict=True)))


def _branch(pwa: Pwa, mode: Mode, region: Polyhedron, booleans: dict[int, bool]) -> Branch:
    nx = len(pwa.x)
    real_x = [i for i, v in enumerate(pwa.x) if not v.is_bool]
    real_u = [i for i, v in enumerate(pwa.u) if not v.is_bool]
    values = np.zeros(nx + len(pwa.u))
    values[list(booleans)] = list(booleans.values())
    after = mode.f + np.hstack([mode.A, mode.B]) @ values
    return Branch(
        mode.index,
        tuple(booleans[i] for i, v in enumerate(pwa.x) if v.is_bool),
        tuple(booleans[nx + i] for i, v in enumerate(pwa.u) if v.is_bool),
        region,
        mode.A[np.ix_(real_x, real_x)],
        mode.B[np.ix_(real_x, real_u)],
        after[real_x],
        tuple(bool(after[i] > 0.5) for i, v in enumerate(pwa.x) if v.is_bool),
    )
