"""Names, kinds and ranges of the variables of a system, and checks of the vectors that carry their values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from math import inf, isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["Kind", "Type", "Variable", "as_vector", "range_violations"]


class Type(Enum):
    """The two types of the language."""

    REAL = "REAL"
    BOOL = "BOOL"


class Kind(Enum):
    """The role of a variable in a system; the value is the letter of its vector in the MLD form."""

    STATE = "x"
    INPUT = "u"
    OUTPUT = "y"
    BOOLEAN_AUX = "d"
    REAL_AUX = "z"


@dataclass(frozen=True, slots=True)
class Variable:
    """One scalar variable of a system.

    Attributes
    ----------
    name : str
        As written in the source, or ``__additional_k`` for one that a lowering step made.
    type : Type
        Real, or Boolean with the values 0 and 1.
    kind : Kind
        State, input, output or auxiliary.
    low, high : float
        Range, infinite where unknown.
    unit, description : str
        From the comment beside the declaration, empty where there is none.
    line : int
        Line of the declaration (of the item that made it, for a generated one), 0 if unknown.
    generated : bool
        Whether a lowering step made it.
    """

    name: str
    type: Type
    kind: Kind
    low: float = -inf
    high: float = inf
    unit: str = ""
    description: str = ""
    line: int = 0
    generated: bool = False

    @property
    def is_bool(self) -> bool:
        """Whether the variable is Boolean."""
        return self.type is Type.BOOL

    @property
    def label(self) -> str:
        """Name with the unit in brackets, for axes and tables."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def as_vector(value: ArrayLike | Mapping[str, float], variables: Sequence[Variable], what: str) -> NDArray[np.float64]:
    """Check a state or input and return it as a float vector.

    Parameters
    ----------
    value : array_like of shape (n,), or mapping of name to number
        The values, in the order of `variables` or by name.
    variables : sequence of Variable
        What each entry stands for.
    what : str
        Word for messages: ``"state"`` or ``"input"``.

    Raises
    ------
    ArgumentError
        Wrong number of entries, unknown or missing name, not a number, not finite, or a Boolean that is not 0 or 1.
    """
    vector = (
        _from_mapping(value, variables, what) if isinstance(value, Mapping) else _from_array(value, variables, what)
    )
    for entry, variable in zip(vector.tolist(), variables, strict=True):
        if not isfinite(entry):
            raise ArgumentError(f"{what} {variable.name} is {entry}: a finite number was expected")
        if variable.is_bool and entry not in (0.0, 1.0):
            raise ArgumentError(f"{what} {variable.name} is {entry:g}: it is Boolean, 0 or 1 was expected")
    return vector


def _from_mapping(value: Mapping[str, float], variables: Sequence[Variable], what: str) -> NDArray[np.float64]:
    names = [v.name for v in variables]
    unknown = [name for name in value if name not in names]
    missing = [name for name in names if name not in value]
    if unknown:
        raise ArgumentError(
            f"there is no {what} named {', '.join(map(str, unknown))}: the {what}s are {_listed(names)}"
        )
    if missing:
        raise ArgumentError(f"no value for the {what} {', '.join(missing)}: the {what}s are {_listed(names)}")
    return _from_array([value[name] for name in names], variables, what)


def _from_array(value: ArrayLike, variables: Sequence[Variable], what: str) -> NDArray[np.float64]:
    try:
        vector = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"the {what} must be {len(variables)} numbers: {error}") from None
    if vector.ndim == 0 and len(variables) == 1:
        vector = vector.reshape(1)
    if vector.size == 0 and len(variables) == 0:
        vector = vector.reshape(0)
    if vector.shape != (len(variables),):
        names = _listed([v.name for v in variables])
        raise ArgumentError(
            f"the {what} has shape {vector.shape}: {len(variables)} entries were expected, in the order {names}"
        )
    return vector


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) if names else "(none)"


def range_violations(
    values: NDArray[np.float64], variables: Sequence[Variable], what: str, tolerance: float
) -> tuple[str, ...]:
    """Say in one line each which values lie outside the declared range of their variable."""
    return tuple(
        f"{what} {v.name} = {value:.12g} is outside its range [{v.low:g}, {v.high:g}]"
        + (f" (declared in line {v.line})" if v.line else "")
        for value, v in zip(values, variables, strict=True)
        if value < v.low - tolerance * max(1.0, abs(v.low)) or value > v.high + tolerance * max(1.0, abs(v.high))
    )
