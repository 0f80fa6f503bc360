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
        A state or input may leave its range by this much, relative to the end that it passes and at least absolute.
    row : float
        A row of the MLD form counts as satisfied up to this much (absolute). It must stay well below the epsilon of
        the thresholds (1e-6), or both values of an event pass at its threshold.
    rounding : float
        What floating-point sums may be wrong by, relative to the size of their terms; added to `row`.
    unique : float
        Two values of an auxiliary that differ by less than this are the same.
    """

    range: float = 1e-9
    row: float = 1e-9
    rounding: float = 1e-14
    unique: float = 1e-7


DEFAULT_TOLERANCES = Tolerances()
