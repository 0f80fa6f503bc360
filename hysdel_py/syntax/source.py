"""Source texts and positions in them."""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
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
    parts : tuple of Source
        The files that are joined to this text, one behind the other; empty if it is a single one.
    """

    name: str
    text: str
    path: Path | None = None
    parts: tuple[Source, ...] = ()

    def joined(self, other: Source) -> Source:
        """Put another text behind this one; spans in this one stay what they are."""
        return Source(self.name, self.text + other.text, self.path, (*(self.parts or (self,)), other))

    def home(self, span: Span) -> tuple[Source, Span]:
        """The file that a span lies in, and the span in it."""
        start = 0
        for part in self.parts:
            end = start + len(part.text)
            if span.start < end:
                return part, Span(span.start - start, span.end - start)
            start = end
        return self, span

    @cached_property
    def _line_starts(self) -> list[int]:
        return [0] + [match.end() for match in re.finditer("\n", self.text)]

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column of an offset in its file, both counted from 1."""
        if self.parts:
            part, span = self.home(Span(offset, offset))
            if part is not self:
                return part.position(span.start)
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
        """Spans of all comments in order; none reaches from one file into the next."""
        if self.parts:
            found: list[Span] = []
            start = 0
            for part in self.parts:
                found += [Span(start + span.start, start + span.end) for span in part.comments]
                start += len(part.text)
            return tuple(found)
        return tuple(Span(*match.span()) for match in COMMENT.finditer(self.text))

    @cached_property
    def _comment_starts(self) -> list[int]:
        return [span.start for span in self.comments]

    def comment_after(self, offset: int) -> str:
        """Text of the first comment that starts in the rest of the line of `offset` with only ``,;`` before it."""
        index = bisect_left(self._comment_starts, offset)
        if index >= len(self.comments):
            return ""
        span = self.comments[index]
        between = self.text[offset : span.start]
        if "\n" in between or between.strip(" \t,;"):
            return ""
        text = self.text[span.start : span.end]
        return " ".join((text[2:] if text.startswith("//") else text[2:].removesuffix("*/")).split())
