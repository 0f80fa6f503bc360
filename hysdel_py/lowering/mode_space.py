"""The coordinates ``w = (x, u)`` of a piecewise affine system, and how modes are put together in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.cell import Cell
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.precision import Precision
from hysdel_py.lowering.mode_conditions import of_boolean, of_range
from hysdel_py.systems.mode import Auxiliaries, Condition, Mode
from hysdel_py.systems.signals import Variable

__all__ = ["Space"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Space:
    """Coordinates of states and inputs; cells live in the real ones among them.

    Attributes
    ----------
    x, u : tuple of Variable
    word_names : tuple of str
        Booleans that the word of a mode lists.
    """

    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    word_names: tuple[str, ...]

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """All coordinates."""
        return (*self.x, *self.u)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(v.name for v in self.variables)

    @cached_property
    def reals(self) -> list[int]:
        """Columns of the real coordinates."""
        return [i for i, v in enumerate(self.variables) if not v.is_bool]

    @cached_property
    def boolean_columns(self) -> dict[str, int]:
        """Columns of the Boolean coordinates."""
        return {v.name: i for i, v in enumerate(self.variables) if v.is_bool}

    @cached_property
    def root(self) -> Cell:
        """The declared ranges of the real coordinates."""
        real = tuple(self.variables[i] for i in self.reals)
        low, high = np.array([v.low for v in real], dtype=float), np.array([v.high for v in real], dtype=float)
        return Cell.box(low, high, of_range(real))

    def mode(
        self, index: int, truths: Mapping[str, float], maps: tuple[list[Vector], list[Vector]], cell: Cell,
        precision: Precision,
    ) -> Mode:  # fmt: skip
        """A mode from its cell and the maps of its next states and outputs.

        Parameters
        ----------
        truths : mapping
            Values of the Booleans that have one.
        maps : pair of lists of arrays of shape (n + 1,)
        cell : Cell
            With needed rows only.
        """
        region, sources = self._region(truths, cell, precision)
        nx, n = len(self.x), len(self.names)
        blocks = [np.array(group).reshape(-1, n + 1) + 0.0 for group in maps]
        parts = [part for block in blocks for part in (block[:, :nx], block[:, nx:n], block[:, n])]
        word = tuple((name, bool(truths[name]) if name in truths else None) for name in self.word_names)
        A, B, f, C, D, g = (part.copy() for part in parts)
        return Mode(index, A, B, f, C, D, g, region, sources, word, cell.is_flat, self.names)

    def _region(
        self, truths: Mapping[str, float], cell: Cell, precision: Precision
    ) -> tuple[Polyhedron, tuple[Condition, ...]]:
        """The rows of the cell over all coordinates, then two rows for each Boolean coordinate."""
        real = np.zeros((len(cell.b), len(self.names)))
        real[:, self.reals] = cell.A
        unit = np.eye(len(self.names))
        matrices, sides = [real], [cell.b]
        sources = [tag for tag in cell.tags if isinstance(tag, Condition)]
        for name, column in self.boolean_columns.items():
            value = bool(truths[name]) if name in truths else None
            low, high = (0.0, 1.0) if value is None else (float(value), float(value))
            matrices += [unit[column], -unit[column]]
            sides.append(np.array([high, -low]))
            sources += of_boolean(self.variables[column], value)
        return Polyhedron(np.vstack(matrices), np.concatenate(sides), precision), tuple(sources)

    def auxiliaries(self, d: list[float], z: list[Vector]) -> Auxiliaries:
        """Auxiliaries from the values of d and the maps of z."""
        n = len(self.names)
        block = np.array(z).reshape(-1, n + 1) + 0.0
        return Auxiliaries(np.array(d, dtype=float), block[:, :n].copy(), block[:, n].copy())
