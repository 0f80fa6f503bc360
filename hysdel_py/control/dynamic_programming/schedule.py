"""The grids of one stage, and what is remembered of the input before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.dynamic_programming.evaluation import Functions
from hysdel_py.control.dynamic_programming.grids import Mesh

__all__ = ["Before", "Stage", "remembered"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Before:
    """Inputs that may have been applied before, grouped by what the next change costs.

    Attributes
    ----------
    inputs : array of shape (nB, nu)
        The inputs of the stage before.
    group : array of int64, shape (nB,)
        Inputs from which every change costs the same share a group, which is a column of the table.
    changes : array of shape (groups, nU)
        Cost of the change from each group to each input of this stage.
    """

    inputs: Matrix
    group: NDArray[np.int64]
    changes: Matrix


@dataclass(frozen=True, eq=False)
class Stage:
    """Nodes of the state and inputs to choose from.

    Attributes
    ----------
    mesh : Mesh
    inputs : array of shape (nU, nu)
    before : Before or None
        Where changes of input cost something.
    """

    mesh: Mesh
    inputs: Matrix
    before: Before | None

    @property
    def columns(self) -> int:
        """Number of values per node: one for each group of inputs before."""
        return 1 if self.before is None else len(self.before.changes)

    @property
    def shape(self) -> tuple[int, int]:
        """Shape of the values of this stage."""
        return self.mesh.size, self.columns

    @property
    def changes(self) -> Matrix:
        """Cost of changes, one row for each column of the table."""
        return np.zeros((1, len(self.inputs))) if self.before is None else self.before.changes

    def column_after(self) -> NDArray[np.int64] | int:
        """Column of the table for each input of the stage before."""
        return 0 if self.before is None else self.before.group


def remembered(functions: Functions, before: Matrix, inputs: Matrix) -> Before | None:
    """Group the inputs of the stage before; None where changes cost nothing."""
    if functions.change_cost is None:
        return None
    changes = functions.changes(before, inputs)
    _, first, group = np.unique(changes, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)  # groups by their first inputs
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    return Before(before, place[group.ravel()].astype(np.int64), changes[np.sort(first)])
