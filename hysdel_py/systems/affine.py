"""Affine forms over named variables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from hysdel_py.systems.symbolic import greatest, least

__all__ = ["Affine"]


@dataclass(frozen=True, slots=True)
class Affine:
    """``constant + sum of coefficient * variable``.

    Attributes
    ----------
    constant : float
    terms : tuple of (name, coefficient)
        One entry per variable that was written, in the order of first use; a coefficient may be zero, since ``0*x``
        still mentions x.
    """

    constant: float = 0.0
    terms: tuple[tuple[str, float], ...] = ()

    def __add__(self, other: Affine) -> Affine:
        coefficients = dict(self.terms)
        for name, value in other.terms:
            coefficients[name] = coefficients.get(name, 0.0) + value
        return Affine(self.constant + other.constant, tuple(coefficients.items()))

    def __mul__(self, factor: float) -> Affine:
        return Affine(self.constant * factor, tuple((name, value * factor) for name, value in self.terms))

    def __neg__(self) -> Affine:
        return self * -1.0

    def __sub__(self, other: Affine) -> Affine:
        return self + -other

    @property
    def is_constant(self) -> bool:
        """Whether no variable is mentioned."""
        return not self.terms

    def value(self, values: Mapping[str, float]) -> float:
        """Value at a point."""
        return self.constant + sum(coefficient * values[name] for name, coefficient in self.terms)

    def range(self, range_of: Callable[[str], tuple[float, float]]) -> tuple[float, float]:
        """Least and greatest value by interval arithmetic on the collected terms."""
        low = high = self.constant
        for name, coefficient in self.terms:
            if coefficient:
                ends = [coefficient * end for end in range_of(name)]
                least_end, greatest_end = _ordered(coefficient, *ends)
                low, high = low + least_end, high + greatest_end
        return low, high

    def __str__(self) -> str:
        text = "".join(_term(name, coefficient) for name, coefficient in self.terms)
        if self.constant or not text:
            text += f" {'-' if self.constant < 0 else '+'} {abs(self.constant):.12g}"
        text = text.strip()
        return text[2:] if text.startswith("+ ") else text.replace("- ", "-", 1) if text.startswith("- ") else text


def _ordered(coefficient: float, first: float, second: float) -> tuple[float, float]:
    """Products of a coefficient with the ends of an interval, the lesser one first."""
    if coefficient > 0:
        return first, second
    if coefficient < 0:
        return second, first
    return least(first, second), greatest(first, second)  # the sign of a parameter without value is open


def _term(name: str, coefficient: float) -> str:
    sign = "-" if coefficient < 0 else "+"
    size = abs(coefficient)
    return f" {sign} {name}" if size == 1 else f" {sign} {size:.12g}*{name}"
