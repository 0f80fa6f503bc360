"""The multi-parametric quadratic program as it is stated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.parametric.objective import ParametricObjective

__all__ = ["MpQp"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_SYMMETRY = 1e-9
"""Relative difference up to which H counts as symmetric."""


@dataclass(frozen=True, eq=False)
class MpQp:
    """A quadratic or linear program whose vectors are affine in parameters; the arrays are read-only.

    ``min 1/2 z'H z + (f + F theta)'z + 1/2 theta'Y theta + y'theta + constant`` subject to ``G z <= w + S theta`` and
    ``E z = e + D theta``, for theta in a polyhedron.

    Attributes
    ----------
    H : array of shape (n, n)
        Symmetric, positive semidefinite; zero for a linear program.
    f : array of shape (n,)
    F : array of shape (n, p)
    G : array of shape (m, n)
    w : array of shape (m,)
        An infinite side is a row that never matters.
    S : array of shape (m, p)
    theta : Polyhedron
        The parameters of interest; bounded, with inner points.
    E, e, D : arrays of shapes (q, n), (q,), (q, p), optional
        Equalities.
    Y, y, constant : arrays of shapes (p, p), (p,) and a number, optional
        What the objective adds to the value whatever z is.

    Raises
    ------
    ArgumentError
        A wrong shape, an entry that is not finite, or a Hessian that is not symmetric.
    """

    H: Matrix
    f: Vector
    F: Matrix
    G: Matrix
    w: Vector
    S: Matrix
    theta: Polyhedron
    E: Matrix | None = None
    e: Vector | None = None
    D: Matrix | None = None
    Y: Matrix | None = None
    y: Vector | None = None
    constant: float = 0.0

    def __post_init__(self) -> None:
        n, p, m = len(np.atleast_1d(self.f)), self.theta.n, len(np.atleast_1d(self.w))
        q = 0 if self.e is None else len(np.atleast_1d(self.e))
        shapes = {"H": (n, n), "f": (n,), "F": (n, p), "G": (m, n), "w": (m,), "S": (m, p), "E": (q, n), "e": (q,),
                  "D": (q, p), "Y": (p, p), "y": (p,)}  # fmt: skip
        for name, shape in shapes.items():
            object.__setattr__(self, name, _array(name, getattr(self, name), shape))
        object.__setattr__(self, "constant", float(self.constant))
        H = self.H
        if np.max(np.abs(H - H.T), initial=0.0) > _SYMMETRY * np.max(np.abs(H), initial=1.0):
            raise ArgumentError("H is not symmetric: pass (H + H')/2, the objective stays the same")

    @property
    def n(self) -> int:
        """Number of variables."""
        return len(self.f)

    @property
    def p(self) -> int:
        """Number of parameters."""
        return self.theta.n

    @property
    def m(self) -> int:
        """Number of inequalities."""
        return len(self.w)

    @property
    def objective(self) -> ParametricObjective:
        """The objective, apart from the constraints."""
        assert self.Y is not None
        assert self.y is not None
        return ParametricObjective(self.H, self.f, self.F, self.Y, self.y, self.constant)

    def value(self, z: Vector, theta: Vector) -> float:
        """Objective at a point."""
        return self.objective.value(z, theta)


def _array(name: str, value: Any, shape: tuple[int, ...]) -> Any:
    """A read-only copy of the expected shape; zeros for what was not given."""
    array = np.zeros(shape) if value is None else np.array(value, dtype=float)
    if array.shape != shape:
        raise ArgumentError(f"{name} has shape {array.shape}: {shape} was expected")
    if np.isnan(array).any() or (name != "w" and not np.isfinite(array).all()) or np.any(array == -np.inf):
        raise ArgumentError(f"{name} has an entry that is not finite")
    array.setflags(write=False)
    return array
