"""Propagation by the compiled kernel, with the interface of the vectorised one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.optimize.propagation import Box, PropagationSettings, Propagator

__all__ = ["CompiledPropagator", "propagator"]

Vector = NDArray[np.float64]
Indices = NDArray[np.intp]


def propagator(A: Any, integers: Indices, settings: PropagationSettings) -> Propagator | CompiledPropagator:
    """The faster of the two: the kernel where it is compiled, else the vectorised one."""
    return (CompiledPropagator if kernels_are_compiled() else Propagator)(A, integers, settings)


class CompiledPropagator:
    """Propagation over fixed coefficients, row after row; see :class:`hysdel_py.optimize.propagation.Propagator`.

    Parameters
    ----------
    A : sparse array of shape (m, n)
    integers : array of int
    settings : PropagationSettings, optional
    """

    def __init__(self, A: Any, integers: Indices, settings: PropagationSettings | None = None) -> None:
        from scipy.sparse import csc_array, csr_array

        rows = csr_array(A)
        rows.eliminate_zeros()
        columns = csc_array(rows)
        s = self.settings = settings or PropagationSettings()
        self.m, self.n = rows.shape
        self._rows = (rows.indptr.astype(np.int64), rows.indices.astype(np.int64), rows.data.astype(float))
        self.columns = (columns.indptr.astype(np.int64), columns.indices.astype(np.int64))
        self._integer = np.zeros(self.n, dtype=np.bool_)
        self._integer[integers] = True
        self._numbers = (s.margin, s.integrality, s.progress, s.huge, s.rounds)

    def warm_up(self) -> None:
        """Load or compile the kernel now, so that the first search does not have to wait for it."""
        zeros, sides = np.zeros(self.n), np.zeros(self.m)
        self.propagate(zeros, zeros.copy(), sides - np.inf, sides + np.inf, np.zeros(0, dtype=np.intp))

    def propagate(
        self,
        lb: Vector,
        ub: Vector,
        l: Vector,  # noqa: E741
        u: Vector,
        changed: Indices | None = None,
    ) -> Box:
        """Shrink the box; see :meth:`hysdel_py.optimize.propagation.Propagator.propagate`."""
        from hysdel_py.optimize.kernels.propagation import propagate

        s = self.settings
        low = np.where(self._integer, np.ceil(lb - s.integrality), lb)
        high = np.where(self._integer, np.floor(ub + s.integrality), ub)
        conflict = self._crossed(low, high)
        if conflict is None and changed is None:
            conflict = self._empty_row(l, u)
        if conflict is not None:
            return Box(low, high, conflict, 0)
        queued = self._queue(changed)
        found, rounds = propagate(self._rows, self.columns, self._integer, (low, high), (l, u), queued, self._numbers)
        return Box(low, high, None if found < 0 else int(found), int(rounds))

    def _queue(self, changed: Indices | None) -> NDArray[np.bool_]:
        if changed is None:
            return np.ones(self.m, dtype=np.bool_)
        queued = np.zeros(self.m, dtype=np.bool_)
        start, row = self.columns
        for variable in changed:
            queued[row[start[variable] : start[variable + 1]]] = True
        return queued

    def _crossed(self, low: Vector, high: Vector) -> int | None:
        return self.m if np.any(high - low < -self.settings.margin * (1.0 + np.abs(low))) else None

    def _empty_row(self, l: Vector, u: Vector) -> int | None:  # noqa: E741
        """A row with crossed sides, or one without coefficients whose sides exclude zero."""
        margin = self.settings.margin
        bad = l > u + margin * (1 + np.abs(u))
        bad |= (np.diff(self._rows[0]) == 0) & ((l > margin) | (u < -margin))
        return int(bad.argmax()) if bad.any() else None
