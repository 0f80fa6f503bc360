"""How close two values are the same, and how far from a threshold a statement holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import Event
from hysdel_py.tolerances import DEFAULT_TOLERANCES, Tolerances

__all__ = ["Margins", "largest"]

Ranges = Mapping[str, tuple[float, float]]

_STEPS_SEE = 10.0  # a row has to be violated by that many of its tolerances before the step of an Mld must see it


@dataclass(frozen=True, slots=True)
class Margins:
    """What counts as a difference, and where.

    Attributes
    ----------
    band : float
        Statements hold where the form of no event is nearer to zero than this, relative to the greatest size of its
        terms, and on the false side not nearer than its epsilon.
    tolerance : float
        A row is violated, or two values differ, if it is by more than this, relative to the greatest size of the terms.
    steps : Tolerances
        What the steps of the forms cannot see is no difference either.
    """

    band: float = 1e-5
    tolerance: float = 1e-6
    steps: Tolerances = DEFAULT_TOLERANCES

    def __post_init__(self) -> None:
        for name, value in (("band", self.band), ("tolerance", self.tolerance)):
            if not 0.0 < value < 1.0:
                raise ArgumentError(f"{name} is {value:g}: a number above 0 and below 1 was expected")

    def beside(self, event: Event, ranges: Ranges) -> float:
        """Half width of the band around the threshold of an event."""
        return max(event.epsilon, self.band * largest(event.form, ranges))

    def below(self, event: Event, ranges: Ranges) -> float:
        """How far to stay away on the true side; no more than the range of the form allows at all."""
        return min(self.beside(event, ranges), max(0.0, -event.form.range(ranges.__getitem__)[0]))

    def violation(self, form: Affine, ranges: Ranges) -> float:
        """By how much a row ``form <= 0`` has to be exceeded."""
        return max(self.tolerance * largest(form, ranges), _STEPS_SEE * self.steps.row)

    def distance(self, form: Affine, ranges: Ranges) -> float:
        """By how much two values of a form have to differ."""
        size = largest(form, ranges)
        return max(self.tolerance * size, _STEPS_SEE * self.steps.rounding * size)

    def apart(self, name: str, ranges: Ranges) -> float:
        """By how much two values of a real auxiliary have to differ that the same rows allow."""
        size = max(abs(end) for end in ranges[name])
        return max(self.tolerance * size, 2.0 * self.steps.unique * (1.0 + size))


def largest(form: Affine, ranges: Ranges) -> float:
    """Greatest size of the terms of a form; endless terms are left out."""
    sizes = [abs(form.constant)]
    sizes += [abs(c) * max(map(abs, ranges[name])) for name, c in form.terms if c and all(map(isfinite, ranges[name]))]
    return max(sizes)
