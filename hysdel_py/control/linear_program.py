"""The quadratic program of a linear controller, as a function of what it is told at each call.

::

    min 1/2 v'H v + (f + F theta)'v + 1/2 theta'Y theta + y'theta + constant
    s.t. low <= G v + S theta + c <= high
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.linear_columns import Columns
from hysdel_py.control.linear_cost import LinearWeights
from hysdel_py.control.linear_limits import ResolvedLinearLimits
from hysdel_py.control.linear_prediction import LinearPrediction
from hysdel_py.control.linear_rows import LimitRow

if TYPE_CHECKING:
    from hysdel_py.geometry.polyhedron import Polyhedron
    from hysdel_py.optimize.mpqp import MpQp
    from hysdel_py.optimize.qp import Qp

__all__ = ["LinearProgram", "assemble"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LinearProgram:
    """A program over v = (moves, slacks) with parameters theta = (x, u(-1), r).

    Attributes
    ----------
    columns : Columns
    objective : array of shape (width, width)
        Symmetric M with the cost ``(v, theta, 1)' M (v, theta, 1)``.
    rows : tuple of LimitRow
        What each row means.
    forms : array of shape (m, width)
    low, high : arrays of shape (m,)
    """

    columns: Columns
    objective: Matrix
    rows: tuple[LimitRow, ...]
    forms: Matrix
    low: Vector
    high: Vector

    @property
    def H(self) -> Matrix:
        """Hessian."""
        n = self.columns.n
        return 2.0 * self.objective[:n, :n]

    @property
    def G(self) -> Matrix:
        """Rows over the decision variables."""
        return self.forms[:, : self.columns.n]

    def qp(self, theta: Vector) -> Qp:
        """The program for given parameters."""
        from hysdel_py.optimize.qp import Qp

        n = self.columns.n
        free = np.full(n, np.inf)
        q, low, high, constant = self.vectors(theta)
        return Qp(self.H, q, self.G, low, high, -free, free, constant)

    def vectors(self, theta: Vector) -> tuple[Vector, Vector, Vector, float]:
        """Linear cost, sides of the rows and constant for given parameters."""
        n, known = self.columns.n, np.append(theta, 1.0)
        moved = self.forms[:, n:] @ known
        q = 2.0 * self.objective[:n, n:] @ known
        return q, self.low - moved, self.high - moved, float(known @ self.objective[n:, n:] @ known)

    def with_constant_references(self) -> LinearProgram:
        """The program whose references do not change over the horizon."""
        c = self.columns
        if c.stages < 2:
            return self
        fewer = replace(c, stages=1)
        change = np.zeros((c.width, fewer.width))
        kept = c.n + c.nx + c.nu * c.previous
        change[:kept, :kept] = np.eye(kept)
        change[kept:-1, kept:-1] = np.tile(np.eye(c.references), (c.stages, 1))
        change[-1, -1] = 1.0
        rows = tuple(replace(row, form=row.form @ change) for row in self.rows)
        return LinearProgram(fewer, change.T @ self.objective @ change, rows, self.forms @ change, self.low, self.high)

    def parametric(self, domain: Polyhedron, chosen: Matrix, offset: Vector, *, move_is_input: bool = False) -> MpQp:
        """The multi-parametric program over some of the parameters.

        Parameters
        ----------
        domain : Polyhedron
            Of the parameters that are left.
        chosen : array of shape (p, q)
        offset : array of shape (p,)
            ``theta = chosen theta' + offset``.
        move_is_input : bool
            Whether the first increment is replaced by the first input, its sum with the input applied last.
        """
        from hysdel_py.optimize.mpqp import MpQp

        n, q = self.columns.n, chosen.shape[1]
        M, rows = self._in_terms_of(chosen, offset, move_is_input)
        upper, lower = np.isfinite(self.high), np.isfinite(self.low)
        form = np.vstack([rows[upper], -rows[lower]])
        sides = np.concatenate([self.high[upper], -self.low[lower]])
        return MpQp(
            H=2.0 * M[:n, :n],
            f=2.0 * M[:n, -1],
            F=2.0 * M[:n, n : n + q],
            G=form[:, :n],
            w=sides - form[:, -1],
            S=-form[:, n : n + q],
            theta=domain,
            Y=2.0 * M[n : n + q, n : n + q],
            y=2.0 * M[n : n + q, -1],
            constant=float(M[-1, -1]),
        )

    def _in_terms_of(self, chosen: Matrix, offset: Vector, move_is_input: bool) -> tuple[Matrix, Matrix]:
        """Cost and rows over (v, theta', 1)."""
        n, p, nx, nu = self.columns.n, self.columns.p, self.columns.nx, self.columns.nu
        q = chosen.shape[1]
        change = np.zeros((n + p + 1, n + q + 1))
        change[:n, :n] = np.eye(n)
        change[n : n + p, n : n + q] = chosen
        change[n : n + p, -1] = offset
        change[-1, -1] = 1.0
        if move_is_input:
            change[:nu] -= change[n + nx : n + nx + nu]
        return change.T @ self.objective @ change, self.forms @ change


def assemble(
    prediction: LinearPrediction,
    weights: LinearWeights,
    limits: ResolvedLinearLimits,
    rows: tuple[LimitRow, ...],
    tracks: bool,
) -> LinearProgram:
    """Add up the cost and stack the rows."""
    columns = prediction.columns
    M = _tracking_cost(prediction, weights) if tracks else _regulator_cost(prediction, weights)
    for i in range(columns.slacks):
        slack = columns.slack(i)
        M += limits.rho * slack.T @ slack
        M[:, -1] += limits.rho_linear / 2 * slack[0]
        M[-1] += limits.rho_linear / 2 * slack[0]
    M = (M + M.T) / 2
    forms = np.array([row.form for row in rows]).reshape(len(rows), columns.width)
    low, high = (np.array([getattr(row, side) for row in rows], dtype=float) for side in ("low", "high"))
    for array in (M, forms, low, high):
        array.setflags(write=False)
    return LinearProgram(columns, M, rows, forms, low, high)


def _regulator_cost(prediction: LinearPrediction, weights: LinearWeights) -> Matrix:
    stages = zip(prediction.x, prediction.u, weights.Q, weights.R, strict=False)
    last = prediction.x[-1]
    return sum((x.T @ Q @ x + u.T @ R @ u for x, u, Q, R in stages), last.T @ weights.P @ last)


def _tracking_cost(prediction: LinearPrediction, weights: LinearWeights) -> Matrix:
    columns = prediction.columns
    M = np.zeros((columns.width, columns.width))
    tracked = list(weights.tracked)
    for k, (S, T) in enumerate(zip(weights.S, weights.T, strict=True)):
        error = prediction.y[k][tracked] - columns.reference(k)
        M += error.T @ S[np.ix_(tracked, tracked)] @ error + prediction.du[k].T @ T @ prediction.du[k]
    return M
