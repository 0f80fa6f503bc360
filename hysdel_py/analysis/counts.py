"""Whole numbers among arguments."""

from __future__ import annotations

from operator import index
from typing import SupportsIndex

from hysdel_py.errors import ArgumentError

__all__ = ["counted"]


def counted(value: SupportsIndex, least: int, name: str) -> int:
    """An argument as a whole number.

    Raises
    ------
    ArgumentError
        It is none, a truth value, or below the least one that makes sense.
    """
    try:
        count = least - 1 if isinstance(value, bool) else index(value)
    except TypeError:
        count = least - 1
    if count < least:
        raise ArgumentError(f"{name} is {value!r}: a whole number of at least {least} was expected")
    return count
