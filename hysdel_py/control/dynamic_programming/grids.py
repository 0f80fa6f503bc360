"""Grids of states and inputs: axes with names and units, and multilinear interpolation over feasible corners."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Kind, Type, Variable

__all__ = ["Axis", "Mesh", "input_points"]

Matrix = NDArray[np.float64]

ON_NODE = 1e-9
"""Part of a cell within which a point counts as lying on a node, or as inside the grid."""


@dataclass(frozen=True, slots=True)
class Axis:
    """Equally spaced values of one state or input.

    Attributes
    ----------
    name : str
    low, high : float
        First and last value. A state outside is not admissible.
    count : int
        Number of values.
    unit : str

    Raises
    ------
    ArgumentError
        Ends that are not finite or in the wrong order, or a count that does not fit them.
    """

    name: str
    low: float
    high: float
    count: int
    unit: str = ""

    def __post_init__(self) -> None:
        if not np.isfinite([self.low, self.high]).all():
            raise ArgumentError(f"axis {self.name} from {self.low} to {self.high}: finite ends were expected")
        if self.count != int(self.count) or self.count < 1:
            raise ArgumentError(f"axis {self.name} has {self.count} values: a whole number of at least 1 was expected")
        if not (self.low < self.high if self.count > 1 else self.low == self.high):
            raise ArgumentError(
                f"axis {self.name} from {self.low:g} to {self.high:g} with {self.count} values: several values need "
                "low < high, one value needs low = high"
            )

    @classmethod
    def spaced(cls, name: str, low: float, high: float, step: float, unit: str = "") -> Axis:
        """An axis by its step, which must divide the range."""
        if not (np.isfinite(step) and step > 0):
            raise ArgumentError(f"axis {name} has the step {step}: a positive number was expected")
        cells = (high - low) / step
        if abs(cells - round(cells)) > ON_NODE * max(1.0, abs(cells)):
            raise ArgumentError(f"axis {name}: the step {step:g} does not divide the range from {low:g} to {high:g}")
        return cls(name, low, high, round(cells) + 1, unit)

    @property
    def step(self) -> float:
        """Distance of neighbouring values, 1 for a single value."""
        return (self.high - self.low) / (self.count - 1) if self.count > 1 else 1.0

    @property
    def values(self) -> Matrix:
        """All values."""
        return np.linspace(self.low, self.high, self.count)

    def variable(self, kind: Kind) -> Variable:
        """The axis as a variable of a system."""
        return Variable(self.name, Type.REAL, kind, self.low, self.high, self.unit)


@dataclass(frozen=True, eq=False)
class Mesh:
    """All combinations of the values of some axes, the last axis running fastest."""

    axes: tuple[Axis, ...]

    @cached_property
    def low(self) -> Matrix:
        """First value of each axis."""
        return np.array([axis.low for axis in self.axes])

    @cached_property
    def step(self) -> Matrix:
        """Step of each axis."""
        return np.array([axis.step for axis in self.axes])

    @cached_property
    def counts(self) -> NDArray[np.int64]:
        """Number of values of each axis."""
        return np.array([axis.count for axis in self.axes], dtype=np.int64)

    @property
    def size(self) -> int:
        """Number of nodes, a Python integer of any size."""
        size = 1
        for axis in self.axes:
            size *= int(axis.count)
        return size

    def nodes(self, start: int = 0, stop: int | None = None) -> Matrix:
        """Some of the nodes, one per row."""
        index = np.unravel_index(np.arange(start, self.size if stop is None else stop), tuple(self.counts))
        return np.stack([axis.values[i] for axis, i in zip(self.axes, index, strict=True)], axis=-1)

    def holds(self, x: Matrix) -> NDArray[np.bool_]:
        """Whether points lie inside."""
        place = (x - self.low) / self.step
        return np.asarray(np.all((place >= -ON_NODE) & (place <= self.counts - 1 + ON_NODE), axis=-1))

    def cell(self, x: Matrix) -> tuple[NDArray[np.int64], Matrix]:
        """Where points lie; of points outside, the nearest cell.

        Returns
        -------
        base : array of int64, shape of x without its last axis
            Flat index of the lowest corner of the cell.
        fraction : array with the shape of x
            Place within the cell, 0 to 1.
        """
        place = (x - self.low) / self.step
        last = self.counts - 1
        place = np.where(np.isfinite(place), np.clip(place, 0.0, last), 0.0)
        nearest = np.round(place)
        place = np.where(np.abs(place - nearest) <= ON_NODE, nearest, place)
        corner = np.minimum(np.floor(place), np.maximum(last - 1, 0))
        base = np.zeros(x.shape[:-1], dtype=np.int64)
        for i, count in enumerate(self.counts):
            base = base * count + corner[..., i].astype(np.int64)
        return base, place - corner

    def nearest(self, x: Matrix) -> NDArray[np.int64]:
        """Flat index of the nearest node, of a point inside."""
        index = np.clip(np.round((x - self.low) / self.step), 0, self.counts - 1).astype(np.int64)
        return np.asarray(np.ravel_multi_index(tuple(np.moveaxis(index, -1, 0)), tuple(self.counts)))

    def corners(self, fraction: Matrix) -> Iterator[tuple[int, Matrix]]:
        """Offset of the flat index and weight, for each corner of a cell."""
        strides = np.concatenate([np.cumprod(self.counts[:0:-1])[::-1], [1]])
        for bits in product(*((0, 1) if count > 1 else (0,) for count in self.counts)):
            weight = np.ones(fraction.shape[:-1])
            for i, bit in enumerate(bits):
                weight = weight * (fraction[..., i] if bit else 1.0 - fraction[..., i])
            yield int(np.dot(bits, strides)), weight


def input_points(axes: Sequence[Axis]) -> Matrix:
    """All combinations of input values, one per row."""
    return Mesh(tuple(axes)).nodes()
