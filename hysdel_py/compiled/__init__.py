"""Numerical kernels: compiled where numba is installed, plain Python where it is not."""

from __future__ import annotations

from hysdel_py.compiled.decorators import (
    compiled,
    either,
    kernels_are_compiled,
    kernels_wait,
    leaf,
    reordered,
)
from hysdel_py.compiled.listening import told_of_compiling

__all__ = ["compiled", "either", "kernels_are_compiled", "kernels_wait", "leaf", "reordered", "told_of_compiling"]
