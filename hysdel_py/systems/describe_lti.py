"""A linear system as text."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.describe import variable_lines
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.signals import Variable

__all__ = ["describe_lti"]

Matrix = NDArray[np.float64]


def describe_lti(lti: Lti) -> str:
    """Variables, then one equation per state and output; ``'`` marks the next value of a state."""
    lines = [f"{lti.name}: linear system, sample time {lti.ts:g}"]
    lines += variable_lines({"x": lti.x, "u": lti.u, "y": lti.y})
    lines += _equations([f"{v.name}'" for v in lti.x], np.column_stack([lti.A, lti.B, lti.f]), (*lti.x, *lti.u))
    lines += _equations([v.name for v in lti.y], np.column_stack([lti.C, lti.D, lti.g]), (*lti.x, *lti.u))
    return "\n".join(lines) + "\n"


def _equations(left: list[str], rows: Matrix, signals: tuple[Variable, ...]) -> list[str]:
    """One line per row of coefficients, the last of which is the constant."""
    names = [v.name for v in signals]
    forms = [Affine(row[-1], _terms(names, row[:-1])) for row in rows.tolist()]
    return [f"  {name} = {form}" for name, form in zip(left, forms, strict=True)]


def _terms(names: list[str], values: list[float]) -> tuple[tuple[str, float], ...]:
    return tuple((name, value) for name, value in zip(names, values, strict=True) if value)
