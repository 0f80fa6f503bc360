"""Keeps what native libraries write out of the standard output of the command."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

__all__ = ["native_output_on_stderr"]

_OUT, _ERR = 1, 2


@contextmanager
def native_output_on_stderr() -> Iterator[None]:
    """Send what HiGHS writes past Python to the error stream.

    Some versions print a line about their own inner solver to the standard output, whatever is asked of them; behind
    it, JSON would no longer be JSON.
    """
    sys.stdout.flush()
    kept = os.dup(_OUT)
    os.dup2(_ERR, _OUT)
    try:
        yield
    finally:
        with suppress(OSError, AttributeError, TypeError):
            ctypes.CDLL(None).fflush(None)
        os.dup2(kept, _OUT)
        os.close(kept)
