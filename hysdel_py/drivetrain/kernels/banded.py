"""Systems with an inertia matrix N and the slips of sticking contacts, in an order that makes them banded.

    [ N   W_s ] [ v]   [a]
    [ W_s'  0 ] [-P] = [b]

Speeds are ordered so that those that are coupled stand near to each other, and each contact stands behind the last
speed that it touches. Then every leading block is regular as long as the contacts are independent: elimination needs no
exchange of rows, and a contact that depends on contacts before it shows as a pivot of zero. The cost grows with the
number of unknowns and the square of the half bandwidth, which is 3 for a chain.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import compiled

__all__ = ["DEPENDENT", "Band", "factor", "solve_factored"]

Array = NDArray[np.float64]

DEPENDENT = 1e-12
"""A pivot below this share of its diagonal entry is zero."""


class Band(NamedTuple):
    """N in banded order, with rows of the identity for all contacts.

    ``entries[r, half + c - r]`` is the entry of row r and column c <= r. ``speeds`` and ``contacts`` are the places of
    speeds and contacts; ``L`` and ``d`` the factors of `entries`.
    """

    entries: Array
    speeds: NDArray[np.int64]
    contacts: NDArray[np.int64]
    L: Array
    d: Array


@compiled
def factor(entries, contacts, speeds, W, diagonal, sticks):
    """Factors L (without its diagonal of ones) and d with ``L diag(d) L'`` equal to the system.

    Parameters
    ----------
    W : Rows
        One row per contact.
    diagonal : array of shape (nc,)
        Of ``W' N^-1 W``.
    sticks : bool array of shape (nc,)

    Returns
    -------
    L : array of shape (size, half)
    d : array of shape (size,)
        Zero for contacts that depend on others.
    """
    size, half = entries.shape[0], entries.shape[1] - 1
    rows, least = entries.copy(), np.zeros(size)
    for i in range(len(contacts)):
        if sticks[i]:
            r = contacts[i]
            least[r] = DEPENDENT * diagonal[i]
            rows[r, half] = 0.0
            for k in range(W.start[i], W.start[i + 1]):
                rows[r, half + speeds[W.column[k]] - r] = W.value[k]
    L, d = np.zeros((size, half)), np.zeros(size)
    for r in range(size):
        first = max(0, r - half)
        for j in range(first, r):
            total = rows[r, half + j - r]
            for k in range(max(first, j - half), j):
                total -= rows[r, half + k - r] * L[j, half + k - j]
            rows[r, half + j - r] = total
        pivot = rows[r, half]
        for j in range(first, r):
            if d[j] != 0.0:
                L[r, half + j - r] = rows[r, half + j - r] / d[j]
                pivot -= rows[r, half + j - r] * L[r, half + j - r]
        d[r] = pivot if abs(pivot) > least[r] else 0.0
    return L, d


@compiled
def solve_factored(L, d, x):
    """Solve with the factors; x is overwritten, with zero for contacts that depend on others."""
    size, half = L.shape
    for r in range(size):
        for j in range(max(0, r - half), r):
            x[r] -= L[r, half + j - r] * x[j]
    for r in range(size):
        x[r] = x[r] / d[r] if d[r] != 0.0 else 0.0
    for r in range(size - 1, -1, -1):
        for j in range(max(0, r - half), r):
            x[j] -= L[r, half + j - r] * x[r]
