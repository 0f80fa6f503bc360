"""Numerical kernels: compiled where numba is installed, plain Python where it is not."""

from __future__ import annotations

from hysdel_py.compiled.decorators import (
    compiled,
    either,
    is_on_disk,
    kernels_are_compiled,
    kernels_wait,
    leaf,
    reordered,
)

__all__ = ["compiled", "either", "is_on_disk", "kernels_are_compiled", "kernels_wait", "leaf", "reordered"]
