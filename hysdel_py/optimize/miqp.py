"""Branch and bound for convex quadratic programs with binary variables.

Depth first, the nearer child first. Each node is propagated, relaxed and bounded by a certificate; a node is dropped
only if its certified bound reaches the incumbent or if its emptiness is proven. A point becomes the incumbent only
after its binaries were fixed at exactly 0 and 1, the remaining problem was solved and all rows were checked.

Source: A. H. Land and A. G. Doig, "An automatic method of solving discrete programming problems", Econometrica 28,
1960; for predictive control A. Bemporad, D. Mignone, M. Morari, "An efficient branch and bound algorithm for state
estimation and control of hybrid systems", ECC 1999. ``docs/branch-and-bound.md`` tells the whole story.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.backends.registry import get_backend
from hysdel_py.optimize.binary_squares import without_binary_squares
from hysdel_py.optimize.compiled_propagation import CompiledPropagator, propagator
from hysdel_py.optimize.compiled_search import CompiledSearch, Hints
from hysdel_py.optimize.dense import dense_solver
from hysdel_py.optimize.heuristics import Guesser
from hysdel_py.optimize.mixed_integer import Cover, Miqp, MiqpResult, MiqpSettings, MiqpStatus, SearchInfo
from hysdel_py.optimize.qp import Qp
from hysdel_py.optimize.search import Search
from hysdel_py.optimize.verified import VerifiedSolver
from hysdel_py.optimize.workspace import Workspace

__all__ = ["Miqp", "MiqpResult", "MiqpSettings", "MiqpSolver", "MiqpStatus", "SearchInfo", "solve_miqp"]

Vector = NDArray[np.float64]
Heuristic = Callable[[Vector, Vector, Vector], Any]
Progress = Callable[[SearchInfo], bool | None]


class MiqpSolver:
    """Branch and bound over one set of matrices; the work spaces are built once and serve all calls.

    Parameters
    ----------
    miqp : Miqp
    settings : MiqpSettings, optional

    Raises
    ------
    ArgumentError
        Unknown back end.
    """

    def __init__(self, miqp: Miqp, settings: MiqpSettings | None = None) -> None:
        self.miqp = miqp
        self.settings = settings or MiqpSettings()
        self.program, self._shift = without_binary_squares(miqp)
        self._within_bounds = False
        self._within_bounds = self._problem(self.program.qp) is self.program.qp
        get_backend(self.settings.solver, self.settings.qp)
        dense = dense_solver(self.program, self.settings.backend)
        self.verified = VerifiedSolver(self.program.qp, self.settings.solver, self.settings.qp, dense=dense)
        self.propagator = propagator(miqp.qp.A, miqp.binaries, self.settings.propagation)
        self.guesser = Guesser.of(miqp, self.propagator)
        self.workspace: Workspace | None = None
        if self.verified.dense is not None:
            columns = CompiledPropagator(miqp.qp.A, miqp.binaries, self.settings.propagation).columns
            self.workspace = Workspace(self.program, self.settings, self.verified.dense, columns)
            if kernels_are_compiled():
                CompiledSearch(self, self._problem(self.program.qp), perf_counter(), None, None).rehearse()

    def solve(
        self,
        q: ArrayLike | None = None,
        *,
        l: ArrayLike | None = None,  # noqa: E741
        u: ArrayLike | None = None,
        lb: ArrayLike | None = None,
        ub: ArrayLike | None = None,
        constant: float | None = None,
        floor: float = -inf,
        incumbent: ArrayLike | None = None,
        point: ArrayLike | None = None,
        active: NDArray[np.int64] | None = None,
        pseudo_costs: Vector | None = None,
        cover: Cover | None = None,
        heuristic: Heuristic | None = None,
        progress: Progress | None = None,
    ) -> MiqpResult:
        """Search for the optimum.

        Parameters
        ----------
        q, l, u, lb, ub : arrays, optional
            Vectors in place of those of the problem, for this call.
        constant : float, optional
            Constant of the objective, for this call.
        floor : float
            A lower bound of the objective that the caller knows.
        incumbent : array of shape (n,) or (number of binaries,), optional
            Guess of the solution; only its binaries are used, rounded, and the rest is solved for.
        point : array of shape (n,), optional
            A point whose drivers may be good ones: they are pushed through the rows to give the binaries of a first
            solution. Only the dense kernels use it.
        active : array of shape (rows, 2), optional
            Rows, or m + variable, and signs of their sides that may be active at the relaxed solution. Only the dense
            kernels use it; an earlier result has it as ``active``.
        pseudo_costs : array of shape (n, 4), optional
            What the search of a similar problem has learnt; an earlier result has it as ``pseudo_costs``. It chooses
            where nodes are split. Only the dense kernels use it.
        cover : Cover, optional
            Parts of the problem that the search opens once it has looked at the root, in place of the halves of the
            root; together they have to hold every word of binaries. An earlier result has it as ``cover``. Bounds
            are computed anew from its points and multipliers. Only the dense kernels use it.
        heuristic : callable, optional
            ``heuristic(x, lb, ub)`` gets a relaxed point and the bounds of its node, arrays of length n, and returns
            one vector of binary values, several as rows, or None.
        progress : callable, optional
            Called with a :class:`SearchInfo` after each node; the search stops when it returns False.

        Returns
        -------
        MiqpResult
            ``bound <= optimum <= objective`` whatever the status, the second up to the feasibility tolerance.

        Raises
        ------
        ArgumentError
            A vector of the wrong shape, also one that the heuristic gave; pseudo-costs or a cover of another program.
        """
        start = perf_counter()
        qp = self._problem(self.program.qp.with_vectors(q, l=l, u=u, lb=lb, ub=ub, constant=constant))
        if q is not None and self._shift.any():
            qp = qp.with_vectors(qp.q + self._shift)
        if self.workspace is not None:
            self._check_experience(pseudo_costs, cover)
            self._check_active(active)
            hints = Hints(floor, self._guess(incumbent), self._point(point), active, pseudo_costs, cover)
            return CompiledSearch(self, qp, start, heuristic, progress).run(hints)
        search = Search(self, qp, start)
        search.heuristic, search.known = heuristic, floor
        search.open_root()
        search.try_guess(self._guess(incumbent))
        while search.stack:
            search.explore(search.stack.pop())
            stop = search.reason_to_stop(progress)
            if stop is not None:
                return search.stopped(stop)
        return search.finished()

    def _problem(self, qp: Qp) -> Qp:
        """Cut the bounds of the binaries to [0, 1]."""
        if qp.lb is self.program.qp.lb and qp.ub is self.program.qp.ub and self._within_bounds:
            return qp
        at = self.miqp.binaries
        if (qp.lb[at] >= 0.0).all() and (qp.ub[at] <= 1.0).all():
            return qp
        lb, ub = qp.lb.copy(), qp.ub.copy()
        lb[at], ub[at] = np.maximum(lb[at], 0.0), np.minimum(ub[at], 1.0)
        return qp.with_vectors(lb=lb, ub=ub)

    def _check_experience(self, pseudo_costs: Vector | None, cover: Cover | None) -> None:
        """Refuse what an earlier search of a program of another size has handed on."""
        n, m, count = self.miqp.qp.n, self.miqp.qp.m, len(self.miqp.binaries)
        if pseudo_costs is not None and pseudo_costs.shape != (n, 4):
            raise ArgumentError(f"pseudo_costs has shape {pseudo_costs.shape}: ({n}, 4) was expected")
        if cover is None:
            return
        ends = len(cover.lengths)
        expected = (ends, count), (ends,), (ends, n), (ends, m), (ends,)
        if tuple(array.shape for array in cover.arrays()) != expected:
            raise ArgumentError(f"cover is not one of a program with {n} variables, {m} rows and {count} binaries")

    def _check_active(self, active: NDArray[np.int64] | None) -> None:
        """Refuse active inequalities of a program of another size."""
        if active is None:
            return
        if np.ndim(active) != 2 or active.shape[1] != 2:
            raise ArgumentError(f"active has shape {np.shape(active)}: (rows, 2) was expected")
        most = self.miqp.qp.m + self.miqp.qp.n
        if ((active[:, 0] < 0) | (active[:, 0] >= most)).any():
            raise ArgumentError(f"active names rows outside of 0 to {most - 1}, those of the rows and bounds")

    def _point(self, point: ArrayLike | None) -> Vector | None:
        if point is None:
            return None
        known, n = np.asarray(point, dtype=float), self.miqp.qp.n
        if known.shape != (n,):
            raise ArgumentError(f"point has shape {known.shape}: ({n},) was expected")
        return known

    def _guess(self, incumbent: ArrayLike | None) -> Vector | None:
        if incumbent is None:
            return None
        guess, n, count = np.asarray(incumbent, dtype=float), self.miqp.qp.n, len(self.miqp.binaries)
        if guess.shape not in ((n,), (count,)):
            raise ArgumentError(f"incumbent has shape {guess.shape}: ({n},) or ({count},) was expected")
        if guess.shape != (count,):
            guess = guess[self.miqp.binaries]
        return np.round(guess) + 0.0


def solve_miqp(miqp: Miqp, settings: MiqpSettings | None = None, **vectors: Any) -> MiqpResult:
    """Solve one problem once; the keywords are those of :meth:`MiqpSolver.solve`."""
    return MiqpSolver(miqp, settings).solve(**vectors)
