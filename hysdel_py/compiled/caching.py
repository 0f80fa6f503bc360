"""What numba makes of a function, kept on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

__all__ = ["cached"]

F = TypeVar("F", bound=Callable[..., Any])


def cached(function: F, **options: Any) -> F:
    """What ``numba.njit`` makes of a function, kept on disk where there is a place."""
    import numba

    try:
        return numba.njit(cache=True, **options)(function)  # type: ignore[no-any-return]
    except RuntimeError:  # no place to keep the compiled code
        return numba.njit(**options)(function)  # type: ignore[no-any-return]
