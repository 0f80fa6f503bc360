"""One sequence of binaries: the multi-parametric program that it leaves, solved."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.mixed_parametric.problem import MpMiqp
from hysdel_py.optimize.mixed_parametric.sequences import Word
from hysdel_py.optimize.mixed_parametric.settings import MpMiqpSettings
from hysdel_py.optimize.mixed_parametric.substitution import Fate, Reduced, reduce_to_free
from hysdel_py.optimize.mpqp import CriticalRegion, MpQp, ParametricSolution, solve_mpqp
from hysdel_py.optimize.parametric.exploration import Stop

__all__ = ["Piece", "solve_sequence"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """The map of one sequence.

    Attributes
    ----------
    word : Word
    solution : ParametricSolution
        Over the real parameters; its variables are what the rows leave free, scaled.
    Z : array of shape (n, p + free + 1)
        ``w = Z (theta, z, 1)``.
    """

    word: Word
    solution: ParametricSolution
    Z: Matrix

    @property
    def regions(self) -> tuple[CriticalRegion, ...]:
        """Its regions."""
        return self.solution.regions

    def laws(self, entries: NDArray[np.intp]) -> tuple[Matrix, Matrix]:
        """Some entries of w as affine functions of theta, for each region: arrays (count, k, p), (count, k)."""
        p = self.solution.problem.p
        own, across, rest = self.Z[entries, :p], self.Z[entries, p:-1], self.Z[entries, -1]
        K = np.array([region.K for region in self.regions]).reshape(len(self.regions), -1, p)
        k = np.array([region.k for region in self.regions]).reshape(len(self.regions), -1)
        return own + across @ K, rest + k @ across.T


def solve_sequence(problem: MpMiqp, word: Word, settings: MpMiqpSettings) -> Piece | Fate:
    """Solve the program of a complete sequence; what is wrong with it where it has no region."""
    last = int(problem.reach.max(initial=0))
    fate, reduced = reduce_to_free(problem, word, last, settings)
    if reduced is None:
        return fate
    Z, N, h = _over_parameters(reduced, problem.parameters)
    mpqp = _program(problem, Z, N, h)
    if not mpqp.n:
        solution = _without_variables(mpqp)
        return Fate.EMPTY if solution is None else Piece(word, solution, Z)
    try:
        solution = solve_mpqp(mpqp, settings.mpqp)
    except ArgumentError:  # of all that it may be told, only this can be wrong here: parameters in a subspace
        return Fate.FLAT
    if not solution.regions and solution.complete:
        return Fate.EMPTY
    return Piece(word, solution, Z)


def _over_parameters(reduced: Reduced, p: int) -> tuple[Matrix, Matrix, Vector]:
    """The same with the parameters in their own units."""
    half = reduced.half[:p]
    rate, offset = 1.0 / half, reduced.centre[:p] / half
    Z = reduced.Z.copy()
    Z[:, -1] -= Z[:, :p] @ offset
    Z[:, :p] *= rate
    N = reduced.N.copy()
    h = reduced.h + N[:, :p] @ offset
    N[:, :p] *= rate
    return Z, N, h


def _program(problem: MpMiqp, Z: Matrix, N: Matrix, h: Vector) -> MpQp:
    p = problem.parameters
    H, g = Z.T @ (problem.H @ Z), Z.T @ problem.g
    gradient = H[:-1, -1] + g[:-1]
    square = (H + H.T) / 2
    return MpQp(
        H=square[p:-1, p:-1],
        f=gradient[p:],
        F=square[p:-1, :p],
        G=N[:, p:],
        w=h,
        S=-N[:, :p],
        theta=Polyhedron.box(problem.lb[:p], problem.ub[:p]),
        Y=square[:p, :p],
        y=gradient[:p],
        constant=float(H[-1, -1] / 2 + g[-1] + problem.constant),
    )


def _without_variables(problem: MpQp) -> ParametricSolution | None:
    """The sequence leaves nothing to decide: one region, or None without inner points."""
    started = perf_counter()
    region = problem.theta.with_rows(-problem.S, problem.w)
    ball = region.ball
    if ball.radius <= region.precision.empty:
        return None
    rows = region.minimal()
    length = rows.lengths
    K, k = np.zeros((0, problem.p)), np.zeros(0)
    assert problem.Y is not None
    assert problem.y is not None
    found = CriticalRegion(
        rows.A / length[:, None], rows.b / length, K, k, problem.Y, problem.y, problem.constant, (), ball.centre
    )
    return ParametricSolution(problem, (found,), True, Stop.DONE, 0, 0, 1, 0, perf_counter() - started)
