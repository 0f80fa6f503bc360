"""Compile the kernels of the branch and bound before they are needed."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.optimize.mixed_integer import Miqp, MiqpSettings
from hysdel_py.optimize.qp import Qp

__all__ = ["warm_up"]


def warm_up() -> float:
    """Compile the kernels of the hybrid controllers, or load them from the cache of an earlier call.

    Building a controller does the same, so that its first answer does not have to wait. Compiled code is kept on disk
    (``NUMBA_CACHE_DIR`` says where), so that this takes long once per installation. Without numba there is nothing to
    do.

    Returns
    -------
    float
        Seconds that it took.

    Examples
    --------
    >>> seconds = warm_up()
    """
    begin = perf_counter()
    if kernels_are_compiled():
        from hysdel_py.optimize.miqp import MiqpSolver

        MiqpSolver(_problem(), MiqpSettings(backend="dense"))
    return perf_counter() - begin


def _problem() -> Miqp:
    """Least ``(x - 0.4)^2`` with x at most the binary d, and d at most x + 1/2."""
    sides = np.array([-np.inf, -np.inf]), np.array([0.0, 0.5])
    slope, ends = np.array([-0.8, 0.1]), (np.zeros(2), np.ones(2))
    qp = Qp(np.diag([2.0, 0.0]), slope, [[1.0, -1.0], [-1.0, 1.0]], *sides, *ends, constant=0.16)
    return Miqp(qp, [1], drivers=[0])
