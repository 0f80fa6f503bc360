"""The program of a moving horizon estimator: least squares over a window of past steps, with the rows of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine, stack
from hysdel_py.control.bounds import branching_variables, signal_ends
from hysdel_py.control.layout import Layout
from hysdel_py.control.rows import model_rows

if TYPE_CHECKING:
    from hysdel_py.optimize.miqp import MiqpResult, MiqpSettings, MiqpSolver
    from hysdel_py.optimize.qp import Qp

__all__ = ["Variances", "Window", "assemble_window"]

Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Variances:
    """Of the guess of the first state, the measured outputs, and what disturbs each state; 0 for an exact equation."""

    arrival: Matrix
    noise: Matrix
    process: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """Minimise ``sum weights (S v + s - target)^2 + linear' v`` over the decision variables v of M steps.

    The variables are those of :class:`~hysdel_py.control.layout.Layout`, and behind them the first state. The targets
    are the guess of the first state, the measurements, and 0 for the equations that are not exact.
    """

    layout: Layout
    S: Any
    s: Matrix
    weights: Matrix
    linear: Matrix
    solver: MiqpSolver

    @property
    def floor(self) -> float:
        """A lower bound that needs no proof: squares, and prices of inputs that are not negative."""
        lb = self.solver.miqp.qp.lb
        return 0.0 if bool(np.all(lb[self.linear > 0] >= 0)) else -inf

    def solve(self, arrival: Matrix, y: Sequence[Matrix], u: Sequence[Matrix], known: Sequence[int]) -> MiqpResult:
        """Solve for a guess of the first state, measurements and known inputs; `known` has their columns."""
        rest = len(self.s) - len(arrival) - sum(len(entry) for entry in y)
        offset = self.s - np.concatenate([arrival, *y, np.zeros(rest)])
        qp = self.solver.miqp.qp
        lb, ub = qp.lb.copy(), qp.ub.copy()
        for k, entry in enumerate(u):
            at = self.layout.start("u", k) + np.array(known, dtype=np.intp)
            lb[at] = ub[at] = entry
        q = self.linear + 2.0 * (self.S.T @ (self.weights * offset))
        return self.solver.solve(q, lb=lb, ub=ub, constant=float(offset @ (self.weights * offset)), floor=self.floor)


def assemble_window(
    layout: Layout, outputs: Indices, variances: Variances, prices: Matrix, settings: MiqpSettings
) -> Window:
    """Assemble the program of a window.

    Parameters
    ----------
    layout : Layout
        Of M steps, without slacks and terms.
    outputs : array of int
        Which outputs are measured.
    variances : Variances
    prices : array of shape (nu,)
        Linear cost of the inputs.
    settings : MiqpSettings
    """
    terms = list(_terms(layout, outputs, variances))
    signals = stack([value for value, _ in terms], layout.n, layout.parameters)
    weights = np.concatenate([weight for _, weight in terms])
    S = _with_first_state(signals, layout.mld.nx)
    linear = np.zeros(layout.n + layout.mld.nx)
    for k in range(layout.horizon):
        linear[layout.start("u", k) : layout.start("u", k) + layout.mld.nu] = prices
    qp = _program(layout, S, weights, np.flatnonzero(variances.process == 0))
    return Window(layout, S, signals.c, weights, linear, _solver(layout, qp, settings))


def _terms(layout: Layout, outputs: Indices, variances: Variances) -> list[tuple[Affine, Matrix]]:
    """Signals and their weights, the inverse variances."""
    steps, inexact = range(layout.horizon), np.flatnonzero(variances.process)
    return [
        (layout.signal("x", 0), 1.0 / variances.arrival),
        *((layout.signal("y", k).entries(outputs), 1.0 / variances.noise) for k in steps),
        *((_equation(layout, k).entries(inexact), 1.0 / variances.process[inexact]) for k in steps),
    ]


def _equation(layout: Layout, k: int) -> Affine:
    return layout.signal("x", k + 1) - layout.successor(k)


def _with_first_state(value: Affine, nx: int) -> Any:
    """Coefficients over the variables and, behind them, the first state."""
    from scipy.sparse import csr_array, hstack

    return csr_array(hstack([value.V, csr_array(value.X[:, :nx])], format="csr"))


def _program(layout: Layout, S: Any, weights: Matrix, exact: Indices) -> Qp:
    """Hessian, rows and bounds; the rest depends on the measurements."""
    from scipy.sparse import csc_array, diags_array

    from hysdel_py.optimize.qp import Qp

    nx, steps = layout.mld.nx, range(layout.horizon)
    P = csc_array(2.0 * (S.T @ diags_array(weights) @ S))
    equal = stack([_equation(layout, k).entries(exact) for k in steps], layout.n, layout.parameters)
    below = stack([model_rows(layout, k).value for k in steps], layout.n, layout.parameters)
    rows = _with_first_state(stack([equal, below], layout.n, layout.parameters), nx)
    low, high = np.concatenate([-equal.c, np.full(len(below.c), -inf)]), np.concatenate([-equal.c, -below.c])
    ends = [signal_ends(layout.stage_variables)] * layout.horizon + [signal_ends(layout.mld.x)]
    lb, ub = (np.concatenate([pair[i] for pair in ends]) for i in (0, 1))
    return Qp((P + P.T) / 2, np.zeros(P.shape[0]), rows, low, high, lb, ub)


def _solver(layout: Layout, qp: Qp, settings: MiqpSettings) -> MiqpSolver:
    from hysdel_py.optimize.miqp import Miqp, MiqpSolver

    binaries, stages = _binaries(layout)
    return MiqpSolver(Miqp(qp, binaries, priorities=stages), settings)


def _binaries(layout: Layout) -> tuple[Indices, Indices]:
    """Boolean states of the beginning, then those that a plan branches on, and their stages."""
    at, stages = branching_variables(layout, layout.horizon)
    first = layout.n + np.flatnonzero([v.is_bool for v in layout.mld.x])
    return np.concatenate([first, at]), np.concatenate([np.zeros(len(first), dtype=np.intp), stages])
