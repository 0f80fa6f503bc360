"""The multi-parametric mixed-integer program, over parameters and decision variables at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["MpMiqp"]

Vector = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class MpMiqp:
    """``min 1/2 w'H w + g'w + constant`` over ``w = (theta, v)`` for every theta, some entries of w being 0 or 1.

    Subject to ``l <= A w <= u`` and ``lb <= w <= ub``. The arrays are read-only.

    Attributes
    ----------
    H : sparse array of shape (n, n)
        Symmetric; positive semidefinite in v. Zero for a linear program.
    g : array of shape (n,)
    constant : float
    A : sparse array of shape (m, n)
    l, u : arrays of shape (m,)
    lb, ub : arrays of shape (n,)
        Finite for the parameters.
    parameters : int
        The first so many entries of w are the real parameters theta.
    binaries : array of int
        Entries that are 0 or 1, in the order in which they are decided, stage by stage. A Boolean parameter is one of
        them.
    stages : array of int
        Stage of each binary, rising from 0 without gaps.
    reach : array of shape (n,)
        Stage after which an entry is settled; a row belongs to the last stage of its entries.

    Raises
    ------
    ArgumentError
        Shapes that do not fit, no parameter, or one without ends.
    """

    H: Any
    g: Vector
    constant: float
    A: Any
    l: Vector  # noqa: E741  the name of the lower sides in all programs here
    u: Vector
    lb: Vector
    ub: Vector
    parameters: int
    binaries: Indices
    stages: Indices
    reach: Indices

    def __post_init__(self) -> None:
        m, n = self.A.shape
        shapes = {"H": (n, n), "g": (n,), "l": (m,), "u": (m,), "lb": (n,), "ub": (n,), "reach": (n,),
                  "stages": np.shape(self.binaries)}  # fmt: skip
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise ArgumentError(f"{name} has shape {getattr(self, name).shape}: {shape} was expected")
        if self.parameters < 1:
            raise ArgumentError("there is no real parameter: the program can be solved as it is")
        ends = np.concatenate([self.lb[: self.parameters], self.ub[: self.parameters]])
        if not np.isfinite(ends).all():
            raise ArgumentError("a parameter has no end: a bounded box of parameters was expected")

    @property
    def n(self) -> int:
        """Number of entries of w."""
        return len(self.g)

    def decided(self, stages: int) -> int:
        """Number of binaries in the first so many stages."""
        return int(np.searchsorted(self.stages, stages))
