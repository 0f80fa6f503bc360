"""Finds out which opening brace it is that has no closing one, by indentation where there is any."""

from __future__ import annotations

from lark import Token

from hysdel_py.syntax.lexing import END, span_of
from hysdel_py.syntax.source import Source

__all__ = ["ClosedBraces"]


class ClosedBraces:
    """Remembers what closing braces were taken for; braces are named by the index of their token."""

    def __init__(self, tokens: list[Token], source: Source) -> None:
        self._tokens = tokens
        self._source = source
        self._loop = (-1, -1)  # the closing and the opening brace of the last FOR
        self._misaligned = -1  # the first brace whose closing one is indented differently

    def note(self, opening: int, closing: int) -> None:
        """Remember a pair; a closing brace that was only supposed is -1."""
        if self._is_loop(opening):
            self._loop = (closing, opening)
        if closing >= 0 and self._misaligned < 0 and not self._aligned(opening, closing):
            self._misaligned = opening

    def likely_open(self, position: int, around: int) -> int:
        """The brace that is most likely not closed before a token; `around` is the one that is still open there."""
        loop = self._open_loop(position, around)
        if loop >= 0:
            return loop
        at_end = self._tokens[position].type == END
        return self._misaligned if at_end and self._misaligned >= 0 else around

    def _open_loop(self, position: int, around: int) -> int:
        """The brace of a FOR for which the brace before a position was taken, though it may be that of its section."""
        closing, loop = self._loop
        if closing != position - 1 or loop < around:
            return -1
        if self._misaligned > around and self._is_loop(self._misaligned):
            return self._misaligned
        lines = {self._source.line_of(span_of(self._tokens[index])) for index in (around, loop, closing)}
        return loop if len(lines) == 1 else -1

    def _is_loop(self, brace: int) -> bool:
        """Whether a brace is that of a FOR, the only one behind a parenthesis."""
        return brace > 0 and self._tokens[brace - 1].type == "RPAR"

    def _aligned(self, opening: int, closing: int) -> bool:
        """Whether a closing brace that stands first in its line is indented like the line of its opening one."""
        line, column = self._source.position(self._tokens[closing].start_pos or 0)
        text = self._source.line_text(line)
        if text[: column - 1].strip() or opening < 0:
            return True
        other = self._source.line_text(self._source.line_of(span_of(self._tokens[opening])))
        return column - 1 == len(other) - len(other.lstrip())
