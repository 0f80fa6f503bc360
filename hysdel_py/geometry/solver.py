"""Linear programs that are counted."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from hysdel_py.geometry.lp import LpResult, maximise
from hysdel_py.geometry.precision import DEFAULT_PRECISION, Precision

__all__ = ["LpSolver"]


class LpSolver:
    """Solves linear programs and counts them, so that an exploration can say what it cost.

    Attributes
    ----------
    precision : Precision
    solved : int
        Linear programs so far.
    """

    def __init__(self, precision: Precision = DEFAULT_PRECISION) -> None:
        self.precision = precision
        self.solved = 0

    def maximise(self, c: ArrayLike, A: Any, b: ArrayLike, lb: ArrayLike, ub: ArrayLike) -> LpResult:
        """As :func:`hysdel_py.geometry.lp.maximise`."""
        self.solved += 1
        return maximise(c, A, b, lb, ub, precision=self.precision)

    def maximise_exactly(self, c: ArrayLike, A: Any, b: ArrayLike, lb: ArrayLike, ub: ArrayLike) -> LpResult:
        """The same at a vertex, where the last digits decide."""
        self.solved += 1
        return maximise(c, A, b, lb, ub, precision=self.precision, vertex=True)
