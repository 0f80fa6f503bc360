"""Tolerances and limits of the exploration in one frozen object."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["MpQpSettings"]


@dataclass(frozen=True, slots=True)
class MpQpSettings:
    """What counts as a region, and when to stop.

    All tolerances refer to the scaled problem: theta in [-1, 1], rows of length one.

    Attributes
    ----------
    radius : float
        A region holds a ball of this radius; a facet keeps this distance from all others somewhere.
    violation : float
        A row holds if it is exceeded by less.
    angle : float
        Sine of the least angle at which a row counts as independent of others.
    exchange : float
        The same where a row enters an active set.
    zero : float
        An affine function whose coefficients are smaller, relative to its terms, is constant.
    same : float
        Two rows that differ by less are one facet.
    curvature : float
        Eigenvalues of H below this share of the greatest one are zero.
    tie : float
        Size of the perturbation that breaks ties when a single point is solved.
    regions : int
        Stop after so many regions.
    seconds : float
        Stop after so many seconds.
    chunk : int
        Active sets handed to an executor at a time.
    thorough : bool
        Whether every inner facet must be covered by what was found beyond it, not only where the exchange of rows
        leaves it open.
    """

    radius: float = 1e-9
    violation: float = 1e-11
    angle: float = 1e-10
    exchange: float = 1e-8
    zero: float = 1e-11
    same: float = 1e-9
    curvature: float = 1e-12
    tie: float = 1e-9
    regions: int = 1_000_000
    seconds: float = inf
    chunk: int = 32
    thorough: bool = False

    def __post_init__(self) -> None:
        for name in self.__slots__:
            if name != "thorough" and not getattr(self, name) > 0:
                raise ArgumentError(f"{name} is {getattr(self, name)}: a positive number was expected")

    @property
    def margins(self) -> NDArray[np.float64]:
        """Distances tried for inner points, falling to the radius."""
        steps: list[Any] = [size for size in (1e-2, 1e-3, 1e-5, 1e-7) if size > self.radius]
        return np.array([*steps, self.radius])
