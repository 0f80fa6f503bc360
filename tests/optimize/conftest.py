"""Random problems, an exact oracle for small ones, and the two-mode predictive control problem."""

from __future__ import annotations

from functools import cache
from itertools import combinations, product

import numpy as np
import pytest

from hysdel_py.optimize.mixed_integer import Miqp
from hysdel_py.optimize.qp import Qp

MAX_REAL, MAX_BINARY, MAX_ROWS = 3, 4, 4


def make_miqp(seed: int) -> Miqp:
    """A small problem in a box; the seed decides on the degeneracies."""
    rng = np.random.default_rng(seed)
    nr, nb, m = rng.integers(1, MAX_REAL + 1), rng.integers(1, MAX_BINARY + 1), rng.integers(1, MAX_ROWS + 1)
    n = nr + nb
    A = np.round(rng.normal(size=(m, n)) * 2) if seed % 2 else rng.normal(size=(m, n))
    inside = np.concatenate([rng.uniform(-1, 1, nr), rng.integers(0, 2, nb)])
    at = A @ (np.round(inside) if seed % 2 else inside)
    l, u = at - rng.exponential(1.0, m), at + rng.exponential(1.0, m)  # noqa: E741
    l[rng.random(m) < 0.4], u[rng.random(m) < 0.2] = -np.inf, np.inf
    lb, ub = np.concatenate([np.full(nr, -2.0), np.zeros(nb)]), np.concatenate([np.full(nr, 2.0), np.ones(nb)])
    P, q = hessian(rng, n), np.round(rng.normal(size=n), 1) if seed % 2 else rng.normal(size=n)
    A, l, u = with_degeneracy(rng, A, l, u, at, nr)  # noqa: E741
    if rng.random() < 0.2:
        lb[0] = ub[0] = inside[0] if not seed % 2 else np.round(inside[0])
    if rng.random() < 0.2:
        shift = rng.uniform(2, 6)
        l, u = l + shift, u + shift  # noqa: E741
    order = rng.permutation(n)
    place = np.argsort(order)
    qp = Qp(P[np.ix_(order, order)], q[order], A[:, order], l, u, lb[order], ub[order], constant=rng.normal())
    return Miqp(qp, place[nr:], priorities=rng.integers(0, 3, nb))


def hessian(rng, n):
    """Zero, of low rank, or of full rank."""
    rank = rng.choice([0, 1, max(1, n // 2), n])
    L = np.round(rng.normal(size=(n, rank)), 2)
    return L @ L.T


def with_degeneracy(rng, A, l, u, at, nr):  # noqa: E741
    """An equality, a doubled row, or the pair of rows that ties a binary to the sign of a real variable."""
    kind = rng.integers(0, 4)
    if kind == 1:
        l[0] = u[0] = at[0]
    if kind == 2:
        return np.vstack([A, A[:1] * 2]), np.append(l, 2 * l[0]), np.append(u, 2 * u[0])
    if kind == 3:
        big, eps = 2.0, 1e-6
        row = np.zeros((2, A.shape[1]))
        row[:, 0], row[0, nr], row[1, nr] = (1.0, 1.0), -(big + eps), -big
        # binary = 1 exactly where the real variable is at least 0: x <= (M + eps) d - eps, x >= M d - M
        return np.vstack([A, row]), np.concatenate([l, [-np.inf, -big]]), np.concatenate([u, [-eps, np.inf]])
    return A, l, u


@cache
def optimum_of_seed(seed: int) -> float:
    """The oracle for one of the random problems, remembered for the second back end."""
    return enumerate_optimum(make_miqp(seed))


def enumerate_optimum(miqp: Miqp) -> float:
    """Least value over all binaries and all faces of the polyhedron of the real variables; infinite if there is none.

    An extreme point of the set of optimal points is the only minimiser over the face of its active rows, so that the
    least value over the feasible ones among the minimisers of all faces is the optimum.
    """
    qp, P, A = miqp.qp, miqp.qp.P.toarray(), miqp.qp.A.toarray()
    real = np.setdiff1d(np.arange(qp.n), miqp.binaries)
    rows = np.vstack([A, np.eye(qp.n)])
    low, high = np.concatenate([qp.l, qp.lb]), np.concatenate([qp.u, qp.ub])
    sides = [(i, s) for i in (*range(qp.m), *(qp.m + real)) for s in {low[i], high[i]} if np.isfinite(s)]
    systems = [face_system(P, rows, real, face) for face in faces(sides, len(real))]
    best = np.inf
    for word in product((0.0, 1.0), repeat=len(miqp.binaries)):
        fixed = np.zeros(qp.n)
        fixed[miqp.binaries] = word
        for inverse, face in systems:
            right = np.concatenate([-(qp.q + P @ fixed)[real], [s - rows[i] @ fixed for i, s in face]])
            x = fixed.copy()
            x[real] = (inverse @ right)[: len(real)]
            value = rows @ x
            if np.all(value >= low - 1e-9) and np.all(value <= high + 1e-9):
                best = min(best, 0.5 * x @ P @ x + qp.q @ x + qp.constant)
    return float(best)


def faces(sides, n):
    return [face for size in range(n + 1) for face in combinations(sides, size) if len({i for i, _ in face}) == size]


def face_system(P, rows, real, face):
    W = np.array([rows[i][real] for i, _ in face]).reshape(len(face), len(real))
    kkt = np.block([[P[np.ix_(real, real)], W.T], [W, np.zeros((len(face), len(face)))]])
    return np.linalg.pinv(kkt, rcond=1e-11), face


def two_mode(start=(-3.0, 2.0), horizon=10, weight=0.1) -> Miqp:
    """Predictive control of x+ = 0.8 R(60 deg) x + (0, u) for x1 >= 0, with R(-60 deg) otherwise; |x| <= 10, |u| <= 1.

    The system of Bemporad and Morari, Automatica 35, 1999, example 4.1; the mode is tied to x1 with an epsilon of 1e-6.
    """
    bound, eps, rotation = 10.0, 1e-6, np.pi / 3
    c, s = 0.8 * np.cos(rotation), 0.8 * np.sin(rotation)
    A1, A2 = np.array([[c, s], [-s, c]]), np.array([[c, -s], [s, c]])
    D = A1 - A2
    most = bound * np.abs(D).sum(axis=1)
    size, n = 6, 6 * horizon  # a stage is u, d, z1, z2 and the next state
    P, q, constant = np.zeros((n, n)), np.zeros(n), float(np.dot(start, start))
    rows, l, u = [], [], []  # noqa: E741

    def add(k, state, low, high, **own):
        row = np.zeros(n)
        for name, value in own.items():
            row[k * size + {"u": 0, "d": 1, "z1": 2, "z2": 3, "n1": 4, "n2": 5}[name]] = value
        if k:
            row[(k - 1) * size + 4 : k * size] = state
        known = 0.0 if k else float(np.dot(state, start))
        rows.append(row)
        l.append(low - known)
        u.append(high - known)

    for k in range(horizon):
        add(k, [1.0, 0.0], -bound, np.inf, d=-bound)
        add(k, [1.0, 0.0], -np.inf, -eps, d=-(bound + eps))
        for i, z in enumerate(("z1", "z2")):
            add(k, [0.0, 0.0], -np.inf, 0.0, **{z: 1.0, "d": -most[i]})
            add(k, [0.0, 0.0], 0.0, np.inf, **{z: 1.0, "d": most[i]})
            add(k, -D[i], -np.inf, most[i], **{z: 1.0, "d": most[i]})
            add(k, -D[i], -most[i], np.inf, **{z: 1.0, "d": -most[i]})
        add(k, -A2[0], 0.0, 0.0, n1=1.0, z1=-1.0)
        add(k, -A2[1], 0.0, 0.0, n2=1.0, z2=-1.0, u=-1.0)
        at = k * size
        P[at, at] = 2 * weight
        if k < horizon - 1:
            P[at + 4, at + 4] = P[at + 5, at + 5] = 2.0
    one = np.array([1.0, 1.0, *most, bound, bound])
    lb = np.tile(-one * np.array([1, 0, 1, 1, 1, 1]), horizon)
    qp = Qp(P, q, np.array(rows), l, u, lb, np.tile(one, horizon), constant)
    stages = np.arange(horizon)
    return Miqp(qp, stages * size + 1, priorities=stages, drivers=stages * size)


@pytest.fixture(scope="session")
def small_problem():
    return make_miqp


@pytest.fixture(scope="session")
def oracle():
    return optimum_of_seed


@pytest.fixture(scope="session")
def enumerated():
    return enumerate_optimum


@pytest.fixture(scope="session")
def two_mode_problem():
    return two_mode
