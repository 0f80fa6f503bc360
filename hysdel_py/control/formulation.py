"""The mixed-integer quadratic program of a hybrid controller, assembled once and moved by the state and references.

::

    minimise    (w - r)' Q (w - r) + rho eps^2        w = M v + O x0 + o   (tracked signals)
    subject to  low <= V v + X x0 + c <= high         (model and limits, stage by stage)
                lb <= v <= ub,  v_i in {0, 1} for the binaries

In the form ``1/2 v'Pv + q'v + constant`` only q, the constant and the ends of the rows depend on x0 and r.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine, stack
from hysdel_py.control.bounds import branching_variables, real_inputs, variable_bounds
from hysdel_py.control.costs import Weights
from hysdel_py.control.influence import influenced_outputs
from hysdel_py.control.layout import Layout
from hysdel_py.control.limits import Band, ResolvedLimits
from hysdel_py.control.objective import Objective, objective
from hysdel_py.control.rows import Row, row_blocks
from hysdel_py.systems.mld import Mld

if TYPE_CHECKING:
    from scipy.sparse import csc_array

__all__ = ["Formulation", "Vectors", "formulate"]

Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Vectors:
    """What changes with the measured state and the references."""

    q: Matrix
    l: Matrix  # noqa: E741  the name that the row ends have in the program
    u: Matrix
    constant: float


@dataclass(frozen=True, slots=True, eq=False)
class Formulation:
    """The program of one controller; see the module for the symbols.

    Attributes
    ----------
    layout : Layout
    limits : ResolvedLimits
    A : sparse array of shape (m, n)
    lb, ub : arrays of shape (n,)
        Bounds of the variables: declared ranges within hard limits.
    binaries, stages : integer arrays
        Variables that must be 0 or 1, in the order of the stages, and the stage of each.
    drivers : integer array
        The real inputs, which with the binaries settle everything else.
    rows : tuple of Row
        Meaning of each row of A.
    shift, low, high
        The rows are ``low <= shift <= high``; A is the part of `shift` that depends on the decision variables.
    conditions, condition_rows
        Rows of stage 0 in which no decision variable appears: they hold or fail with the measured state.
    unmovable : tuple of Band
        Limits of outputs that are left out at time 0.
    objective : Objective
    """

    layout: Layout
    limits: ResolvedLimits
    A: csc_array
    lb: Matrix
    ub: Matrix
    binaries: Indices
    stages: Indices
    drivers: Indices
    rows: tuple[Row, ...]
    shift: Affine
    low: Matrix
    high: Matrix
    conditions: Affine
    condition_rows: tuple[Row, ...]
    objective: Objective
    unmovable: tuple[Band, ...]

    def describe_variable(self, index: int) -> str:
        """Say in words what a decision variable is, for example ``z[3] Tcl (line 23)``."""
        return self.layout.describe(index)

    def describe_row(self, index: int) -> str:
        """Say in words what a row demands and where it comes from."""
        return str(self.rows[index])

    def vectors(self, x0: Matrix, references: Mapping[str, Matrix]) -> Vectors:
        """Return what depends on the measured state and the references.

        Parameters
        ----------
        x0 : array of shape (nx,)
        references : mapping of name to array of shape (N+1,)
            Names without an entry have the reference 0.
        """
        signals = self.objective.signals
        offset = signals.X @ x0 + signals.c - self._targets(references)
        pull = self.objective.Q @ offset
        moved = self.shift.X @ x0 + self.shift.c
        return Vectors(2.0 * (signals.V.T @ pull), self.low - moved, self.high - moved, float(offset @ pull))

    def failed_conditions(self, x0: Matrix, tolerance: float) -> tuple[Row, ...]:
        """Return the requirements that the measured state breaks whatever the input is."""
        terms = self.conditions.X * x0
        size = np.maximum(1.0, np.abs(terms).max(axis=1, initial=0.0))
        excess = terms.sum(axis=1) + self.conditions.c
        return tuple(self.condition_rows[i] for i in np.flatnonzero(excess > tolerance * size))

    def residual(self, v: Matrix, vectors: Vectors) -> float:
        """Largest violation of a row or bound, relative to the size of the row's terms and at least absolute."""
        value = self.A @ v
        size = np.maximum(1.0, abs(self.A) @ np.abs(v))
        rows = np.maximum(vectors.l - value, value - vectors.u) / size
        bounds = np.maximum(self.lb - v, v - self.ub) / np.maximum(1.0, np.abs(v))
        return float(max(rows.max(initial=0.0), bounds.max(initial=0.0)))

    def _targets(self, references: Mapping[str, Matrix]) -> Matrix:
        tracked = self.objective.tracked
        return np.array(
            [references[w.name][w.time] if w.name in references else 0.0 for w in tracked], dtype=np.float64
        )


def formulate(mld: Mld, horizon: int, weights: Weights, limits: ResolvedLimits) -> Formulation:
    """Assemble the program of a controller.

    Parameters
    ----------
    mld : Mld
    horizon : int
        Number N >= 1 of steps that are planned.
    weights : Weights
    limits : ResolvedLimits
    """
    layout = Layout(mld, horizon, limits.slacks)
    influenced = influenced_outputs(mld)
    unmovable = tuple(band for band in limits.bands if band.group == "y" and not influenced[band.column])
    blocks = list(row_blocks(layout, limits, unmovable))
    value = stack([block.value for block in blocks], layout.n, mld.nx)
    low, high = (np.concatenate([getattr(block, end) for block in blocks]) for end in ("low", "high"))
    rows = [row for block in blocks for row in block.rows]
    active = np.diff(value.V.indptr) > 0
    binaries, stages = branching_variables(layout)
    lb, ub = variable_bounds(layout, limits)
    return Formulation(
        layout=layout,
        limits=limits,
        A=value.V[active].tocsc(),
        lb=lb,
        ub=ub,
        binaries=binaries,
        stages=stages,
        drivers=real_inputs(layout),
        rows=tuple(row for row, keep in zip(rows, active, strict=True) if keep),
        shift=_pick(value, active),
        low=low[active],
        high=high[active],
        conditions=_pick(value, ~active).shifted(-high[~active]),
        condition_rows=tuple(row for row, keep in zip(rows, active, strict=True) if not keep),
        objective=objective(layout, weights, limits.rho),
        unmovable=unmovable,
    )


def _pick(value: Affine, mask: NDArray[np.bool_]) -> Affine:
    return Affine(value.V[mask], value.X[mask], value.c[mask])
