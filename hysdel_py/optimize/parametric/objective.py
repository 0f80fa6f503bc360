"""The objective of a multi-parametric program, apart from its constraints."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ParametricObjective"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Positions = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class ParametricObjective:
    """``1/2 z'H z + (f + F theta)'z + 1/2 theta'Y theta + y'theta + constant``; the arrays are read-only.

    Attributes
    ----------
    H : array of shape (n, n)
    f : array of shape (n,)
    F : array of shape (n, p)
    Y : array of shape (p, p)
    y : array of shape (p,)
    constant : float
    """

    H: Matrix
    f: Vector
    F: Matrix
    Y: Matrix
    y: Vector
    constant: float = 0.0

    def __post_init__(self) -> None:
        for array in self.arrays().values():
            array.setflags(write=False)

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """The coefficients by name, without the constant."""
        return {item.name: getattr(self, item.name) for item in fields(self) if item.name != "constant"}

    def value(self, z: Vector, theta: Vector) -> float:
        """Objective at a point."""
        own = 0.5 * theta @ self.Y @ theta + self.y @ theta + self.constant
        return float(0.5 * z @ self.H @ z + (self.f + self.F @ theta) @ z + own)

    def fixed(self, free: Positions, given: Positions, at: Vector) -> ParametricObjective:
        """The same objective with some parameters put in.

        Parameters
        ----------
        free, given : int arrays
            Positions of the parameters that stay, and of those with a value.
        at : array of shape (len(given),)
            The values.
        """
        own = 0.5 * at @ self.Y[np.ix_(given, given)] @ at + self.y[given] @ at
        across = 0.5 * (self.Y[np.ix_(free, given)] + self.Y[np.ix_(given, free)].T)
        return replace(
            self,
            f=self.f + self.F[:, given] @ at,
            F=self.F[:, free],
            Y=self.Y[np.ix_(free, free)],
            y=self.y[free] + across @ at,
            constant=float(self.constant + own),
        )

    def to_dict(self) -> dict[str, Any]:
        """Plain lists and numbers."""
        return {name: array.tolist() for name, array in self.arrays().items()} | {"constant": float(self.constant)}
