"""Checks of numbers given by a user."""

from __future__ import annotations

from numbers import Real
from typing import Any

import numpy as np

from hysdel_py.errors import ArgumentError

__all__ = ["checked_stage", "positive", "whole"]


def whole(value: Any, what: str, least: int = 1) -> int:
    """A whole number, also one that is written as 2.0.

    Raises
    ------
    ArgumentError
        It is none, or below `least`.
    """
    if not _is_number(value) or value != int(value) or value < least:
        raise ArgumentError(f"{what} is {value!r}: a whole number of at least {least} was expected")
    return int(value)


def positive(value: Any, what: str) -> float:
    """A positive and finite number.

    Raises
    ------
    ArgumentError
        It is not.
    """
    if not _is_number(value) or value <= 0:
        raise ArgumentError(f"{what} is {value!r}: a positive number was expected")
    return float(value)


def checked_stage(stage: Any, first: int, last: int) -> int:
    """The number of a stage.

    Raises
    ------
    ArgumentError
        It is no whole number from `first` to `last`.
    """
    if not _is_number(stage) or stage != int(stage) or not first <= stage <= last:
        raise ArgumentError(f"stage is {stage!r}: one from {first} to {last} was expected")
    return int(stage)


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_) and bool(np.isfinite(float(value)))
