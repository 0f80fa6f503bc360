"""The weights of a cost as matrices of a particular model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable

__all__ = ["GroupWeight", "Norm", "Weight", "Weights", "group_weight"]

Matrix = NDArray[np.float64]
Weight = Mapping[str, float] | ArrayLike


class Norm(Enum):
    """How the weighted signals of one group at one time become a number."""

    SQUARES = 2
    """``v' Q v`` with a symmetric positive semidefinite Q."""
    SUM = 1
    """``|Q v|_1``, the sum of absolute values, with any Q of the right number of columns."""
    LARGEST = np.inf
    """``|Q v|_inf``, the largest absolute value, with any Q of the right number of columns."""

    @property
    def is_linear(self) -> bool:
        """Whether the program is a linear one."""
        return self is not Norm.SQUARES


@dataclass(frozen=True, slots=True, eq=False)
class GroupWeight:
    """Weight of one group of signals.

    Attributes
    ----------
    matrix : array of shape (r, n)
        Symmetric positive semidefinite with r = n for the squares, any matrix for the other norms.
    names : tuple of str
        The signals that the cost names, in the order of the model; their number may be zero all the same.
    """

    matrix: Matrix
    names: tuple[str, ...]

    @property
    def columns(self) -> NDArray[np.intp]:
        """Indices of the signals that have any weight at all."""
        return np.flatnonzero(self.matrix.any(axis=0))

    @property
    def block(self) -> Matrix:
        """The matrix without its zero rows and columns."""
        block: Matrix = self.matrix[np.ix_(np.flatnonzero(self.matrix.any(axis=1)), self.columns)]
        return block


@dataclass(frozen=True, slots=True)
class Weights:
    """The weights of a cost as matrices of a particular model."""

    y: GroupWeight
    x: GroupWeight
    u: GroupWeight
    du: GroupWeight
    d: GroupWeight
    z: GroupWeight
    terminal: GroupWeight
    norm: Norm = Norm.SQUARES

    @property
    def names(self) -> tuple[str, ...]:
        """Every signal that the cost names, outputs first, each once; increments have no references."""
        groups = (self.y, self.x, self.terminal, self.u, self.d, self.z)
        return tuple(dict.fromkeys(name for group in groups for name in group.names))


def group_weight(
    weight: Weight | None, variables: Sequence[Variable], what: str, norm: Norm, tolerance: float
) -> GroupWeight:
    """Check the weight of one group against the signals of the model.

    Parameters
    ----------
    weight : mapping of name to number, vector, matrix or None
    variables : sequence of Variable
    what : str
        Name of the group, for messages.
    norm : Norm
    tolerance : float
        Up to which part of its largest entry a matrix counts as symmetric positive semidefinite.

    Raises
    ------
    ArgumentError
        Unknown name, wrong shape, not a number, a negative number, or a matrix that the norm does not allow.
    """
    names = tuple(v.name for v in variables)
    if weight is None:
        return GroupWeight(np.zeros((len(names), len(names))), ())
    if isinstance(weight, Mapping):
        diagonal = _from_names(weight, names, what)
        return GroupWeight(np.diag(diagonal), tuple(name for name in names if name in weight))
    return GroupWeight(_from_array(weight, names, what, norm, tolerance), names)


def _from_names(weight: Mapping[str, float], names: tuple[str, ...], what: str) -> Matrix:
    unknown = [str(name) for name in weight if name not in names]
    if unknown:
        raise ArgumentError(
            f"weight {what}: there is no signal named {', '.join(unknown)}; expected {', '.join(names) or '(none)'}"
        )
    diagonal = np.zeros(len(names))
    for name, number in weight.items():
        diagonal[names.index(name)] = _number(number, f"weight {what} of {name}")
    return diagonal


def _number(number: float, what: str) -> float:
    try:
        value = float(number)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {number!r}: a number was expected") from None
    if not (np.isfinite(value) and value >= 0):
        raise ArgumentError(f"{what} is {value:g}: a finite number of at least 0 was expected")
    return value


def _from_array(weight: ArrayLike, names: tuple[str, ...], what: str, norm: Norm, tolerance: float) -> Matrix:
    n = len(names)
    try:
        array = np.array(weight, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(f"weight {what} is {weight!r}: numbers were expected") from None
    if array.shape == (n,):
        return np.diag([_number(entry, f"weight {what} of {name}") for entry, name in zip(array, names, strict=True)])
    if array.ndim != 2 or array.shape[1] != n or (norm is Norm.SQUARES and len(array) != n):
        rows = "a matrix" if norm.is_linear else f"a {n} by {n} matrix"
        raise ArgumentError(
            f"weight {what} has shape {array.shape}: {n} numbers or {rows} with {n} columns was expected, in the order "
            f"{', '.join(names) or '(none)'}"
        )
    if not np.isfinite(array).all():
        raise ArgumentError(f"weight {what} has an entry that is not a finite number")
    return array if norm.is_linear else _semidefinite(array, what, tolerance)


def _semidefinite(matrix: Matrix, what: str, tolerance: float) -> Matrix:
    slack = tolerance * float(np.abs(matrix).max(initial=0.0))
    if np.abs(matrix - matrix.T).max(initial=0.0) > slack:
        raise ArgumentError(f"weight {what} is not symmetric: a symmetric positive semidefinite matrix was expected")
    smallest = float(np.linalg.eigvalsh(matrix).min(initial=0.0))
    if smallest < -slack:
        raise ArgumentError(
            f"weight {what} has the negative eigenvalue {smallest:g}: a positive semidefinite matrix was expected"
        )
    symmetric: Matrix = (matrix + matrix.T) / 2
    return symmetric
