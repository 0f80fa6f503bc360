"""Progress on one line of a terminal; nothing where the error stream is no terminal."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from math import inf

from hysdel_py.compiled.listening import told_of_compiling

__all__ = [
    "Progress", "clear_progress", "counter", "progress_line", "tell_of_plain_kernels", "telling_of_compiling",
    "this_python",
]  # fmt: skip

_CLEAR = "\x1b[K"  # what a terminal takes as: empty the line from here on
_CELLS = 24
_LEAST_SECONDS = 0.1
"""Between two lines; a terminal shows no more, and writing takes time."""
_LONG = 5.0
"""Seconds from which on compiled kernels would be missed."""


class Progress:
    """A bar that is drawn at most ten times a second; called with what is done and what there is to do."""

    def __init__(self) -> None:
        self._begin = time.monotonic()
        self._last = -inf

    def __call__(self, done: int, total: int) -> None:
        """Draw ``[######      ] step 12 of at most 50, 3 s left``."""
        now = time.monotonic()
        if done < total and not self.is_due():
            return
        self.tell(f"{bar(done, total)} step {done} of at most {total}{self._left(now, done, total)}")

    def is_due(self) -> bool:
        """Whether the last line has stood long enough."""
        return time.monotonic() - self._last >= _LEAST_SECONDS

    def tell(self, text: str) -> None:
        """Write a line in place of the last one."""
        self._last = time.monotonic()
        print(f"\r{_CLEAR}{text[: _columns() - 1]}", end="", file=sys.stderr, flush=True)

    def _left(self, now: float, done: int, total: int) -> str:
        """Time that the rest takes at the speed so far."""
        passed = now - self._begin
        if not 0 < done < total or passed < 1.0:
            return ""
        return f", {spoken(passed * (total - done) / done)} left"


def bar(done: int, total: int) -> str:
    """The bar alone."""
    filled = _CELLS if total <= 0 else min(_CELLS, max(0, _CELLS * done // total))
    return f"[{'#' * filled}{' ' * (_CELLS - filled)}]"


def spoken(seconds: float) -> str:
    """A time in seconds, minutes or hours."""
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    return f"{round(whole / 60)} min" if whole < 7200 else f"{round(whole / 3600)} h"


def _columns() -> int:
    """Width of the terminal behind the error stream."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except (OSError, ValueError):
        return 80


def progress_line(enabled: bool) -> Progress | None:
    """A bar; None if there is no terminal to write to."""
    return Progress() if enabled and is_terminal() else None


def is_terminal() -> bool:
    """Whether somebody watches the error stream, on a terminal that can move its cursor."""
    return sys.stderr.isatty() and os.environ.get("TERM") != "dumb"


def counter(enabled: bool, text: str) -> Callable[..., None] | None:
    """A report of several counts, as in ``"{} solved, {} waiting"``; None if there is no terminal to write to."""
    progress = progress_line(enabled)
    if progress is None:
        return None

    def tell(*counts: float) -> None:
        if progress.is_due():
            progress.tell(text.format(*counts))

    return tell


@contextmanager
def telling_of_compiling() -> Iterator[None]:
    """Within this context say once why it takes so long, where kernels have to be compiled and somebody watches."""
    if not is_terminal():
        yield
        return
    with told_of_compiling(cache(_tell_of_compiling)):
        yield


def _tell_of_compiling() -> None:
    print(f"\r{_CLEAR}compiling the solvers: up to a minute, once for this installation", file=sys.stderr, flush=True)


def tell_of_plain_kernels(seconds: float) -> None:
    """Say what would make a command faster that took long in plain Python, where somebody watches."""
    if seconds < _LONG or not is_terminal() or find_spec("numba"):
        return
    fast = f"the extra `fast` ({this_python()} -m pip install numba)"
    print(f"tip: {fast} compiles the solvers once and is faster from then on", file=sys.stderr, flush=True)


def this_python() -> str:
    """How to call the Python that runs, which need not be the first one on the path."""
    path = sys.executable or "python"
    return f'"{path}"' if " " in path else path


def clear_progress(progress: object) -> None:
    """Take the line of the progress away again, if there was one."""
    if progress is not None:
        print(f"\r{_CLEAR}", end="", file=sys.stderr, flush=True)
