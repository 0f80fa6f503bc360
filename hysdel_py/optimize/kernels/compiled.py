"""The decorator of the kernels."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any

__all__ = ["COMPILED", "kernel"]

COMPILED = find_spec("numba") is not None
"""Whether the kernels are compiled."""


def _forget_stale_code(folder: Path) -> None:
    """Remove cached machine code that is older than any kernel: the cache looks at a function's own file only."""
    newest = max(source.stat().st_mtime for source in folder.glob("*.py"))
    for index in (folder / "__pycache__").glob("*.nbi"):
        with suppress(OSError):
            if index.stat().st_mtime < newest:
                index.unlink()


if COMPILED:
    _forget_stale_code(Path(__file__).parent)


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function at its first call and keep the machine code in the cache on disk; without numba, return it."""
    if not COMPILED:
        return function
    from numba import njit

    compiled: Callable[..., Any] = njit(cache=True)(function)
    return compiled
