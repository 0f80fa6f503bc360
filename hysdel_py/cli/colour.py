"""Colours of diagnostics on a terminal; plain text elsewhere, and where NO_COLOR is set (https://no-color.org)."""

from __future__ import annotations

import os
import re
from typing import TextIO

__all__ = ["is_coloured", "painted"]

_RED, _YELLOW, _CYAN, _BOLD, _PLAIN = "\x1b[31;1m", "\x1b[33;1m", "\x1b[36m", "\x1b[1m", "\x1b[0m"
_SEVERITIES = {"error": _RED, "warning": _YELLOW, "note": _CYAN}
_HEADLINE = re.compile(r"^(error|warning|note)(\[HYS\d+\])?: (.*)$", re.MULTILINE)
_MARKS = re.compile(r"^( *\| *)(\^+|-+)$", re.MULTILINE)
_HELP = re.compile(r"^( *)(help|fix):", re.MULTILINE)


def is_coloured(stream: TextIO) -> bool:
    """Whether a stream is a terminal whose reader did not ask for plain text."""
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb" and stream.isatty()


def painted(text: str, stream: TextIO) -> str:
    """Rendered diagnostics, in colours if the stream shows them."""
    if not is_coloured(stream):
        return text
    text = _HEADLINE.sub(_headline, text)
    text = _MARKS.sub(rf"\1{_RED}\2{_PLAIN}", text)
    return _HELP.sub(rf"\1{_CYAN}\2:{_PLAIN}", text)


def _headline(match: re.Match[str]) -> str:
    return f"{_SEVERITIES[match[1]]}{match[1]}{match[2] or ''}{_PLAIN}{_BOLD}: {match[3]}{_PLAIN}"
