"""One line about a system, for the prompt of an interpreter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

__all__ = ["counted", "one_line"]


class _HasSignals(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def x(self) -> Sequence[Any]: ...
    @property
    def u(self) -> Sequence[Any]: ...
    @property
    def y(self) -> Sequence[Any]: ...


def counted(count: int, word: str) -> str:
    """A number with its word, as in ``1 state`` and ``2 states``."""
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def one_line(system: _HasSignals, *more: str) -> str:
    """Class, name and sizes of a system in angle brackets."""
    sizes = (counted(len(system.x), "state"), counted(len(system.u), "input"), counted(len(system.y), "output"))
    return f"<{type(system).__name__} {system.name}: {', '.join((*sizes, *more))}>"
