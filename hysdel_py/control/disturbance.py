"""Constant disturbances as states of a model, so that a controller can act against them without an offset.

A state that nothing changes is added to an output, or to an input where it enters the equations. An observer estimates
it; a controller of the extended model then plans with the disturbance. With as many output disturbances as measured
outputs the outputs reach constant references although model and plant differ by a constant (U. Maeder, F. Borrelli,
M. Morari, "Linear offset-free model predictive control", Automatica 45, 2009, for the linear case; here within one
mode).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.construction import mld_of
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Kind, Type, Variable

__all__ = ["PREFIX", "with_disturbances"]

Matrix = NDArray[np.float64]
PREFIX = "offset_"
"""What the name of a disturbance begins with."""


def with_disturbances(
    model: Any, outputs: Mapping[str, float] | None = None, inputs: Mapping[str, float] | None = None
) -> Mld:
    """Return the MLD form with a constant disturbance on some outputs and inputs.

    Parameters
    ----------
    model : Model or Mld
    outputs, inputs : mapping of name to number
        Signals with a disturbance, and its largest absolute value. The states are called ``offset_NAME`` and stand
        behind the real states of the model, outputs first.

    Raises
    ------
    ArgumentError
        Unknown or Boolean signals, sizes that are not positive, or an input that the inequalities of the model use: its
        disturbance would move thresholds, whose rows are valid for the declared range of the input alone.

    Examples
    --------
    >>> import hysdel_py as hys
    >>> extended = with_disturbances(hys.load("two_tanks"), outputs={"level2": 0.05})
    >>> [v.name for v in extended.x]
    ['h1', 'h2', 'offset_level2']
    """
    mld = mld_of(model)
    chosen = [*_chosen(outputs, mld.y, "output"), *_chosen(inputs, mld.u, "input")]
    for name, variable, _ in chosen:
        if variable.kind is Kind.INPUT:
            _check_free(mld, name)
    return _extended(mld, [(variable, size) for _, variable, size in chosen])


def _chosen(
    given: Mapping[str, float] | None, variables: tuple[Variable, ...], what: str
) -> list[tuple[str, Variable, float]]:
    known = {v.name: v for v in variables}
    found = []
    for name, size in (given or {}).items():
        if name not in known or known[name].is_bool:
            reals = ", ".join(v.name for v in variables if not v.is_bool) or "(none)"
            raise ArgumentError(f"there is no real {what} named {name}: a disturbance may be added to {reals}")
        if not (np.isfinite(size) and size > 0):
            raise ArgumentError(f"the disturbance of {name} has the size {size}: a positive number was expected")
        found.append((name, known[name], float(size)))
    return found


def _check_free(mld: Mld, name: str) -> None:
    column = [v.name for v in mld.u].index(name)
    if mld.E1[:, [column]].nnz:
        raise ArgumentError(
            f"the input {name} appears in the inequalities of the model, so that its disturbance would move their "
            "thresholds; disturb an output instead"
        )


def _extended(mld: Mld, chosen: list[tuple[Variable, float]]) -> Mld:
    at = sum(not v.is_bool for v in mld.x)
    effects = [_effect(mld, variable) for variable, _ in chosen]
    states = tuple(
        Variable(PREFIX + v.name, Type.REAL, Kind.STATE, -size, size, unit=v.unit, description=f"offset of {v.name}")
        for v, size in chosen
    )
    count = len(states)
    A = _inserted_columns(mld.A, at, [effect[0] for effect in effects])
    constant = np.insert(np.zeros((count, mld.nx)), [at] * count, np.eye(count), axis=1)
    return replace(
        mld,
        x=(*mld.x[:at], *states, *mld.x[at:]),
        A=_inserted_rows(A, at, constant),
        C=_inserted_columns(mld.C, at, [effect[1] for effect in effects]),
        E4=_inserted_zeros(mld.E4, at, count),
        updates=_inserted_origins(mld, at, states),
        B1=_inserted_rows(mld.B1, at, np.zeros((count, mld.nu))),
        B2=_inserted_rows(mld.B2, at, np.zeros((count, mld.nd))),
        B3=_inserted_rows(mld.B3, at, np.zeros((count, mld.nz))),
        B5=_inserted_rows(mld.B5, at, np.zeros(count)),
    )


def _effect(mld: Mld, variable: Variable) -> tuple[Matrix, Matrix]:
    """What a disturbance adds to the next state and to the output."""
    if variable.kind is Kind.OUTPUT:
        return np.zeros(mld.nx), np.eye(mld.ny)[mld.y.index(variable)]
    column = mld.u.index(variable)
    return mld.B1[:, column], mld.D1[:, column]


def _inserted_columns(matrix: Matrix, at: int, columns: list[Matrix]) -> Matrix:
    if not columns:
        return matrix
    return np.hstack([matrix[:, :at], np.column_stack(columns), matrix[:, at:]])


def _inserted_rows(matrix: Matrix, at: int, rows: Matrix) -> Matrix:
    return np.concatenate([matrix[:at], rows, matrix[at:]])


def _inserted_zeros(matrix: Any, at: int, count: int) -> Any:
    from scipy.sparse import csr_array, hstack

    nothing = csr_array((matrix.shape[0], count))
    return csr_array(hstack([matrix[:, :at], nothing, matrix[:, at:]], format="csr"))


def _inserted_origins(mld: Mld, at: int, states: tuple[Variable, ...]) -> tuple[RowOrigin, ...]:
    if len(mld.updates) < mld.nx:
        return ()
    new = tuple(RowOrigin("", "", v.name, (v.name,), 0, 1, 1, 0, f"{v.name} is constant") for v in states)
    return (*mld.updates[:at], *new, *mld.updates[at:])
