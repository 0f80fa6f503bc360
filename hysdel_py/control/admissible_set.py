"""The states from which a stable linear system keeps its limits for ever.

E. Gilbert and K. Tan, "Linear systems with state and control constraints: the theory and application of maximal
output admissible sets", IEEE Trans. Automatic Control 36, 1991: O_t = {x : H A^k x <= h, k = 0..t} is the greatest such
set as soon as the rows H A^(t+1) are redundant in it, which happens for a finite t if A is stable and 0 lies inside the
limits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.lqr import spectral_radius
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["maximal_admissible_set"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_ROOM = 1e-9
"""A row is redundant if the set exceeds it by less, relative to 1 and its side."""
MAX_STEPS = 1000
"""Longest run that is looked at."""


def maximal_admissible_set(A: Matrix, limits: Polyhedron) -> Polyhedron:
    """Return the greatest set of states whose whole future under ``x+ = A x`` lies in the limits.

    Parameters
    ----------
    A : array of shape (n, n)
        Stable.
    limits : Polyhedron
        With the origin inside.

    Returns
    -------
    Polyhedron
        With irredundant rows.

    Raises
    ------
    ArgumentError
        A is not stable, or the origin is on or outside a limit.
    """
    radius = spectral_radius(A)
    if radius >= 1:
        raise ArgumentError(
            f"no invariant set: the closed loop is not stable (spectral radius {radius:.6g}); give a stabilising gain"
        )
    outside = np.flatnonzero(limits.b <= 0)
    if len(outside):
        raise ArgumentError(
            f"no invariant set: the origin is not strictly inside the limits (row {outside[0]} has the side "
            f"{limits.b[outside[0]]:g}); a regulator to the origin needs 0 inside all its limits"
        )
    found, rows = limits, limits.A
    for _ in range(MAX_STEPS):
        rows = rows @ A
        new = [i for i, row in enumerate(rows) if _cuts(found, row, limits.b[i])]
        if not new:
            return found.minimal()
        found = found.with_rows(rows[new], limits.b[new])
    raise ArgumentError(
        f"no invariant set within {MAX_STEPS} steps: the closed loop is too slow (spectral radius {radius:.6g})"
    )


def _cuts(found: Polyhedron, row: Vector, side: float) -> bool:
    """Whether some point of the set exceeds a row."""
    if not row.any():
        return False
    answer = found.maximise(row)
    return not answer.is_optimal or answer.value > side + _ROOM * max(1.0, abs(side))
