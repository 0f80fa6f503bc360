"""Affine maps of the coordinates that replace names while a mode is being found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Definition, LogicEquation, Switch
from hysdel_py.systems.formula import Literal

__all__ = ["Knowledge"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Knowledge:
    """What is known on the way to a mode.

    Attributes
    ----------
    maps : mapping of name to array of shape (n + 1,)
        Each variable as an affine map of the coordinates ``w = (x, u)``, the constant last.
    truths : mapping of name to 0.0 or 1.0
        Values of the Booleans that have one.
    """

    maps: Mapping[str, Vector]
    truths: Mapping[str, float]

    @classmethod
    def of_coordinates(cls, names: tuple[str, ...]) -> Knowledge:
        """Only that each coordinate is itself."""
        return cls(dict(zip(names, np.eye(len(names), len(names) + 1), strict=True)), {})

    @property
    def size(self) -> int:
        """Number of entries of a map."""
        return len(next(iter(self.maps.values()))) if self.maps else 1

    def with_truth(self, name: str, value: bool) -> Knowledge:
        """A Boolean gets a value; an auxiliary one becomes that number in forms too."""
        truths = {**self.truths, name: float(value)}
        if name in self.maps:
            return replace(self, truths=truths)
        return Knowledge({**self.maps, name: self.constant(float(value))}, truths)

    def with_map(self, name: str, value: Vector) -> Knowledge:
        """A real auxiliary gets its map."""
        return replace(self, maps={**self.maps, name: value})

    def constant(self, value: float) -> Vector:
        """The map to a number."""
        result = np.zeros(self.size)
        result[-1] = value
        return result

    def map_of(self, form: Affine) -> Vector:
        """An affine form over names as a map of the coordinates."""
        result = self.constant(form.constant)
        for name, coefficient in form.terms:
            if coefficient:
                result += coefficient * self.maps[name]
        return result

    def folded(self, value: Vector, columns: Mapping[str, int]) -> Vector:
        """A map in which coordinates with a truth value are numbers."""
        result = value.copy()
        for name, column in columns.items():
            if name in self.truths:
                result[-1] += result[column] * self.truths[name]
                result[column] = 0.0
        return result

    def value_of(self, definition: Definition | None) -> Vector:
        """The map that a definition gives; zero without a definition."""
        match definition:
            case Switch():
                return self.map_of(definition.branch(self.truths))
            case AffineEquation(value=value):
                return self.map_of(value)
            case LogicEquation(value=formula) if formula.literal is not None and formula.literal.name in self.maps:
                return self._literal(formula.literal)
            case LogicEquation(value=formula):
                return self.constant(float(formula.value(self.truths)))
            case _:
                return self.constant(0.0)

    def _literal(self, literal: Literal) -> Vector:
        value = self.maps[literal.name]
        return value if literal.positive else self.constant(1.0) - value
