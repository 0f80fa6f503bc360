"""The cost of the program: tracked signals, their weights and the Hessian."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine, stack
from hysdel_py.control.costs import GroupWeight, Weights
from hysdel_py.control.layout import Layout

if TYPE_CHECKING:
    from scipy.sparse import csc_array, csr_array

__all__ = ["Objective", "Tracked", "objective"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Tracked:
    """Meaning of one entry of the vector of tracked signals: a signal at a time."""

    group: str
    column: int
    name: str
    time: int


@dataclass(frozen=True, slots=True, eq=False)
class Objective:
    """The cost ``(w - r)' Q (w - r) + rho eps^2`` of the tracked signals w.

    Attributes
    ----------
    signals : Affine
        The tracked signals in terms of the decision variables and the measured state.
    tracked : tuple of Tracked
        Meaning of each entry.
    Q : sparse array
        Weights, block diagonal.
    P : sparse array of shape (n, n)
        Hessian, twice the weights and prices.
    """

    signals: Affine
    tracked: tuple[Tracked, ...]
    Q: csr_array
    P: csc_array


def objective(layout: Layout, weights: Weights, rho: Matrix) -> Objective:
    """Assemble the cost of a controller; `rho` has the price of each slack."""
    signals, tracked, Q = _tracked(layout, weights)
    return Objective(signals, tracked, Q, _hessian(layout, signals, Q, rho))


def _tracked(layout: Layout, weights: Weights) -> tuple[Affine, tuple[Tracked, ...], csr_array]:
    from scipy.sparse import block_diag, csr_array

    parts: list[Affine] = []
    entries: list[Tracked] = []
    blocks: list[Matrix] = []
    for group, k, weight in _terms(layout.horizon, weights):
        columns = weight.columns
        if not len(columns):
            continue
        variables = getattr(layout.mld, group)
        value = layout.signal(group, k)
        parts.append(Affine(value.V[columns], value.X[columns], value.c[columns]))
        entries += [Tracked(group, int(i), variables[i].name, k) for i in columns]
        blocks.append(weight.matrix[np.ix_(columns, columns)])
    Q = csr_array(block_diag(blocks, format="csr")) if blocks else csr_array((0, 0))
    return stack(parts, layout.n, layout.mld.nx), tuple(entries), Q


def _terms(horizon: int, weights: Weights) -> Iterator[tuple[str, int, GroupWeight]]:
    for k in range(horizon):
        yield "y", k, weights.y
        yield "u", k, weights.u
        yield "d", k, weights.d
        yield "z", k, weights.z
        if k > 0:
            yield "x", k, weights.x
    yield "x", horizon, weights.terminal


def _hessian(layout: Layout, signals: Affine, Q: csr_array, rho: Matrix) -> csc_array:
    from scipy.sparse import csc_array, diags_array

    prices = np.concatenate([np.zeros(layout.n - len(rho)), 2.0 * rho])
    tracking = 2.0 * (signals.V.T @ (Q @ signals.V))
    P = csc_array(tracking + diags_array(prices))
    P.eliminate_zeros()
    return csc_array((P + P.T) / 2)
