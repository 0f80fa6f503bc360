"""All tolerances of the geometry in one frozen object."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DEFAULT_PRECISION", "Precision"]


@dataclass(frozen=True, slots=True)
class Precision:
    """Tolerances of linear programs and of what polyhedra say.

    Attributes
    ----------
    lp : float
        A linear program is solved when its value and its dual bound differ by less than this, relative to 1 and the
        value, and its rows of unit length are violated by less.
    empty : float
        A polyhedron whose inscribed ball has a radius below the negative of this is empty, and one with a radius below
        this is flat. It must stay below half the gap of a threshold over the length of its normal.
    redundant : float
        A row that is exceeded by less than this (for a normal of unit length) without it is redundant.
    touch : float
        A set whose rows can all be met up to this much, in their own units, has a point. It must stay well below the
        gap of a threshold.
    interior : float
        A ball of this radius, relative to the ranges of the coordinates, proves that a set has inner points.
    parallel : float
        Unit normals that differ by less than this belong to parallel rows.
    """

    lp: float = 1e-9
    empty: float = 1e-8
    redundant: float = 1e-9
    touch: float = 1e-9
    interior: float = 1e-6
    parallel: float = 1e-12


DEFAULT_PRECISION = Precision()
