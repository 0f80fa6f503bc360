"""What a solver for convex quadratic programs has to offer."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.qp import Qp, QpResult

__all__ = ["QpBackend", "QpWorkspace"]

Vector = NDArray[np.float64]


class QpWorkspace(Protocol):
    """A solver that has seen the matrices; it solves again and again with other vectors."""

    def solve(
        self,
        q: Vector | None = None,
        *,
        l: Vector | None = None,  # noqa: E741
        u: Vector | None = None,
        lb: Vector | None = None,
        ub: Vector | None = None,
        x0: Vector | None = None,
        y0: Vector | None = None,
    ) -> QpResult:
        """Replace the given vectors, for this and all later calls, and solve.

        ``x0`` and ``y0`` are a guess of the solution, which a solver that cannot use one ignores. Trouble is a status
        of the result, never an exception.
        """
        ...


class QpBackend(Protocol):
    """A named solver."""

    @property
    def name(self) -> str:
        """Name in the registry."""
        ...

    def workspace(self, qp: Qp) -> QpWorkspace:
        """Set the solver up for a problem."""
        ...
