"""The mixed-integer program of a hybrid controller, assembled once and moved by the state and references.

::

    minimise    (w - r)' Q (w - r) + g'v              w = M v + O p + o    (tracked signals)
    subject to  low <= V v + X p + c + R r <= high    (model and limits, stage by stage; terms of the cost)
                lb <= v <= ub,  v_i in {0, 1} for the binaries

with the parameters p, the measured state and the input applied last. In the form ``1/2 v'Pv + q'v + constant`` only q,
the constant and the ends of the rows depend on p and r. With absolute values in the cost Q is zero and the terms of the
cost are variables, see :mod:`hysdel_py.control.epigraph`; R is zero otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine, stack
from hysdel_py.control.bands import Band, ResolvedLimits
from hysdel_py.control.bounds import branching_variables, real_inputs, signal_ends, variable_bounds
from hysdel_py.control.epigraph import Epigraph, epigraph
from hysdel_py.control.influence import influenced_outputs
from hysdel_py.control.layout import Layout
from hysdel_py.control.objective import Objective, cost_terms, objective, term_labels
from hysdel_py.control.prepared import Prepared, prepare
from hysdel_py.control.rows import Row, row_blocks
from hysdel_py.control.shape import Shape
from hysdel_py.control.weights import Norm, Weights
from hysdel_py.systems.mld import Mld

if TYPE_CHECKING:
    from scipy.sparse import csc_array

__all__ = ["Formulation", "Vectors", "formulate"]

Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Vectors:
    """What changes with the measured state, the input applied last and the references."""

    q: Matrix
    l: Matrix  # noqa: E741  the name that the row ends have in the program
    u: Matrix
    lb: Matrix
    ub: Matrix
    constant: float

    def as_keywords(self) -> dict[str, Any]:
        """The vectors by the names that programs and solvers have for them."""
        return {name: getattr(self, name) for name in ("q", "l", "u", "lb", "ub", "constant")}


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
    shape : Shape
    norm : Norm
    epigraph : Epigraph
        Its rows are the last ones of A.
    uses_last_input : bool
        Whether increments of the inputs are weighed or limited.
    prepared : Prepared
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
    shape: Shape
    norm: Norm
    epigraph: Epigraph
    uses_last_input: bool
    prepared: Prepared

    def describe_variable(self, index: int) -> str:
        """Say in words what a decision variable is, for example ``z[3] Tcl (line 23)``."""
        return self.layout.describe(index)

    def describe_row(self, index: int) -> str:
        """Say in words what a row demands and where it comes from."""
        return str(self.rows[index])

    def vectors(self, x0: Matrix, references: Mapping[str, Matrix], last_input: Matrix | None = None) -> Vectors:
        """Return what depends on the measured state, the references and the input applied last.

        Parameters
        ----------
        x0 : array of shape (nx,)
        references : mapping of name to array of shape (N+1,)
            Names without an entry have the reference 0.
        last_input : array of shape (nu,), optional
            Zeros by default; it counts only where `uses_last_input` says so.
        """
        nx = len(x0)
        p = np.zeros(self.layout.parameters)
        p[:nx] = x0
        if last_input is not None:
            p[nx:] = last_input
        signals = self.objective.signals
        targets = self.prepared.targets(references, len(signals.c))
        offset = signals.X @ p + signals.c - targets
        moved = self.shift.X @ p + self.shift.c
        if self.norm.is_linear:
            moved[len(moved) - self.epigraph.references.shape[0] :] += self.epigraph.references @ targets
        q = self.objective.linear + self.prepared.gain @ offset
        constant = float(offset @ (self.prepared.weights @ offset))
        return Vectors(q, self.low - moved, self.high - moved, self.lb, self._upper(targets), constant)

    def _upper(self, targets: Matrix) -> Matrix:
        if not self.norm.is_linear:
            return self.ub
        ub = self.ub.copy()
        ub[self.layout.term(0) :] = self.epigraph.largest(targets)
        return ub

    def failed_conditions(self, x0: Matrix, tolerance: float) -> tuple[Row, ...]:
        """Return the requirements that the measured state breaks whatever the input is."""
        if not self.condition_rows:
            return ()
        terms = self.conditions.X[:, : len(x0)] * x0
        size = np.maximum(1.0, np.abs(terms).max(axis=1, initial=0.0))
        excess = terms.sum(axis=1) + self.conditions.c
        return tuple(self.condition_rows[i] for i in np.flatnonzero(excess > tolerance * size))

    def residual(self, v: Matrix, vectors: Vectors) -> float:
        """Largest violation of a row or bound, relative to the size of the row's terms and at least absolute."""
        from hysdel_py.optimize.kernels.residual import violations

        return float(violations(self.prepared.rows, vectors.l, vectors.u, self.lb, vectors.ub, v)[1])


def formulate(
    mld: Mld, horizon: int, weights: Weights, limits: ResolvedLimits, shape: Shape | None = None
) -> Formulation:
    """Assemble the program of a controller.

    Parameters
    ----------
    mld : Mld
    horizon : int
        Number N >= 1 of steps that are planned.
    weights : Weights
    limits : ResolvedLimits
    shape : Shape, optional
        All inputs and binaries free by default.
    """
    shape = Shape.free(horizon) if shape is None else shape
    layout = Layout(mld, horizon, limits.slacks, term_labels(horizon, weights))
    influenced = influenced_outputs(mld)
    unmovable = tuple(band for band in limits.bands if band.group == "y" and not influenced[band.column])
    lb, ub = variable_bounds(layout, limits)
    terms = cost_terms(layout, weights)
    parameters = signal_ends((*mld.x, *mld.u))
    extra = epigraph(layout, terms, weights.norm, (lb, ub), parameters)
    blocks = [*row_blocks(layout, limits, shape, unmovable), extra.block]
    value = stack([block.value for block in blocks], layout.n, layout.parameters)
    low, high = (np.concatenate([getattr(block, end) for block in blocks]) for end in ("low", "high"))
    rows = [row for block in blocks for row in block.rows]
    active = np.diff(value.V.indptr) > 0
    binaries, stages = branching_variables(layout, shape.exact)
    cost, A = objective(layout, terms, weights.norm, limits.rho), value.V[active].tocsc()
    return Formulation(
        layout=layout,
        limits=limits,
        A=A,
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
        objective=cost,
        unmovable=unmovable,
        shape=shape,
        norm=weights.norm,
        epigraph=extra,
        uses_last_input=limits.limits_increments or bool(len(weights.du.columns)),
        prepared=prepare(cost, A),
    )


def _pick(value: Affine, mask: NDArray[np.bool_]) -> Affine:
    return value.entries(np.flatnonzero(mask))
