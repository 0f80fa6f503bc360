"""Searches of proofs on the command line: how far they are, and Ctrl-C, which ends them with what is known by then."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from hysdel_py.cli.interrupt import first_interrupt
from hysdel_py.cli.progress import clear_progress, counter, progress_line

__all__ = ["watched", "watched_steps"]

_ENDED = "interrupted: what was not settled by then is left open"


@contextmanager
def watched(enabled: bool, text: str = "search {}") -> Iterator[Callable[..., bool]]:
    """What to call with counts for the text; true once Ctrl-C was pressed."""
    with _told(counter(enabled, text)) as tell:
        yield tell


@contextmanager
def watched_steps(enabled: bool, steps: int) -> Iterator[Callable[..., bool]]:
    """What to call with the step that is done, and anything else; true once Ctrl-C was pressed."""
    bar = progress_line(enabled)
    with _told(None if bar is None else lambda step, *_: bar(step, steps)) as tell:
        yield tell


@contextmanager
def _told(show: Callable[..., None] | None) -> Iterator[Callable[..., bool]]:
    with first_interrupt() as interruption:

        def tell(*counts: int) -> bool:
            if show is not None:
                show(*counts)
            return interruption.asked

        try:
            yield tell
        finally:
            clear_progress(show)
    if interruption.asked:
        print(_ENDED, file=sys.stderr)
