"""The exception for what is wrong neither with a model nor with the usage."""

from __future__ import annotations

from hysdel_py.errors import HysdelError

__all__ = ["DataError"]


class DataError(HysdelError):
    """What the command line names exists but cannot be used: a file with a mistake, a package that is missing."""
