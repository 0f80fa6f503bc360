"""Who wants to know when kernels are compiled, which takes seconds to a minute at their first use."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

__all__ = ["compiling", "told_of_compiling"]

_LISTENER: ContextVar[Callable[[], None] | None] = ContextVar("_LISTENER", default=None)


@contextmanager
def told_of_compiling(tell: Callable[[], None]) -> Iterator[None]:
    """Within this context `tell` is called before each kernel that is compiled, not for those that are on disk.

    Parameters
    ----------
    tell : callable
        Takes no argument.
    """
    token = _LISTENER.set(tell)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def compiling() -> None:
    """Tell whoever listens that a kernel is about to be compiled."""
    tell = _LISTENER.get()
    if tell is not None:
        tell()
