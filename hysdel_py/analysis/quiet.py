"""Keeps a solver's own messages out of the output of a program."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress

__all__ = ["quiet"]

_STDOUT = 1


@contextmanager
def quiet() -> Iterator[None]:
    """Send what compiled code prints to standard output nowhere; what Python prints is not touched.

    HiGHS prints a line when it repairs an integer point, which no option turns off, and a program that reads our JSON
    would stumble over it.
    """
    try:
        kept = os.dup(_STDOUT)
    except OSError:  # there is no standard output
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        _flush()
        os.dup2(nowhere, _STDOUT)
        yield
    finally:
        _flush()
        os.dup2(kept, _STDOUT)
        os.close(kept)
        os.close(nowhere)


def _flush() -> None:
    """Empty the buffers of the C library."""
    with suppress(OSError, AttributeError, TypeError):  # where there is no C library to be asked, as on Windows
        ctypes.CDLL(None).fflush(None)
