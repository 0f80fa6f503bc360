"""Costs with absolute values as rows of a linear program.

A term ``|M (w - r)|`` becomes variables t with ``-t <= M (w - r) <= t``: one per row of M for the sum of absolute
values, one for all rows for the largest. Minimising the sum of all t makes each of them equal to its term.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine, stack
from hysdel_py.control.bounds import interval_product
from hysdel_py.control.layout import Layout
from hysdel_py.control.objective import Term
from hysdel_py.control.rows import Block, Row
from hysdel_py.control.weights import Norm

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["Epigraph", "epigraph"]

Matrix = NDArray[np.float64]
Ends = tuple[Matrix, Matrix]


@dataclass(frozen=True, slots=True, eq=False)
class Epigraph:
    """Rows ``block.value + references r <= 0`` of the terms.

    Attributes
    ----------
    block : Block
        For each row of a term first ``M w - t``, then ``-M w - t``.
    references : sparse array with one column per tracked signal
        How the references move the rows.
    variable : array of int, one entry per row
        Which t the row belongs to, counted from the first.
    reach : array, one entry per row
        No value of the row's ``M w`` within the bounds of the variables is larger than this.
    """

    block: Block
    references: csr_array
    variable: NDArray[np.intp]
    reach: Matrix

    def largest(self, targets: Matrix) -> Matrix:
        """Upper bounds of the variables t that every plan keeps, for references of all tracked signals."""
        each = self.reach + abs(self.references) @ np.abs(targets)
        bounds = np.zeros(self.variable.max(initial=-1) + 1)
        np.maximum.at(bounds, self.variable, each)
        return bounds


def epigraph(layout: Layout, terms: tuple[Term, ...], norm: Norm, variables: Ends, parameters: Ends) -> Epigraph:
    """Assemble the rows of a cost with absolute values; none for a cost of squares.

    Parameters
    ----------
    layout : Layout
    terms : tuple of Term
    norm : Norm
    variables, parameters : pairs of arrays
        Lower and upper ends of the decision variables and of the parameters.
    """
    used = terms if norm.is_linear else ()
    owners = _owners(used, norm)
    signals = stack([term.value.times(term.matrix) for term in used], layout.n, layout.parameters)
    t = _selection(layout, owners)
    value = stack([signals - t, signals.negative() - t], layout.n, layout.parameters)
    rows = _rows(used)
    side = np.zeros(len(rows) * 2)
    return Epigraph(
        Block(value, side - inf, side, rows + rows),
        _references(used, sum(len(term.tracked) for term in terms)),
        np.concatenate([owners, owners]),
        np.tile(_reach(signals, variables, parameters), 2),
    )


def _owners(terms: tuple[Term, ...], norm: Norm) -> NDArray[np.intp]:
    """For each row of all terms the number of its variable t."""
    sizes = [len(term.matrix) for term in terms]
    if norm is Norm.SUM:
        return np.arange(sum(sizes), dtype=np.intp)
    return np.repeat(np.arange(len(sizes), dtype=np.intp), sizes)


def _selection(layout: Layout, owners: NDArray[np.intp]) -> Affine:
    """The variable t of each row."""
    from scipy.sparse import csr_array

    size = len(owners)
    places = np.arange(size), layout.term(0) + owners
    V = csr_array((np.ones(size), places), shape=(size, layout.n))
    return Affine(V, np.zeros((size, layout.parameters)), np.zeros(size))


def _rows(terms: tuple[Term, ...]) -> tuple[Row, ...]:
    return tuple(
        Row("cost", term.tracked[0].time, f"term of {', '.join(entry.name for entry in term.tracked)}")
        for term in terms
        for _ in term.matrix
    )


def _references(terms: tuple[Term, ...], columns: int) -> csr_array:
    """Minus the weights, then the weights: what the references do to the two halves of the rows."""
    from scipy.sparse import block_diag, csr_array, vstack

    if not terms:
        return csr_array((0, columns))
    weights = block_diag([term.matrix for term in terms], format="csr")
    return csr_array(vstack([-weights, weights], format="csr"))


def _reach(signals: Affine, variables: Ends, parameters: Ends) -> Matrix:
    """Largest absolute value of each entry within the ends of variables and parameters."""
    below, above = interval_product(signals.V.toarray(), variables)
    low, high = interval_product(signals.X, parameters)
    return np.maximum(np.abs(below + low + signals.c), np.abs(above + high + signals.c))
