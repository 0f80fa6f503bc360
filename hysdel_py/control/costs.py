"""What a hybrid controller minimises: quadratic weights on the signals of the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES, ControlTolerances
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

__all__ = ["Cost", "GroupWeight", "Weight", "Weights"]

Matrix = NDArray[np.float64]
Weight = Mapping[str, float] | ArrayLike


@dataclass(frozen=True, slots=True)
class Cost:
    """Quadratic cost of a plan, in the formulation of the HYBCON controllers of the Hybrid Toolbox.

    ::

        (x_N - rx)' Q_terminal (x_N - rx)
          + sum_{k=0}^{N-1} |y_k - ry|^2_Qy + |u_k - ru|^2_Qu + |d_k - rd|^2_Qd + |z_k - rz|^2_Qz
          + sum_{k=1}^{N-1} |x_k - rx|^2_Qx

    with ``|v|^2_Q = v' Q v`` (no factor one half). Slacks of softened limits are added by
    :class:`~hysdel_py.control.limits.Limits`.

    Attributes
    ----------
    y, x, u, d, z : mapping of name to number, vector, or matrix, optional
        Weight of the outputs, states, inputs, Boolean auxiliaries and real auxiliaries: a number per name (signals
        that are not named have no weight), a vector with one number per signal of the group, or a full symmetric
        positive semidefinite matrix. What is left out has no weight: a cost without any weight accepts every plan
        that the model and the limits allow.
    terminal : as `x`, optional
        Weight of the last state; the weight `x` where it is left out. Give ``{}`` for a last state without weight.
    norm : int
        2. The norms 1 and infinity are not available.

    Raises
    ------
    ArgumentError
        If `norm` is not 2. Weights are checked when a controller is built, because only then is the model known.

    Examples
    --------
    >>> Cost(y={"speed": 1.0, "torque": 0.1}, u={"brake": 0.01}).norm
    2
    """

    y: Weight | None = None
    x: Weight | None = None
    u: Weight | None = None
    d: Weight | None = None
    z: Weight | None = None
    terminal: Weight | None = None
    norm: int = 2

    def __post_init__(self) -> None:
        if isinstance(self.norm, bool) or self.norm != 2:
            raise ArgumentError(f"norm is {self.norm!r}: only norm=2 (quadratic cost) is available")

    def resolve(self, mld: Mld, tolerances: ControlTolerances = DEFAULT_CONTROL_TOLERANCES) -> Weights:
        """Check the weights against a model and return them as matrices.

        Raises
        ------
        ArgumentError
            Unknown name, wrong shape, not a number, negative weight, or a matrix that is not symmetric positive
            semidefinite.
        """

        def group(weight: Weight | None, variables: tuple[Variable, ...], what: str) -> GroupWeight:
            return _group_weight(weight, variables, what, tolerances.definite)

        x = group(self.x, mld.x, "x")
        return Weights(
            y=group(self.y, mld.y, "y"),
            x=x,
            u=group(self.u, mld.u, "u"),
            d=group(self.d, mld.d, "d"),
            z=group(self.z, mld.z, "z"),
            terminal=x if self.terminal is None else group(self.terminal, mld.x, "terminal"),
        )


@dataclass(frozen=True, slots=True, eq=False)
class GroupWeight:
    """Weight of one group of signals.

    Attributes
    ----------
    matrix : array of shape (n, n)
        Symmetric positive semidefinite.
    names : tuple of str
        The signals that the cost names, in the order of the model; their number may be zero all the same.
    """

    matrix: Matrix
    names: tuple[str, ...]

    @property
    def columns(self) -> NDArray[np.intp]:
        """Indices of the signals that have any weight at all."""
        return np.flatnonzero(self.matrix.any(axis=1))


@dataclass(frozen=True, slots=True)
class Weights:
    """The weights of a cost as matrices of a particular model."""

    y: GroupWeight
    x: GroupWeight
    u: GroupWeight
    d: GroupWeight
    z: GroupWeight
    terminal: GroupWeight

    @property
    def names(self) -> tuple[str, ...]:
        """Every signal that the cost names, outputs first, each once."""
        groups = (self.y, self.x, self.terminal, self.u, self.d, self.z)
        return tuple(dict.fromkeys(name for group in groups for name in group.names))


def _group_weight(weight: Weight | None, variables: Sequence[Variable], what: str, tolerance: float) -> GroupWeight:
    names = tuple(v.name for v in variables)
    if weight is None:
        return GroupWeight(np.zeros((len(names), len(names))), ())
    if isinstance(weight, Mapping):
        diagonal = _from_names(weight, names, what)
        return GroupWeight(np.diag(diagonal), tuple(name for name in names if name in weight))
    return GroupWeight(_from_array(weight, names, what, tolerance), names)


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


def _from_array(weight: ArrayLike, names: tuple[str, ...], what: str, tolerance: float) -> Matrix:
    n = len(names)
    try:
        array = np.array(weight, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(f"weight {what} is {weight!r}: numbers were expected") from None
    if array.shape == (n,):
        return np.diag([_number(entry, f"weight {what} of {name}") for entry, name in zip(array, names, strict=True)])
    if array.shape != (n, n):
        raise ArgumentError(
            f"weight {what} has shape {array.shape}: {n} numbers or a {n} by {n} matrix was expected, in the order "
            f"{', '.join(names) or '(none)'}"
        )
    _check_semidefinite(array, what, tolerance)
    symmetric: Matrix = (array + array.T) / 2
    return symmetric


def _check_semidefinite(matrix: Matrix, what: str, tolerance: float) -> None:
    if not np.isfinite(matrix).all():
        raise ArgumentError(f"weight {what} has an entry that is not a finite number")
    slack = tolerance * float(np.abs(matrix).max(initial=0.0))
    if np.abs(matrix - matrix.T).max(initial=0.0) > slack:
        raise ArgumentError(f"weight {what} is not symmetric: a symmetric positive semidefinite matrix was expected")
    smallest = float(np.linalg.eigvalsh(matrix).min(initial=0.0))
    if smallest < -slack:
        raise ArgumentError(
            f"weight {what} has the negative eigenvalue {smallest:g}: a positive semidefinite matrix was expected"
        )
