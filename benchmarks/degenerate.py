"""Random degenerate multi-parametric programs, compared with online solutions and with enumeration.

Small integers make equal angles, rows through common points, weakly active and redundant rows, dependent active rows
and vanishing costs likely; some rows are there twice, and some problems have an equality. Run by `mpqp.py --sweep`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple, dataclass
from itertools import combinations

import numpy as np

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.mpqp import MpQp, solve_mpqp

KINDS = ("definite", "semidefinite", "linear")
SIZE = 2.0


def random_problem(seed: int, kind: str) -> MpQp:
    """A problem full of coincidences over a box of parameters."""
    rng = np.random.default_rng(seed)
    n, p = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    m = int(rng.integers(n, 7 + n))
    L = rng.integers(-1, 2, (n, n))
    H = {"definite": np.eye(n) + L @ L.T, "semidefinite": np.diag([1.0] * (n - 1) + [0.0]), "linear": np.zeros((n, n))}
    G, S, w = rng.integers(-1, 2, (m, n)), rng.integers(-1, 2, (m, p)), rng.integers(0, 3, m)
    again = rng.integers(0, m, 2)
    G = np.vstack([G, 2 * G[again], np.eye(n), -np.eye(n)])
    S = np.vstack([S, 2 * S[again], np.zeros((2 * n, p))])
    w = np.concatenate([w, 2 * w[again], np.full(2 * n, 3)])
    equal = {"E": rng.integers(-1, 2, (1, n)), "e": [0.0], "D": rng.integers(-1, 2, (1, p))} if seed % 4 == 3 else {}
    theta = Polyhedron.box([-SIZE] * p, [SIZE] * p)
    return MpQp(H[kind], rng.integers(-1, 2, n), rng.integers(-2, 3, (n, p)), G, w, S, theta, **equal)


def enumerated(problem: MpQp) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Inner point of the region of each active set that has one, and the solution; by the optimality conditions alone.

    For a positive definite Hessian and no equalities.
    """
    inverse = np.linalg.inv(problem.H)
    for size in range(problem.n + 1):
        for rows in map(list, combinations(range(problem.m), size)):
            G = problem.G[rows]
            gram = G @ inverse @ G.T
            if np.linalg.matrix_rank(gram) < size:
                continue
            L = -np.linalg.solve(gram, problem.S[rows] + G @ inverse @ problem.F)
            ell = -np.linalg.solve(gram, problem.w[rows] + G @ inverse @ problem.f)
            K, k = -inverse @ (problem.F + G.T @ L), -inverse @ (problem.f + G.T @ ell)
            A = np.vstack([-L, problem.G @ K - problem.S, problem.theta.A])
            b = np.concatenate([ell, problem.w - problem.G @ k, problem.theta.b])
            real = np.linalg.norm(A, axis=1) > 1e-9
            if np.all(b[~real] >= -1e-9):
                ball = Polyhedron(A[real], b[real]).ball
                if ball.radius > 1e-6:
                    yield ball.centre, K, k


@dataclass(slots=True)
class Counts:
    """What a sweep found."""

    problems: int = 0
    refused: int = 0
    regions: int = 0
    incomplete: int = 0
    holes: int = 0
    superfluous: int = 0
    overlaps: int = 0
    different: int = 0
    enumerated: int = 0
    enumerated_holes: int = 0
    enumerated_different: int = 0

    @property
    def clean(self) -> bool:
        """Whether nothing was wrong."""
        return not any(astuple(self)[3:8] + astuple(self)[9:])


def swept(kind: str, seeds: range, samples: int = 40) -> Counts:
    """Solve one problem per seed and compare."""
    counts = Counts()
    for seed in seeds:
        problem = random_problem(seed, kind)
        try:
            solution = solve_mpqp(problem)
        except ArgumentError:
            counts.refused += 1
            continue
        counts.problems += 1
        counts.regions += len(solution.regions)
        counts.incomplete += not solution.complete
        if solution.regions:
            _compare(counts, ExplicitLaw.of(solution), problem, samples, seed)
    return counts


def _compare(counts: Counts, law: ExplicitLaw, problem: MpQp, samples: int, seed: int) -> None:
    found = law.certificate(problem, samples, seed)
    counts.holes += found.missing
    counts.superfluous += found.superfluous
    counts.overlaps += found.overlaps if found.unique else 0
    counts.different += not found.holds()
    if found.unique and seed % 4 != 3:
        for theta, K, k in enumerated(problem):
            counts.enumerated += 1
            z = law.solution(theta)
            counts.enumerated_holes += z is None
            counts.enumerated_different += z is not None and bool(np.max(np.abs(z - K @ theta - k)) > 1e-6)
