"""Number types that the table of an explicit law may have, and how it is scaled for them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.errors import ArgumentError

__all__ = ["Number", "Scaling", "scaling_of"]

Array = NDArray[np.float64]

_FRACTION = {"int16": 14, "int32": 24}
"""Bits of the fraction; every entry of the table is at most one in absolute value before it is rounded."""


class Number(Enum):
    """Type of the numbers of a table."""

    DOUBLE = "double"
    FLOAT = "float"
    INT32 = "int32"
    INT16 = "int16"

    @classmethod
    def of(cls, name: str) -> Number:
        """The type with a name.

        Raises
        ------
        ArgumentError
            There is none.
        """
        try:
            return cls(name)
        except ValueError:
            known = ", ".join(number.value for number in cls)
            raise ArgumentError(f"number is {name!r}: one of {known} was expected") from None

    @property
    def is_fixed(self) -> bool:
        """Whether numbers are integers with a fixed scale."""
        return self.value in _FRACTION

    @property
    def c_type(self) -> str:
        """Type in C."""
        return f"{self.value}_t" if self.is_fixed else self.value

    @property
    def bytes(self) -> int:
        """Size of one number."""
        return {Number.DOUBLE: 8, Number.FLOAT: 4, Number.INT32: 4, Number.INT16: 2}[self]

    @property
    def one(self) -> float:
        """What stands for one in the table."""
        return float(2 ** _FRACTION.get(self.value, 0))

    @property
    def epsilon(self) -> float:
        """Relative rounding error of a number of the table, relative to one for integers."""
        match self:
            case Number.DOUBLE:
                return float(np.finfo(np.float64).eps)
            case Number.FLOAT:
                return float(np.finfo(np.float32).eps)
            case _:
                return 1.0 / self.one


@dataclass(frozen=True, eq=False, slots=True)
class Scaling:
    """``zeta = zero + step * raw`` and ``u = unit * raw``; no change where the numbers are floating.

    Attributes
    ----------
    number : Number
    zero, step : arrays of shape (p,)
    unit : array of shape (moves,)
    size : array of shape (p,)
        Greatest absolute value of each parameter in the domain.
    """

    number: Number
    zero: Array
    step: Array
    unit: Array
    size: Array

    def planes(self, normals: Array, offsets: Array) -> Array:
        """Rows ``(normal, offset)`` for raw parameters."""
        table = np.column_stack([normals, offsets])
        if not self.number.is_fixed:
            return table
        raw = np.column_stack([normals * self.step * self.number.one, offsets + normals @ self.zero])
        return np.asarray(np.rint(raw / np.abs(raw).max(axis=1, keepdims=True) * self.number.one))

    def maps(self, K: Array, k: Array) -> Array:
        """Maps ``(K, k)`` from raw parameters to raw moves."""
        if not self.number.is_fixed:
            return np.concatenate([K, k[..., None]], axis=-1)
        return np.asarray(np.rint(_raw_maps(K, k, self) / self.unit[:, None]))

    def raw(self, zeta: Array) -> Array:
        """Parameters as the code takes them."""
        return np.asarray(np.rint((zeta - self.zero) / self.step)) if self.number.is_fixed else zeta

    def slack(self, planes: Array) -> float:
        """What rounding may add to the value of a plane, in the units of the table."""
        p = int(planes.shape[1]) - 1
        if self.number.is_fixed:
            return float((p + 1) * self.number.one)
        terms = np.abs(planes[:, :p]) @ self.size + np.abs(planes[:, p])
        return 2.0 * (p + 1) * self.number.epsilon * float(terms.max(initial=0.0))

    def margin(self, normals: Array, offsets: Array) -> float:
        """Distance from a plane at which no rounding changes the side, in the units of the parameters."""
        if not self.number.is_fixed:
            return self.slack(np.column_stack([normals, offsets]))
        raw = np.column_stack([normals * self.step * self.number.one, offsets + normals @ self.zero])
        return 2.0 * (int(normals.shape[1]) + 1) * self.number.epsilon * float(np.abs(raw).max(initial=0.0))

    def move_error(self, K: Array, k: Array) -> Array:
        """Bound on the rounding error of each move."""
        p = K.shape[-1]
        if self.number.is_fixed:
            gains = np.abs(K) @ self.step
            return np.asarray((0.5 * (p + 1) + 1.0) * self.unit + 0.5 * gains.max(axis=0))
        terms = np.abs(K) @ self.size + np.abs(k)
        return np.asarray(2.0 * (p + 1) * self.number.epsilon * terms.max(axis=0))


def scaling_of(law: ExplicitLaw, number: Number) -> Scaling:
    """Scaling of the parameters by their ranges and of the moves by their greatest coefficient.

    Raises
    ------
    ArgumentError
        The domain is unbounded.
    """
    low, high = law.domain.bounding_box
    if not np.isfinite(np.concatenate([low, high])).all():
        name = law.names[int(np.argmin(np.isfinite(low) & np.isfinite(high)))]
        raise ArgumentError(f"the parameter {name} has no finite range: bound the domain of the law")
    size = np.maximum(np.abs(low), np.abs(high))
    p, moves = law.p, law.moves
    if not number.is_fixed:
        return Scaling(number, np.zeros(p), np.ones(p), np.ones(moves), size)
    plain = Scaling(number, (low + high) / 2.0, (high - low) / 2.0 / number.one, np.ones(moves), size)
    raw = _raw_maps(law.K[:, :moves], law.k[:, :moves], plain)
    greatest = np.abs(raw).max(axis=(0, 2), initial=0.0)
    unit = np.where(greatest > 0, greatest, 1.0) / number.one
    return Scaling(number, plain.zero, plain.step, unit, size)


def _raw_maps(K: Array, k: Array, scaling: Scaling) -> Array:
    """Coefficients of parameters that run from -1 to 1."""
    return np.concatenate([K * scaling.step * scaling.number.one, (k + K @ scaling.zero)[..., None]], axis=-1)
