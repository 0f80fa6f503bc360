"""Standard streams that are missing, as in a program without a console, or whose reader is gone."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

__all__ = ["forget_output", "open_missing_streams"]


def open_missing_streams() -> None:
    """Let what nobody can read go nowhere: Python has None for a stream that was closed before it began.

    Messages for a closed error stream would stand on the output otherwise, and the next file that is opened would be
    taken for the closed stream by native code.
    """
    if sys.stdout is None:
        sys.stdout = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 -- open as long as we run
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 -- open as long as we run


def forget_output() -> None:
    """Send what is still to be written nowhere: its reader is gone, as in ``hysdel compile clutch | head -1``."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
