"""Text to tokens with comments, for tools that must keep what the parser drops.

The tokens are a superset of those of the grammar: whatever cannot be recognised becomes a token of kind OTHER, so that
every text has tokens and their texts with the white space between them are the text again.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from hysdel_py.syntax.source import Span

__all__ = [
    "DECLARING", "FUNCTION_WORDS", "KEYWORDS", "SECTIONS", "TYPES", "Token", "TokenKind", "partner_of_brackets",
    "tokenize",
]  # fmt: skip

TYPES = frozenset({"REAL", "BOOL"})
DECLARING = frozenset({"STATE", "INPUT", "OUTPUT", "PARAMETER", "AUX"})
"""Sections that hold declarations; OUTPUT does so in INTERFACE only."""

SECTIONS = DECLARING | {"AD", "DA", "LOGIC", "LINEAR", "CONTINUOUS", "AUTOMATA", "MUST", "MODULE"}
KEYWORDS = SECTIONS | TYPES | {"SYSTEM", "INTERFACE", "IMPLEMENTATION", "IF", "THEN", "ELSE", "TRUE", "FALSE", "FOR"}
"""Words that can never be names."""

FUNCTION_WORDS = frozenset({"sin", "cos", "exp", "log", "sqrt"})


class TokenKind(Enum):
    """What a token is; the value is the name of its group in the pattern."""

    BLOCK_COMMENT = "block_comment"
    LINE_COMMENT = "line_comment"
    NUMBER = "number"
    NAME = "name"
    KEYWORD = "keyword"
    OPERATOR = "operator"
    POSTFIX = "postfix"
    OPEN = "open"
    CLOSE = "close"
    SEPARATOR = "separator"
    OTHER = "other"


_COMMENTS = (TokenKind.BLOCK_COMMENT, TokenKind.LINE_COMMENT)
_PATTERN = re.compile(
    r"""(?P<space>[ \t\r\n]+)
      | (?P<block_comment>/\*[\s\S]*?(?:\*/|\Z))
      | (?P<line_comment>//[^\n]*)
      | (?P<number>(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)
      | (?P<name>[A-Za-z][A-Za-z0-9_]*)
      | (?P<operator><->|<-|->|<=|>=|==|&&|\|\||[-+*/^&|~!<>=:.])
      | (?P<postfix>')
      | (?P<open>[({\[]) | (?P<close>[)}\]])
      | (?P<separator>[,;])
      | (?P<other>.)""",
    re.VERBOSE,
)
_KIND = {kind.value: kind for kind in TokenKind}
_CLOSING = {"(": ")", "[": "]", "{": "}"}


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of the text that is not white space.

    Attributes
    ----------
    kind : TokenKind
    text : str
    start : int
        Offset in the source text.
    newlines : int
        Number of line ends between the token before and this one.
    """

    kind: TokenKind
    text: str
    start: int
    newlines: int

    @property
    def end(self) -> int:
        """Offset behind the last character."""
        return self.start + len(self.text)

    @property
    def span(self) -> Span:
        """Where the token stands."""
        return Span(self.start, self.end)

    @property
    def is_comment(self) -> bool:
        """Whether this is a comment of either kind."""
        return self.kind in _COMMENTS


def tokenize(text: str, keywords: frozenset[str] = KEYWORDS) -> list[Token]:
    """All tokens of a text in order, comments included; `keywords` are those of a file with its extensions."""
    tokens: list[Token] = []
    newlines = 0
    for match in _PATTERN.finditer(text):
        group = match.lastgroup
        if group == "space":
            newlines = _line_ends(match[0])
            continue
        kind = TokenKind.KEYWORD if match[0] in keywords else _KIND[group or "other"]
        tokens.append(Token(kind, match[0], match.start(), newlines))
        newlines = 0
    return tokens


def _line_ends(space: str) -> int:
    """Number of line ends in white space; a carriage return that stands alone ends a line too."""
    if space == " ":  # nearly all of it, and cheaper to ask
        return 0
    return space.count("\n") + space.count("\r") - space.count("\r\n")


def partner_of_brackets(tokens: Sequence[Token]) -> dict[int, int]:
    """Position of the closing bracket for each opening one that has one; wrongly nested ones are left out."""
    partners: dict[int, int] = {}
    pending: list[int] = []
    for index, token in enumerate(tokens):
        if token.kind is TokenKind.OPEN:
            pending.append(index)
        elif token.kind is TokenKind.CLOSE and pending and _CLOSING[tokens[pending[-1]].text] == token.text:
            partners[pending.pop()] = index
    return partners
