"""Offsets in a text and positions as editors count them: lines from 0, columns in units of UTF-16."""

from __future__ import annotations

from bisect import bisect_right

__all__ = ["Positions"]


def _units(text: str) -> int:
    """Length in units of UTF-16."""
    return len(text) + sum(character > "\uffff" for character in text)


class Positions:
    """Converts between offsets and positions of one text."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._starts = [0]
        for line in text.split("\n"):
            self._starts.append(self._starts[-1] + len(line) + 1)
        self._starts.pop()

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column of an offset."""
        offset = min(max(offset, 0), len(self._text))
        line = bisect_right(self._starts, offset) - 1
        return line, _units(self._text[self._starts[line] : offset])

    def offset(self, line: int, column: int) -> int:
        """Offset of a position; one beyond the end of its line or of the text is moved there."""
        if line >= len(self._starts):
            return len(self._text)
        offset = self._starts[max(line, 0)]
        while column > 0 and offset < len(self._text) and self._text[offset] not in "\r\n":
            column -= _units(self._text[offset])
            offset += 1
        return offset
