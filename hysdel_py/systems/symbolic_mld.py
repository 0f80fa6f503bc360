"""The mixed logical dynamical form whose numbers may wait for parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.symbolic import evaluate, parameters_of
from hysdel_py.tolerances import DEFAULT_TOLERANCES, Tolerances

__all__ = ["MATRICES", "SymbolicMld"]

MATRICES = ("A", "B1", "B2", "B3", "B5", "C", "D1", "D2", "D3", "D5", "E1", "E2", "E3", "E4", "E5")
"""Names of the matrices of the form."""

Matrix = NDArray[Any]


@dataclass(frozen=True, eq=False)
class SymbolicMld:
    """An Mld before its parameters have values.

    The attributes are those of :class:`~hysdel_py.systems.mld.Mld`; the matrices are dense arrays of objects, each
    entry a number or a :class:`~hysdel_py.systems.symbolic.Symbolic`, and so are the ranges of the variables.
    """

    name: str
    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    y: tuple[Variable, ...]
    d: tuple[Variable, ...]
    z: tuple[Variable, ...]
    A: Matrix
    B1: Matrix
    B2: Matrix
    B3: Matrix
    B5: Matrix
    C: Matrix
    D1: Matrix
    D2: Matrix
    D3: Matrix
    D5: Matrix
    E1: Matrix
    E2: Matrix
    E3: Matrix
    E4: Matrix
    E5: Matrix
    rows: tuple[RowOrigin, ...]
    updates: tuple[RowOrigin, ...]
    outputs: tuple[RowOrigin, ...]
    source: str = ""
    tolerances: Tolerances = DEFAULT_TOLERANCES

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters that the matrices and ranges wait for, in alphabetical order."""
        numbers = [entry for name in MATRICES for entry in getattr(self, name).flat]
        numbers += [end for v in (*self.x, *self.u, *self.d, *self.z) for end in (v.low, v.high)]
        return tuple(sorted({name for number in numbers for name in parameters_of(number)}))

    def bind(self, values: Mapping[str, float]) -> Mld:
        """The form for given parameters; the same as that of the model loaded with them.

        Raises
        ------
        ArgumentError
            A parameter is missing or unknown, or its value makes an entry undefined.
        """
        unknown = [name for name in values if name not in self.parameters]
        if unknown:
            known = ", ".join(self.parameters) or "(none)"
            raise ArgumentError(f"there is no open parameter {', '.join(unknown)}: the open parameters are {known}")
        groups: dict[str, Any] = {
            key: tuple(_bound(v, values) for v in getattr(self, key)) for key in ("x", "u", "y", "d", "z")
        }
        matrices: dict[str, Any] = {name: _numbers(getattr(self, name), values) for name in MATRICES}
        return Mld(
            self.name,
            **groups,
            **{name: _sparse(m) if name in ("E1", "E2", "E3", "E4") else m for name, m in matrices.items()},
            rows=self.rows,
            updates=self.updates,
            outputs=self.outputs,
            source=self.source,
            tolerances=self.tolerances,
        )


def _bound(variable: Variable, values: Mapping[str, float]) -> Variable:
    return replace(variable, low=evaluate(variable.low, values), high=evaluate(variable.high, values))


def _numbers(matrix: Matrix, values: Mapping[str, float]) -> NDArray[np.float64]:
    numbers = np.array([evaluate(entry, values) for entry in matrix.flat], dtype=float).reshape(matrix.shape)
    numbers.setflags(write=False)
    return numbers


def _sparse(matrix: NDArray[np.float64]) -> Any:
    from scipy.sparse import csr_array

    return csr_array(matrix)
