"""One canonical layout for source texts.

Input: the text of a model. Output: the same tokens in the same order with other white space; the result depends on the
tokens, on which comments begin or end a line, and on where blank lines stand, and formatting it again changes nothing.
The formatter knows tokens and brackets only, not the grammar, so that it keeps pace with the language.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import groupby

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.dialect import Dialect, stated_dialect
from hysdel_py.syntax.keywords import keywords_of
from hysdel_py.syntax.source import Source
from hysdel_py.syntax.spacing import is_choice_brace, stands_alone
from hysdel_py.syntax.tokens import Token, TokenKind, tokenize
from hysdel_py.syntax.wrapping import Piece, wrap

__all__ = ["INDENT", "format_text"]

INDENT = 2
"""Columns per level of sections."""

_GAP = "   "  # between code and the comment behind it
_MAX_ALIGNED = 60  # comments behind longer code are not aligned with their neighbours
_TAB = 8


@dataclass(frozen=True, slots=True)
class _Line:
    """One line of the result before its comments have their column."""

    piece: Piece
    blank_before: bool = False
    in_section: bool = False  # an item, not the head or the end of a section

    @property
    def aligns(self) -> bool:
        return self.in_section and bool(self.piece.comments) and 0 < self.code_end <= _MAX_ALIGNED

    @property
    def code_end(self) -> int:
        return self.piece.column + len(self.piece.text) if self.piece.text else 0


def format_text(text: str) -> str:
    r"""Format the text of a model.

    Parameters
    ----------
    text : str
        Any text; that it is a model is for the caller to find out, since the layout of a wrong one says little.

    Returns
    -------
    str
        The formatted text with ``\n`` as line ends, empty if there are no tokens.

    Examples
    --------
    >>> print(format_text("SYSTEM s{INTERFACE{STATE{REAL x[0,1];/* [m] place */}}}"))
    SYSTEM s {
      INTERFACE {
        STATE {
          REAL x [0, 1];   /* [m] place */
        }
      }
    }
    <BLANKLINE>
    """
    layout = _Layout(stated_dialect(Source("", text), Sink()))
    tokens = tokenize(text, keywords_of(text))
    for index, token in enumerate(tokens):
        layout.add(token, _next_code(tokens, index))
    return "".join(f"{line}\n" for line in _rendered(layout.finished(), text))


def _next_code(tokens: list[Token], index: int) -> Token | None:
    """Token behind an opening brace, comments not counted; None for all others, where nobody asks."""
    if tokens[index].text != "{":
        return None
    return next((token for token in tokens[index + 1 : index + 8] if not token.is_comment), None)


class _Layout:
    """Collects tokens into items and section heads and those into lines."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self._lines: list[_Line] = []
        self._item: list[Token] = []  # tokens of the item that is not complete yet
        self._brackets = 0  # open brackets within it
        self._level = 0  # open sections
        self._before: list[Token] = []  # the last two tokens

    def add(self, token: Token, behind: Token | None) -> None:
        """Take the next token; `behind` is the one after an opening brace."""
        if token.is_comment and not self._item:
            self._add_comment(token)
        elif token.text == "{" and not self._brackets and not is_choice_brace(self._code_before(), behind):
            self._open_section(token)
        elif token.text == "}" and not self._brackets:
            self._close_section(token)
        elif token.text == ";" and not self._brackets:
            self._end_item(token)
        else:
            self._brackets += (token.kind is TokenKind.OPEN) - (token.kind is TokenKind.CLOSE)
            self._brackets = max(self._brackets, 0)
            self._item.append(token)
        self._before = [*self._before[-1:], token]

    def finished(self) -> list[_Line]:
        """All lines."""
        self._flush(in_section=False)
        return self._lines

    def _code_before(self) -> Token | None:
        return next((token for token in reversed(self._item) if not token.is_comment), None)

    def _add_comment(self, comment: Token) -> None:
        if self._lines and not stands_alone(comment, self._before):
            last = self._lines[-1]
            self._lines[-1] = replace(last, piece=replace(last.piece, comments=(*last.piece.comments, comment)))
        else:
            piece = Piece(self._level * INDENT, "", (comment,))
            self._lines.append(_Line(piece, self._blank_before(comment), in_section=True))

    def _open_section(self, brace: Token) -> None:
        self._item.append(brace)
        self._flush(in_section=False)
        self._level += 1

    def _close_section(self, brace: Token) -> None:
        self._flush(in_section=True)
        self._level = max(self._level - 1, 0)
        if self._before and self._before[-1].text == "{":
            self._append_to_last(brace)
        else:
            self._lines.append(_Line(Piece(self._level * INDENT, "}")))

    def _end_item(self, semicolon: Token) -> None:
        if self._item or not self._lines or self._lines[-1].piece.comments:
            self._item.append(semicolon)
            self._flush(in_section=True)
        else:
            self._append_to_last(semicolon)

    def _append_to_last(self, token: Token) -> None:
        last = self._lines[-1]
        self._lines[-1] = replace(last, piece=replace(last.piece, text=last.piece.text + token.text))

    def _flush(self, *, in_section: bool) -> None:
        """Lay out the tokens collected so far."""
        if not self._item:
            return
        blank = self._blank_before(self._item[0])
        for piece in wrap(self._item, self._level * INDENT, self._dialect):
            self._lines.append(_Line(piece, blank, in_section))
            blank = False
        self._item = []
        self._brackets = 0

    def _blank_before(self, token: Token) -> bool:
        """At most one blank line stays, and none at the beginning of a section."""
        begins = not self._lines or self._lines[-1].piece.text.endswith("{")
        return token.newlines > 1 and not begins


def _rendered(lines: list[_Line], source: str) -> Iterator[str]:
    """The lines as text; comments behind neighbouring items stand in one column."""
    for aligned, group in groupby(lines, key=lambda line: line.aligns):
        run = list(group)
        for block in _blocks(run) if aligned else [run]:
            column = max(line.code_end for line in block) + len(_GAP) if aligned else 0
            for line in block:
                yield from _render(line, column, source)


def _blocks(run: list[_Line]) -> Iterator[list[_Line]]:
    """Parts of a run of lines with comments; a blank line or a comment of several lines ends a part."""
    block: list[_Line] = []
    for line in run:
        if block and (line.blank_before or any("\n" in c.text for c in block[-1].piece.comments)):
            yield block
            block = []
        block.append(line)
    yield block


def _render(line: _Line, column: int, source: str) -> Iterable[str]:
    piece = line.piece
    code = " " * piece.column + piece.text
    if piece.text and piece.comments:
        code = code.ljust(column) if column else code + _GAP
    for index, comment in enumerate(piece.comments):
        code += " " * (index > 0)
        code += _shifted(comment, len(code) - code.rfind("\n") - 1, source)
    lines = code.split("\n")
    return ["", *lines] if line.blank_before else lines


def _shifted(comment: Token, column: int, source: str) -> str:
    """Text of a comment whose later lines move as far as its first line does."""
    # The last comment of a file may be left open; then the white space at the end of the file belongs to it.
    first, *rest = (line.rstrip(" \t\r") for line in comment.text.rstrip(" \t\r\n").split("\n"))
    if not rest:
        return first
    shift = column - _column_of(comment, source)
    return "\n".join([first, *(_moved(line, shift) for line in rest)])


def _moved(line: str, shift: int) -> str:
    bare = line.lstrip(" \t")
    return " " * max(_indent(line) + shift, 0) + bare if bare else ""


def _indent(line: str) -> int:
    bare = line.lstrip(" \t")
    return len(line[: len(line) - len(bare)].expandtabs(_TAB))


def _column_of(token: Token, source: str) -> int:
    start = source.rfind("\n", 0, token.start) + 1
    before = source[start : token.start]
    return _indent(before) + len(before.lstrip(" \t"))
