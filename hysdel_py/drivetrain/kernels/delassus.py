"""The Delassus operator ``G = W' N^-1 W``: slips that contact impulses make, through an inertia matrix N.

Small plants have it as a matrix. Large ones whose inertia matrix and contacts couple neighbours only keep N in banded
form: G itself would be full there as soon as N is not diagonal, and cost the square of its size at each use.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import compiled
from hysdel_py.drivetrain.kernels.banded import DEPENDENT, Band, factor, solve_factored
from hysdel_py.drivetrain.kernels.rows import Rows, add_transposed, times

__all__ = ["Delassus", "band_step", "dense_step", "is_dense", "magnitudes", "pushed", "respond", "slips"]

Array = NDArray[np.float64]


class Delassus(NamedTuple):
    """G as a matrix, or as the band of N where `dense` is empty.

    ``inverse`` is N^-1 beside a dense G and empty otherwise, ``W`` has one row per contact, ``inertia`` is the diagonal
    of N. ``diagonal`` is that of G; with a band that of ``W' diag(N)^-1 W``, which is as good as a measure of size.
    """

    dense: Array
    inverse: Array
    diagonal: Array
    inertia: Array
    W: Rows
    band: Band


@compiled
def is_dense(G):
    """Whether G is there as a matrix; a plant without contacts has nothing else."""
    return len(G.dense) == len(G.diagonal)


@compiled
def respond(G, force):
    """``N^-1 force``."""
    if is_dense(G):
        return G.inverse @ force
    x = np.zeros(len(G.band.d))
    for i in range(len(force)):
        x[G.band.speeds[i]] = force[i]
    solve_factored(G.band.L, G.band.d, x)
    return x[G.band.speeds]


@compiled
def slips(G, c, P):
    """Slips ``G P + c``."""
    if is_dense(G):
        return G.dense @ P + c
    return c + times(G.W, pushed(G, P))


@compiled
def pushed(G, P):
    """Change of the speeds by impulses, ``N^-1 W P``."""
    force = np.zeros(len(G.inertia))
    add_transposed(G.W, P, force)
    return respond(G, force)


@compiled
def magnitudes(G, c, P):
    """Sizes of the terms of which the slips are sums: what is far below them is rounding."""
    if is_dense(G):
        return np.abs(G.dense) @ np.abs(P) + np.abs(c)
    force = np.zeros(len(G.band.speeds))
    size = np.abs(c)
    for i in range(len(P)):
        for k in range(G.W.start[i], G.W.start[i + 1]):
            force[G.W.column[k]] += abs(G.W.value[k] * P[i])
    for i in range(len(P)):
        for k in range(G.W.start[i], G.W.start[i + 1]):
            size[i] += abs(G.W.value[k]) * force[G.W.column[k]] / G.inertia[G.W.column[k]]
    return size


@compiled
def band_step(G, slip, sticks):
    """Changes of the speeds and impulses that bring the slips of some contacts to zero.

    Contacts that depend on others keep their impulse.
    """
    band = G.band
    L, d = factor(band.entries, band.contacts, band.speeds, G.W, G.diagonal, sticks)
    x = np.zeros(len(d))
    for i in range(len(slip)):
        if sticks[i]:
            x[band.contacts[i]] = -slip[i]
    solve_factored(L, d, x)
    return x[band.speeds], -x[band.contacts]


@compiled
def dense_step(G, slip, index):
    """The same step of the impulses in `index` by Cholesky's method, with G as a matrix."""
    m = len(index)
    L, y = np.zeros((m, m)), np.zeros(m)
    for a in range(m):
        i = index[a]
        total = -slip[i]
        for b in range(a):
            entry = G[i, index[b]]
            for k in range(b):
                entry -= L[a, k] * L[b, k]
            L[a, b] = entry / L[b, b] if L[b, b] > 0.0 else 0.0
            total -= L[a, b] * y[b]
        pivot = G[i, i]
        for k in range(a):
            pivot -= L[a, k] * L[a, k]
        if pivot > DEPENDENT * G[i, i]:
            L[a, a] = np.sqrt(pivot)
            y[a] = total / L[a, a]
    for a in range(m - 1, -1, -1):
        if L[a, a] > 0.0:
            total = y[a]
            for b in range(a + 1, m):
                total -= L[b, a] * y[b]
            y[a] = total / L[a, a]
        else:
            y[a] = 0.0
    return y
