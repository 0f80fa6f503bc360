"""Relaxations of nodes by the dense kernels: condensed to few variables, solved by a dual active-set method.

Matrices, groups of parallel rows and the pattern of the Hessian are prepared once; a node costs some tens of
microseconds where numba is installed.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.optimize.backends.answer import checked_result, failed_result
from hysdel_py.optimize.mixed_integer import KERNELS, Miqp
from hysdel_py.optimize.qp import Qp, QpResult, QpSettings, QpStatus
from hysdel_py.optimize.reduction import parallel_groups

__all__ = ["Active", "DenseSettings", "DenseSolver", "dense_solver"]

Vector = NDArray[np.float64]
Indices = NDArray[np.int64]
Active = NDArray[np.int64]

SEED = 1983


@dataclass(frozen=True, slots=True)
class DenseSettings:
    """Effort and accuracy of the dense solver.

    Attributes
    ----------
    tolerance : float
        A row of unit length may be missed by this much, relative to its side and at least absolute.
    iterations : int
        Largest number of changes of the active set in one node.
    proximity : float
        Weight of the proximal term, relative to the typical curvature; it makes a singular Hessian definite.
    rounds : int
        Largest number of proximal steps.
    largest : int
        Nodes with more free variables are left to the sparse solvers.
    """

    tolerance: float = 1e-10
    iterations: int = 500
    proximity: float = 1e-7
    rounds: int = 10
    largest: int = 150


@dataclass(slots=True)
class DenseSolver:
    """The dense solver for one set of matrices.

    Attributes
    ----------
    qp : Qp
        Its matrices count; the vectors come with each call.
    integer : array of bool, shape (n,)
    settings : DenseSettings
    P, rows, groups : tuples of arrays
        Hessian and rows, compressed, and the groups of parallel rows, as the kernels want them.
    """

    qp: Qp
    integer: NDArray[np.bool_]
    settings: DenseSettings = field(default_factory=DenseSettings)
    P: Any = field(init=False)
    rows: Any = field(init=False)
    groups: Any = field(init=False)

    def __post_init__(self) -> None:
        from scipy.sparse import csr_array

        rows = csr_array(self.qp.A)
        rows.eliminate_zeros()
        self.rows, self.P = _compressed(rows), _compressed(csr_array(self.qp.P))
        self.groups = (*_parallel_rows(rows, self.integer), self.integer)

    def warm_up(self) -> None:
        """Load or compile the kernels now, so that the first node does not have to wait for them."""
        low = np.clip(0.0, self.qp.lb, self.qp.ub)
        self.solve(self.qp, (low, low.copy()), None, QpSettings())

    def solve(
        self, qp: Qp, box: tuple[Vector, Vector], guess: Active | None, settings: QpSettings
    ) -> tuple[QpResult, Active]:
        """Solve a node.

        Parameters
        ----------
        qp : Qp
            Matrices of the constructor, any vectors.
        box : pair of arrays
            Implied bounds.
        guess : array of shape (rows, 2), optional
            What an earlier call returned, for a similar node.

        Returns
        -------
        answer, active
            NUMERICAL where the kernel gives up.
        """
        from hysdel_py.optimize.kernels.node import solve_node

        start = perf_counter()
        s = self.settings
        problem = (self.P, qp.q, self.rows, qp.l, qp.u, self.integer)
        status, iterations, w, y, active = solve_node(
            problem,
            self.groups,
            box,
            (qp.lb, qp.ub),
            (NO_GUESS if guess is None else guess, np.zeros(0)),
            (np.inf, 0.0, np.zeros(0), 0.0),
            (s.tolerance, s.iterations, s.proximity, s.rounds, s.largest),
        )
        seconds = perf_counter() - start
        claim = _STATUS.get(status, QpStatus.NUMERICAL)
        if claim is not QpStatus.OPTIMAL:
            result = failed_result(qp, claim, "dense active set")
            return _with_ray(result, y, iterations, seconds), active
        z = -(qp.P @ w + qp.q + qp.At @ y)
        word = f"dense active set, {len(active)} active"
        answer = checked_result(
            qp, settings, claim, x=w, y=y, z=z, iterations=iterations, seconds=seconds, word=word
        )  # fmt: skip
        return answer, active


NO_GUESS: Active = np.zeros((0, 2), dtype=np.int64)
_STATUS = {0: QpStatus.OPTIMAL, 1: QpStatus.INFEASIBLE, 3: QpStatus.ITERATION_LIMIT}


def dense_solver(miqp: Miqp, backend: str) -> DenseSolver | None:
    """The dense solver if it is wanted: always for "dense", for "auto" where the kernels are compiled."""
    if backend not in KERNELS or (backend == "auto" and not kernels_are_compiled()):
        return None
    integer = np.zeros(miqp.qp.n, dtype=bool)
    integer[miqp.binaries] = True
    return DenseSolver(miqp.qp, integer)


def _with_ray(result: QpResult, y: Vector, iterations: int, seconds: float) -> QpResult:
    return replace(result, y=y, iterations=iterations, seconds=seconds)


def _compressed(matrix: Any) -> tuple[Indices, Indices, Vector]:
    matrix.sort_indices()
    return matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64), matrix.data.astype(float)


def _parallel_rows(rows: Any, integer: NDArray[np.bool_]) -> tuple[Indices, Indices, Vector]:
    """Groups of rows whose parts in the real variables are parallel: starts, members, scales.

    Parallel rows are found by their products with random vectors, whose ratios do not depend on the scale of a row.
    """
    random = np.random.default_rng(SEED).uniform(1.0, 2.0, (rows.shape[1], 3)) * ~integer[:, None]
    with_part = np.flatnonzero((abs(rows) @ (~integer).astype(float)) > 0)
    products = (rows @ random)[with_part]
    group, one = parallel_groups(products) if len(with_part) else (with_part, with_part)
    lowest = np.full(len(one), len(with_part))
    np.minimum.at(lowest, group, np.arange(len(with_part)))
    members = np.lexsort((np.arange(len(with_part)), lowest[group]))  # groups by their first rows
    count = np.bincount(group, minlength=len(one))[group[np.sort(lowest)]] if len(one) else group
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    scale = products[members, 0] / products[lowest[group[members]], 0]
    return start, with_part[members].astype(np.int64), scale
