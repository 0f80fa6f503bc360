"""Source texts and positions in them."""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

__all__ = ["COMMENT", "Source", "Span"]

COMMENT = re.compile(r"/\*.*?(?:\*/|\Z)|//[^\n]*", re.DOTALL)
"""A comment of either kind; whichever starts first hides the other."""


@dataclass(frozen=True, slots=True)
class Span:
    """Half-open range of character offsets in a source text."""

    start: int
    end: int

    def to(self, other: Span) -> Span:
        """Smallest span that covers this one and `other`."""
        return Span(min(self.start, other.start), max(self.end, other.end))


@dataclass(frozen=True)
class Source:
    """A named text.

    Attributes
    ----------
    name : str
        File name for messages, ``<text>`` for a text that came from no file.
    text : str
    path : Path or None
        Where the text was read from.
    """

    name: str
    text: str
    path: Path | None = None

    @cached_property
    def _line_starts(self) -> list[int]:
        return [0] + [match.end() for match in re.finditer("\n", self.text)]

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column of an offset, both counted from 1."""
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def line_of(self, span: Span) -> int:
        """Line in which a span starts, counted from 1."""
        return self.position(span.start)[0]

    def line_text(self, line: int) -> str:
        """Text of a line without its end."""
        start = self._line_starts[line - 1]
        end = self._line_starts[line] if line < len(self._line_starts) else len(self.text)
        return self.text[start:end].rstrip("\r\n")

    def excerpt(self, span: Span) -> str:
        """Text of a span on one line: comments dropped, white space folded."""
        return " ".join(COMMENT.sub(" ", self.text[span.start : span.end]).split())

    @cached_property
    def comments(self) -> tuple[Span, ...]:
        """Spans of all comments in order."""
        return tuple(Span(*match.span()) for match in COMMENT.finditer(self.text))

    def comment_after(self, offset: int) -> str:
        """Text of the first comment that starts in the rest of the line of `offset` with only ``,;`` before it."""
        index = bisect_right([span.start for span in self.comments], offset - 1) if self.comments else 0
        if index >= len(self.comments):
            return ""
        span = self.comments[index]
        between = self.text[offset : span.start]
        if "\n" in between or between.strip(" \t,;"):
            return ""
        text = self.text[span.start : span.end]
        return " ".join((text[2:] if text.startswith("//") else text[2:].removesuffix("*/")).split())
