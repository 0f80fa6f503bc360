"""The cost of the program: tracked signals, their weights, the Hessian and the linear part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine, stack
from hysdel_py.control.layout import Layout
from hysdel_py.control.weights import GroupWeight, Norm, Weights

if TYPE_CHECKING:
    from scipy.sparse import csc_array, csr_array

__all__ = ["Objective", "Term", "Tracked", "cost_terms", "objective", "term_labels"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Tracked:
    """Meaning of one entry of the vector of tracked signals: a signal at a time."""

    group: str
    column: int
    name: str
    time: int


@dataclass(frozen=True, slots=True, eq=False)
class Term:
    """One term of the cost: the weighted signals of one group at one time.

    Attributes
    ----------
    value : Affine
        The signals.
    tracked : tuple of Tracked
        What they are.
    matrix : array with one column per signal
    """

    value: Affine
    tracked: tuple[Tracked, ...]
    matrix: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Objective:
    """The cost ``(w - r)' Q (w - r) + linear' v`` of the tracked signals w, with rho eps^2 or rho eps of the slacks.

    With absolute values in the cost Q is zero: the terms are variables of the program, whose sum is linear.

    Attributes
    ----------
    signals : Affine
        The tracked signals in terms of the decision variables and the parameters.
    tracked : tuple of Tracked
        Meaning of each entry.
    Q : sparse array
        Weights, block diagonal.
    P : sparse array of shape (n, n)
        Hessian, twice the weights and prices.
    linear : array of shape (n,)
    """

    signals: Affine
    tracked: tuple[Tracked, ...]
    Q: csr_array
    P: csc_array
    linear: Matrix


def objective(layout: Layout, terms: tuple[Term, ...], norm: Norm, rho: Matrix) -> Objective:
    """Assemble the cost of a controller; `rho` has the price of each slack."""
    signals = stack([term.value for term in terms], layout.n, layout.parameters)
    tracked = tuple(entry for term in terms for entry in term.tracked)
    n = len(tracked)
    Q = _block_diagonal([np.zeros((n, n))] if norm.is_linear else [term.matrix for term in terms])
    linear, square = _prices(layout, rho, norm)
    return Objective(signals, tracked, Q, _hessian(signals, Q, square), linear)


def cost_terms(layout: Layout, weights: Weights) -> tuple[Term, ...]:
    """Return the terms of the cost, stage by stage."""
    return tuple(_term(layout, group, k, weight) for group, k, weight in _weighted(layout.horizon, weights))


def term_labels(horizon: int, weights: Weights) -> tuple[str, ...]:
    """Name the variables that stand for the terms of a cost with absolute values, in the order of the terms.

    There is one per term for the largest value, and one per row of its matrix for the sum.
    """
    if weights.norm is Norm.SQUARES:
        return ()
    labels = []
    for group, k, weight in _weighted(horizon, weights):
        rows = len(weight.block) if weights.norm is Norm.SUM else 1
        labels += [f"{group}[{k}], row {i}" if rows > 1 else f"{group}[{k}]" for i in range(rows)]
    return tuple(labels)


def _weighted(horizon: int, weights: Weights) -> Iterator[tuple[str, int, GroupWeight]]:
    """Groups, times and weights that are not zero."""
    yield from (entry for entry in _all_terms(horizon, weights) if len(entry[2].columns))


def _all_terms(horizon: int, weights: Weights) -> Iterator[tuple[str, int, GroupWeight]]:
    for k in range(horizon):
        yield "y", k, weights.y
        yield "u", k, weights.u
        yield "du", k, weights.du
        yield "d", k, weights.d
        yield "z", k, weights.z
        if k > 0:
            yield "x", k, weights.x
    yield "x", horizon, weights.terminal


def _term(layout: Layout, group: str, k: int, weight: GroupWeight) -> Term:
    columns = weight.columns
    variables = layout.mld.u if group == "du" else getattr(layout.mld, group)
    tracked = tuple(Tracked(group, int(i), variables[i].name, k) for i in columns)
    return Term(layout.signal(group, k).entries(columns), tracked, weight.block)


def _prices(layout: Layout, rho: Matrix, norm: Norm) -> tuple[Matrix, Matrix]:
    """Linear cost of all variables, and the diagonal of the Hessian that the slacks add."""
    linear, square = np.zeros(layout.n), np.zeros(layout.n)
    slacks = slice(layout.slack(0), layout.term(0))
    if norm.is_linear:
        linear[slacks], linear[layout.term(0) :] = rho, 1.0
    else:
        square[slacks] = 2.0 * rho
    return linear, square


def _block_diagonal(blocks: list[Matrix]) -> csr_array:
    from scipy.sparse import block_diag, csr_array

    return csr_array(block_diag(blocks, format="csr")) if blocks else csr_array((0, 0))


def _hessian(signals: Affine, Q: csr_array, square: Matrix) -> csc_array:
    from scipy.sparse import csc_array, diags_array

    tracking = 2.0 * (signals.V.T @ (Q @ signals.V))
    P = csc_array(tracking + diags_array(square))
    P.eliminate_zeros()
    return csc_array((P + P.T) / 2)
