"""The decorator of the kernels."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import Any, TypeVar

__all__ = ["COMPILED", "kernel"]

F = TypeVar("F", bound=Callable[..., Any])

COMPILED = find_spec("numba") is not None
"""Whether the kernels are compiled."""


def kernel(function: F) -> F:
    """Compile a function at its first call and keep the machine code in the cache on disk; without numba, return it."""
    if not COMPILED:
        return function
    from numba import njit

    compiled: F = njit(cache=True)(function)
    return compiled
