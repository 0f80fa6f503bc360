"""The program of a hybrid controller over its parameters and decision variables at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_parameters import REFERENCE, Parameter, Parameters
from hysdel_py.control.formulation import Formulation
from hysdel_py.optimize.mixed_parametric.problem import MpMiqp

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["columns_of_plan", "parametric_program"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
Indices = NDArray[np.intp]


def columns_of_plan(parameters: Parameters) -> int:
    """Column of the first decision variable: real parameters, then Boolean ones, stand before."""
    return len(parameters.real) + len(parameters.boolean)


def parametric_program(formulation: Formulation, parameters: Parameters) -> MpMiqp:
    """The program with free parameters as variables; fixed ones are put in.

    Parameters
    ----------
    formulation : Formulation
    parameters : Parameters
    """
    from scipy.sparse import csr_array, vstack

    f = formulation
    order = (*parameters.real, *parameters.boolean)
    start = [p for p in parameters.every if p.group != REFERENCE]
    own, base = _selection(start, order)
    own, base = _padded(own, base, f.layout.parameters)
    targets, aims = _targets(f, parameters, order)
    rows, offset = _rows(f, (own, base), (targets, aims))
    conditions = csr_array(np.hstack([f.conditions.X @ own, np.zeros((len(f.condition_rows), f.layout.n))]))
    fails = f.conditions.X @ base + f.conditions.c
    H, g, constant = _cost(f, (own, base), (targets, aims))
    first = len(order)
    reals = len(parameters.real)
    booleans = np.arange(reals, first)
    ends = np.array([(p.low, p.high) for p in order], dtype=float).reshape(-1, 2)
    lb, ub = f.lb.copy(), f.ub.copy()
    ub[f.layout.term(0) :] = np.inf
    return MpMiqp(
        H=H,
        g=g,
        constant=constant,
        A=csr_array(vstack([rows, conditions], format="csr")),
        l=np.concatenate([f.low - offset, np.full(len(fails), -np.inf)]),
        u=np.concatenate([f.high - offset, -fails]),
        lb=np.concatenate([ends[:, 0], lb]),
        ub=np.concatenate([ends[:, 1], ub]),
        parameters=reals,
        binaries=np.concatenate([booleans, f.binaries + first]).astype(np.intp),
        stages=_stages(len(booleans), f),
        reach=np.concatenate([np.zeros(first), _reach(f) + bool(len(booleans))]).astype(np.intp),
    )


def _selection(wanted: Sequence[Parameter], order: tuple[Parameter, ...]) -> tuple[Matrix, Vector]:
    """``wanted = own zeta + base`` with zeta in the given order."""
    own, base = np.zeros((len(wanted), len(order))), np.zeros(len(wanted))
    for row, parameter in enumerate(wanted):
        if parameter.is_fixed:
            base[row] = parameter.value
        else:
            own[row, order.index(parameter)] = 1.0
    return own, base


def _padded(own: Matrix, base: Vector, size: int) -> tuple[Matrix, Vector]:
    """The same with zeros for the input applied last where it does not count."""
    missing = size - len(base)
    return np.vstack([own, np.zeros((missing, own.shape[1]))]), np.append(base, np.zeros(missing))


def _targets(f: Formulation, parameters: Parameters, order: tuple[Parameter, ...]) -> tuple[Matrix, Vector]:
    """References of all tracked signals in terms of zeta; those of increments are zero."""
    references = {p.signal: p for p in parameters.group(REFERENCE)}
    own, base = _selection(list(references.values()), order)
    rows = {name: row for row, name in enumerate(references)}
    tracked = f.objective.tracked
    matrix, vector = np.zeros((len(tracked), len(order))), np.zeros(len(tracked))
    for at, signal in enumerate(tracked):
        if signal.group != "du" and signal.name in rows:
            matrix[at], vector[at] = own[rows[signal.name]], base[rows[signal.name]]
    return matrix, vector


def _rows(f: Formulation, start: tuple[Matrix, Vector], targets: tuple[Matrix, Vector]) -> tuple[csr_array, Vector]:
    """Rows over (zeta, v), and what the fixed parameters add to them."""
    from scipy.sparse import csr_array, hstack

    (own, base), (aims, goals) = start, targets
    across, offset = f.shift.X @ own, f.shift.X @ base + f.shift.c
    first = len(offset) - f.epigraph.references.shape[0]
    across[first:] += f.epigraph.references @ aims
    offset[first:] += f.epigraph.references @ goals
    return csr_array(hstack([csr_array(across), f.shift.V], format="csr")), offset


def _cost(
    f: Formulation, start: tuple[Matrix, Vector], targets: tuple[Matrix, Vector]
) -> tuple[csr_array, Vector, float]:
    """Hessian, gradient and constant over (zeta, v)."""
    from scipy.sparse import csr_array, diags_array, hstack

    (own, base), (aims, goals) = start, targets
    signals, Q = f.objective.signals, f.objective.Q
    J = csr_array(hstack([csr_array(signals.X @ own - aims), signals.V], format="csr"))
    offset = signals.X @ base + signals.c - goals
    pull = Q @ offset
    first = own.shape[1]
    H = csr_array(2.0 * (J.T @ (Q @ J)) + diags_array(np.concatenate([np.zeros(first), _prices(f)])))
    g = 2.0 * (J.T @ pull) + np.concatenate([np.zeros(first), f.objective.linear])
    return H, g, float(offset @ pull)


def _prices(f: Formulation) -> Vector:
    """Diagonal of the Hessian that the slacks add; they enter no signal."""
    diagonal = np.zeros(f.layout.n)
    slacks = slice(f.layout.slack(0), f.layout.term(0))
    diagonal[slacks] = f.objective.P.diagonal()[slacks]
    return diagonal


def _stages(booleans: int, f: Formulation) -> Indices:
    """Boolean parameters make a stage of their own before the first."""
    return np.concatenate([np.zeros(booleans), f.stages + bool(booleans)]).astype(np.intp)


def _reach(f: Formulation) -> Indices:
    """Stage of each decision variable; slacks and terms of the cost belong to the last one."""
    layout = f.layout
    stages = np.repeat(np.arange(layout.horizon), layout.stage_size)
    return np.concatenate([stages, np.full(layout.n - len(stages), layout.horizon - 1)])
