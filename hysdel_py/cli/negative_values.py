"""Negative numbers behind options, which the standard parser takes for options."""

from __future__ import annotations

import re
from collections.abc import Sequence

__all__ = ["join_negative_values"]

_OPTION = re.compile(r"--[a-z][a-z0-9-]*")
_NEGATIVE = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)


def join_negative_values(arguments: Sequence[str]) -> list[str]:
    """Join an option and the negative number behind it: ``--x0 -1,2`` becomes ``--x0=-1,2``.

    The standard parser takes whatever begins with a minus for an option.
    """
    joined: list[str] = []
    for text in arguments:
        if joined and _OPTION.fullmatch(joined[-1]) and _NEGATIVE.match(text):
            joined[-1] += f"={text}"
        else:
            joined.append(text)
    return joined
