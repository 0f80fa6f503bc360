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
    """

    lp: float = 1e-9
    empty: float = 1e-8
    redundant: float = 1e-9


DEFAULT_PRECISION = Precision()
