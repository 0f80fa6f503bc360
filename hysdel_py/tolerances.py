"""All numerical tolerances in one frozen object that is passed down."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DEFAULT_TOLERANCES", "Tolerances"]


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Numerical tolerances of simulation and of the model forms.

    Attributes
    ----------
    range : float
        A state, input or auxiliary may leave its range by this much (absolute, plus relative to the range's ends).
    row : float
        A row of the MLD form counts as satisfied up to this much, relative to the size of its terms and at least
        absolute. It must stay well below the epsilon of the thresholds (1e-6).
    unique : float
        Two values of an auxiliary that differ by less than this are the same.
    """

    range: float = 1e-9
    row: float = 1e-9
    unique: float = 1e-7


DEFAULT_TOLERANCES = Tolerances()
