"""Declared names and what they stand for."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from hysdel_py.syntax.source import Span
from hysdel_py.systems.signals import Type

if TYPE_CHECKING:
    from hysdel_py.semantics.expressions import Expression

__all__ = ["BIG_M_BOUND", "EPSILON", "PI", "PREDEFINED", "Role", "Symbol"]

EPSILON = "MLD_epsilon"
"""Name of the predefined parameter that separates the two sides of a threshold."""

BIG_M_BOUND = "MLD_bigMbound"
"""Name of the parameter that bounds, in absolute value, each variable whose range is needed and cannot be known.

It is not predefined: without its declaration such a variable is an error.
"""

PI = "pi"

PREDEFINED: Mapping[str, float] = {PI: math.pi, EPSILON: 1e-6}
"""Parameters that every model has, with their values."""


class Role(Enum):
    """What a declared name is; the value is the word for messages."""

    STATE = "state"
    INPUT = "input"
    OUTPUT = "output"
    AUX = "auxiliary variable"
    PARAMETER = "parameter"


@dataclass(frozen=True, slots=True)
class Symbol:
    """A declared name.

    Attributes
    ----------
    name : str
    type : Type
    role : Role
    span : Span
        Of the name in its declaration; empty at 0 for a predefined parameter.
    line : int
        Of the declaration, 0 for a predefined parameter.
    bounds : pair of Expression, or None
        Declared range of a variable, or of the values that a parameter may have.
    value : Expression or None
        Declared value of a parameter.
    unit, description : str
        From the comment beside the declaration, ``/* [unit] description */``.
    """

    name: str
    type: Type
    role: Role
    span: Span
    line: int
    bounds: tuple[Expression, Expression] | None = field(default=None, compare=False)
    value: Expression | None = field(default=None, compare=False)
    unit: str = ""
    description: str = ""

    @property
    def is_real(self) -> bool:
        """Whether the type is REAL."""
        return self.type is Type.REAL

    @property
    def is_parameter(self) -> bool:
        """Whether the name stands for a constant."""
        return self.role is Role.PARAMETER

    @property
    def spoken(self) -> str:
        """Type and role in words, as in "Boolean state"."""
        return f"{'real' if self.is_real else 'Boolean'} {self.role.value}"
