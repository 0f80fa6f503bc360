"""Ctrl-C as a question at the first time and an order at the second."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["Interruption", "first_interrupt"]


class Interruption:
    """Whether Ctrl-C was pressed."""

    def __init__(self) -> None:
        self.asked = False

    def note(self, _number: int, _frame: FrameType | None) -> None:
        """Remember the first; the second is an exception like everywhere else."""
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True


@contextmanager
def first_interrupt() -> Iterator[Interruption]:
    """Inside, the first Ctrl-C is only noted, for work that looks after each piece whether it should end."""
    found = Interruption()
    if threading.current_thread() is not threading.main_thread():
        yield found  # signals belong to the main thread
        return
    before = signal.signal(signal.SIGINT, found.note)
    try:
        yield found
    finally:
        signal.signal(signal.SIGINT, before)
