"""What the kernels of this room are made with; see :mod:`hysdel_py.compiled`."""

from __future__ import annotations

from hysdel_py.compiled import compiled, either, kernels_are_compiled, leaf, reordered

__all__ = ["compiled", "either", "kernels_are_compiled", "leaf", "reordered"]
