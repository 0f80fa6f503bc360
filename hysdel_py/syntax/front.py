"""What the comments in front of a text state: ``/* word: value */``, which other compilers pass over."""

from __future__ import annotations

import re
from dataclasses import dataclass

from hysdel_py.syntax.source import Source, Span

__all__ = ["Statement", "is_in_front", "statements"]

_STATED = r"(?:/\*|//)[\s*/]*{}\s*:(.*?)[\s*]*(?:\*/)?"


@dataclass(frozen=True, slots=True)
class Statement:
    """A comment that states something: where it stands, what it says in small letters, whether it is in front."""

    span: Span
    value: str
    in_front: bool


def statements(source: Source, word: str) -> tuple[Statement, ...]:
    """Comments that begin with a word and a colon, without surplus blanks in what follows."""
    pattern = re.compile(_STATED.format(word), re.DOTALL | re.IGNORECASE)
    matches = ((span, pattern.fullmatch(source.text[span.start : span.end])) for span in source.comments)
    found = [(span, " ".join(match[1].lower().split())) for span, match in matches if match]
    return tuple(Statement(span, value, is_in_front(source, span)) for span, value in found)


def is_in_front(source: Source, span: Span) -> bool:
    """Whether nothing but comments stands before a place."""
    position = 0
    for comment in source.comments:
        if source.text[position : comment.start].strip():
            return False
        if comment == span:
            return True
        position = comment.end
    return False
