"""Random small control problems of piecewise affine systems, and their optimum by trying every sequence of modes.

For a sequence of modes (and of Boolean inputs) the states are affine in the inputs, so that one dense linear or
quadratic program in the inputs alone is left. Nothing of the package is used for the optimum.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import piqp
from pwa_form import Box, Mode, mld_of_modes
from scipy.optimize import linprog

from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits


@dataclass(frozen=True)
class Problem:
    """Control from x0 over N steps: weights Q, R, P with a norm, hard limits of the states after the first."""

    modes: list[Mode]
    box: Box
    N: int
    norm: float
    Q: np.ndarray
    R: np.ndarray
    P: np.ndarray
    limits: tuple[np.ndarray, np.ndarray]
    x0: np.ndarray

    @property
    def sizes(self) -> tuple[int, int]:
        return len(self.box.x[0]), len(self.box.u[0])

    @property
    def mld(self):
        nx, nu = self.sizes
        return mld_of_modes(self.modes, self.box, np.eye(nx), np.zeros((nx, nu)), np.zeros(nx))

    def controller(self, **options) -> HybridMpc:
        names = [f"x{i + 1}" for i in range(self.sizes[0])]
        limits = Limits(x=dict(zip(names, zip(*self.limits, strict=True), strict=True)))
        cost = Cost(x=self.Q, u=self.R, terminal=self.P, norm=self.norm)
        return HybridMpc(self.mld, self.N, cost, limits, **{"gap_rel": 1e-7, "gap_abs": 1e-7} | options)


def random_problem(seed: int, norm: float) -> Problem:
    """Two modes beside a line through the box, one or two states and inputs, one of them Boolean at times."""
    rng = np.random.default_rng([seed, int(min(norm, 9))])
    nx, nu, N = int(rng.integers(1, 3)), int(rng.integers(1, 3)), int(rng.integers(1, 4))
    booleans = (nu - 1,) if rng.random() < 0.5 else ()
    span = 5.0
    normal, offset = rng.normal(size=(1, nx)), rng.uniform(-1, 1, 1)
    none = np.zeros((1, nu))
    modes = [
        Mode(0.8 * rng.normal(size=(nx, nx)), rng.normal(size=(nx, nu)), rng.uniform(-0.5, 0.5, nx),
             sign * normal, none, sign * offset)
        for sign in (1.0, -1.0)
    ]  # fmt: skip
    low, high = -np.ones(nu), np.ones(nu)
    low[list(booleans)] = 0.0
    tight = rng.uniform(0.3, span) if rng.random() < 0.5 else span
    box = Box((np.full(nx, -span), np.full(nx, span)), (low, high), booleans)
    Q, P = (random_weight(rng, nx, norm) for _ in "QP")
    return Problem(
        modes, box, N, norm, Q, random_weight(rng, nu, norm), P, (np.full(nx, -tight), np.full(nx, tight)),
        rng.uniform(-span, span, nx),
    )  # fmt: skip


def random_weight(rng, n, norm):
    """Symmetric and semidefinite for squares; any number of rows, also a zero one, otherwise."""
    if norm == 2:
        L = rng.normal(size=(n, rng.integers(1, n + 1)))
        return L @ L.T
    weight = rng.normal(size=(rng.integers(1, 4), n))
    weight[0] *= rng.integers(0, 2)
    return weight


def optimum(problem: Problem) -> float:
    """Least cost over all sequences of modes and Boolean inputs; infinite if there is no plan."""
    words = product((0.0, 1.0), repeat=len(problem.box.booleans) * problem.N)
    return min(
        sequence_optimum(problem, sequence, word)
        for word in words
        for sequence in product(problem.modes, repeat=problem.N)
    )


def predictions(problem: Problem, sequence):
    """Matrices of x_k = S U + s for k = 0..N."""
    nx, nu = problem.sizes
    S, s = np.zeros((nx, problem.N * nu)), problem.x0
    yield S, s
    for k, mode in enumerate(sequence):
        S, s = mode.A @ S, mode.A @ s + mode.f
        S[:, k * nu : (k + 1) * nu] += mode.B
        yield S, s


def sequence_optimum(problem: Problem, sequence, word) -> float:
    nu = problem.sizes[1]
    states = list(predictions(problem, sequence))
    G, h = [], []
    for k, mode in enumerate(sequence):
        S, s = states[k]
        G.append(mode.G @ S)
        h.append(mode.g - mode.G @ s)
        S, s = states[k + 1]
        G += [S, -S]
        h += [np.minimum(problem.limits[1], problem.box.x[1]) - s, s - np.maximum(problem.limits[0], problem.box.x[0])]
    low, high = (np.tile(end, problem.N).astype(float) for end in problem.box.u)
    for value, column in zip(word, (k * nu + i for k in range(problem.N) for i in problem.box.booleans), strict=True):
        low[column] = high[column] = value
    terms = [(problem.R @ np.eye(problem.N * nu)[k * nu : (k + 1) * nu], np.zeros(len(problem.R)), problem.R)
             for k in range(problem.N)]  # fmt: skip
    weights = [problem.Q] * (problem.N - 1) + [problem.P]
    terms += [(W @ S, W @ s, W) for W, (S, s) in zip(weights, states[1:], strict=True)]
    G, h = np.vstack(G), np.concatenate(h)
    solve = least_squares if problem.norm == 2 else least_absolute
    return solve(problem, (G, h), (low, high), terms, states)


def least_absolute(problem, rows, ends, terms, _):
    """Linear program with one bound per term or per row of it."""
    G, h = rows
    n, sum_of_rows = G.shape[1], problem.norm == 1
    columns = sum(len(b) if sum_of_rows else 1 for _, b, _ in terms)
    A, b = [np.hstack([G, np.zeros((len(G), columns))])], [h]
    at = 0
    for M, m, _ in terms:
        pick = np.zeros((len(m), columns))
        if sum_of_rows:
            pick[np.arange(len(m)), at + np.arange(len(m))] = 1
        else:
            pick[:, at] = 1
        at += len(m) if sum_of_rows else 1
        A += [np.hstack([M, -pick]), np.hstack([-M, -pick])]
        b += [-m, m]
    bounds = [*zip(*ends, strict=True), *([(0, None)] * columns)]
    cost = np.concatenate([np.zeros(n), np.ones(columns)])
    answer = linprog(cost, np.vstack(A), np.concatenate(b), bounds=bounds, method="highs")
    return float(answer.fun) if answer.status == 0 else np.inf


def least_squares(problem, rows, ends, _, states):
    """Quadratic program in the inputs."""
    (G, h), (low, high), nu = rows, ends, problem.sizes[1]
    n = G.shape[1]
    P, q, c = np.kron(np.eye(problem.N), 2 * problem.R), np.zeros(n), 0.0
    for W, (S, s) in zip([problem.Q] * (problem.N - 1) + [problem.P], states[1:], strict=True):
        P, q, c = P + 2 * S.T @ W @ S, q + 2 * S.T @ W @ s, c + s @ W @ s
    assert len(q) == problem.N * nu
    solver = piqp.DenseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = 1e-9
    solver.setup(P, q, np.zeros((0, n)), np.zeros(0), G, np.full(len(h), -np.inf), h, low, high)
    return float(solver.result.info.primal_obj + c) if solver.solve().name == "PIQP_SOLVED" else np.inf
