"""Text to tokens; characters that belong to no token are reported and become tokens of their own."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from lark import Token

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.source import Source, Span

if TYPE_CHECKING:
    from lark import Lark

__all__ = ["BAD", "COMMENT_STARTS", "END", "is_keyword", "opens_section", "span_of", "tokenize", "too_many"]

BAD = "BAD"
"""Type of a token that stands for characters which the language does not have."""

END = "$END"
"""Type of the last token, which is empty."""

COMMENT_STARTS = ("#", "%")
"""What starts a comment in other languages."""

# A run of characters that start no token; letters, digits, blanks and the marks of the language end it.
_FOREIGN_RUN = re.compile(r"[^A-Za-z0-9\s(){}\[\],;=+\-*/^&|~!<>._:#%']+|([._#%])\1*")
_BEFORE_BRANCH = ("THEN", "ELSE")  # keywords behind which a brace opens an IF
_MAX_FOREIGN = 5000  # tokens of foreign characters that are read, reported or not
_HINTS = {
    ".": "a dot stands between the names of a module and of what it holds, without blanks",
    "_": "names start with a letter",
} | dict.fromkeys(COMMENT_STARTS, "comments are written /* like this */ or // like this")
_REPLACEMENTS = {"\u2212": "-", "\u2013": "-", "\u2264": "<=", "\u2265": ">="}


def tokenize(lark: Lark, source: Source, sink: Sink, limit: int) -> tuple[list[Token], bool]:
    """Tokens of a text, the last one of type END, and whether they are all.

    Parameters
    ----------
    limit : int
        After this many reports the rest of the text is left out, so that a file of garbage costs little.
    """
    from lark.exceptions import UnexpectedCharacters

    thread = lark.parse_interactive(source.text).lexer_thread
    state: Any = thread.state
    tokens: list[Token] = []
    foreign = 0
    while foreign < _MAX_FOREIGN:
        try:
            for token in thread.lex(None):  # type: ignore[no-untyped-call]
                tokens.append(token)
        except UnexpectedCharacters as error:
            bad = _bad_token(source, error.pos_in_stream or 0)
            state.line_ctr.feed(bad)
            tokens.append(bad)
            foreign += 1
        else:
            tokens.append(Token(END, "", start_pos=len(source.text), end_pos=len(source.text)))
            break
    complete = _report_foreign(tokens, source, sink, limit) and foreign < _MAX_FOREIGN
    if not complete:
        too_many(source, sink, limit)
    return tokens, complete


def too_many(source: Source, sink: Sink, limit: int) -> None:
    """Say that the rest of a text is not read."""
    end = len(source.text.rstrip())
    sink.error(
        Code.TOO_MANY_ERRORS,
        f"there are more than {limit} syntax errors: the rest of the file was not read",
        Span(max(end - 1, 0), end),
    )


def span_of(token: Token) -> Span:
    """Where a token stands."""
    return Span(token.start_pos or 0, token.end_pos or 0)


def is_keyword(token: Token) -> bool:
    """Whether a token is a keyword: the types of these are spelled as they are."""
    return token.type == token and token.isalpha()


def opens_section(tokens: list[Token], index: int) -> bool:
    """Whether the keyword of a section and an opening brace stand at an index."""
    token = tokens[index]
    return is_keyword(token) and token.type not in _BEFORE_BRANCH and tokens[index + 1].type == "LBRACE"


def _report_foreign(tokens: list[Token], source: Source, sink: Sink, limit: int) -> bool:
    """Report foreign characters, each once in a line and none in a foreign comment; False if they are too many."""
    known: set[tuple[int, str]] = set()
    count = 0
    for token in tokens:
        if token.type != BAD:
            continue
        line = source.line_of(span_of(token))
        if any((line, text) in known for text in (*COMMENT_STARTS, str(token))):
            continue
        known.add((line, str(token)))
        if count == limit:
            return False
        count += 1
        _report_token(token, sink)
    return True


def _report_token(token: Token, sink: Sink) -> None:
    first = token[0]
    shown = str(token) if first.isprintable() else f"U+{ord(first):04X}"
    plural = len(token) > 1 and first.isprintable()
    replacement = _REPLACEMENTS.get(str(token))
    sink.error(
        Code.BAD_CHARACTER,
        f"the character{'s' * plural} '{shown[:20]}' {'do' if plural else 'does'} not belong to the language",
        span_of(token),
        help=_HINTS.get(str(token)) or _HINTS.get(first, ""),
        fixes=() if replacement is None else ((span_of(token), replacement),),
    )


def _bad_token(source: Source, offset: int) -> Token:
    run = _FOREIGN_RUN.match(source.text, offset)
    text = run[0] if run else source.text[offset]
    return Token(BAD, text, start_pos=offset, end_pos=offset + len(text))
