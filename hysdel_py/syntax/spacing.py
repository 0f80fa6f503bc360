"""Where spaces and line breaks may stand between the tokens of one item.

Input: the tokens of an item, a section header or a closing brace. Output: one :class:`Atom` per token, which knows
whether a space precedes it and how good a place for a line break there is. The tokens themselves are never changed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hysdel_py.syntax.dialect import Dialect
from hysdel_py.syntax.extension import QUERY_CLAUSES, QUERY_KINDS
from hysdel_py.syntax.tokens import Token, TokenKind

__all__ = ["LAST_RESORT", "Atom", "atoms_of", "ends_line", "is_choice_brace", "stands_alone"]

_UNARY = frozenset("-~!+")
_TIGHT = frozenset("*/^:.")
_TRUTHS = frozenset({"TRUE", "FALSE"})
_CLAUSES = frozenset({"THEN", "ELSE"})
_RANK = {
    "|": 2, "||": 2, "->": 3, "<-": 3, "<->": 3, "&": 4, "&&": 4, "<=": 5, ">=": 5, "<": 5, ">": 5, "==": 5, "+": 6,
    "-": 6, "*": 17, "/": 17,
}  # fmt: skip
_ARROWS = ("->", "<-", "<->")
_RANK_OF_3 = _RANK | {"&": 3, "&&": 3} | dict.fromkeys(_ARROWS, 4)
_RANK_OF_MUST_OF_3 = _RANK | {"|": 3, "||": 3} | dict.fromkeys(_ARROWS, 2)
# A factor is left on its line if the sum in the parentheses behind it can be broken: hence 17 and not 7.
_LEVELS_PER_DEPTH = 10

LAST_RESORT = 1_000_000_000
"""Level of a break that is taken only where there is no other one."""


@dataclass(frozen=True, slots=True)
class Atom:
    """A token as it is laid out.

    Attributes
    ----------
    token : Token
    space : bool
        Whether a space precedes it on the same line.
    depth : int
        Number of brackets of the item that are open here.
    level : int or None
        Quality of a line break before it, the lower the better; None where none may stand.
    forced : bool
        Whether a line break precedes it in any case.
    """

    token: Token
    space: bool
    depth: int
    level: int | None
    forced: bool

    @property
    def width(self) -> int:
        """Characters that it takes on a line, its space included."""
        return len(self.token.text) + self.space


def is_choice_brace(before: Token | None, after: Token | None) -> bool:
    """Whether a ``{`` between two tokens opens an expression such as ``{IF ...}`` and not a section."""
    if after is not None and after.text == "IF":
        return True
    return before is not None and (_awaits_operand(before) or before.text == "IF")


def _awaits_operand(token: Token) -> bool:
    if token.kind is TokenKind.KEYWORD:
        return token.text in _CLAUSES
    return token.text != ";" and token.kind in (TokenKind.OPERATOR, TokenKind.OPEN, TokenKind.SEPARATOR)


def ends_line(comment: Token) -> bool:
    """Whether nothing can follow a comment on its line."""
    return comment.kind is TokenKind.LINE_COMMENT or "\n" in comment.text


def stands_alone(comment: Token, before: Sequence[Token]) -> bool:
    """Whether a comment begins a line; `before` are the last two tokens before it, or all if there are fewer.

    So does one behind a separator that begins a line: pulled up with it, it would document the declaration before.
    """
    if comment.newlines or not before:
        return True
    documented = len(before) > 1 and before[-2].is_comment
    return before[-1].kind is TokenKind.SEPARATOR and before[-1].newlines > 0 and not documented


def atoms_of(tokens: Sequence[Token], dialect: Dialect) -> list[Atom]:
    """Atoms of the tokens of one item in their order."""
    ranks = _ranks(tokens, dialect)
    atoms: list[Atom] = []
    code: Token | None = None  # the last token that is no comment
    unary = False  # whether that is an operator of one operand
    depth = 0
    for index, token in enumerate(tokens):
        before = tokens[index - 1] if index else None
        depth -= token.kind is TokenKind.CLOSE
        sign = token.text in _UNARY and _is_sign(code)
        space = _spaced(before, code, token, unary, sign)
        level = None if sign else _break_level(before, code, token, depth, ranks[depth > 0])
        forced = _forced(tokens[max(index - 2, 0) : index], token)
        atoms.append(Atom(token, space, depth, level, forced))
        depth += token.kind is TokenKind.OPEN
        if not token.is_comment:
            code, unary = token, sign
    return atoms


def _is_sign(before: Token | None) -> bool:
    if before is None:
        return True
    if before.kind is TokenKind.KEYWORD:
        return before.text not in _TRUTHS
    return before.kind in (TokenKind.OPERATOR, TokenKind.OPEN, TokenKind.SEPARATOR)


def _spaced(before: Token | None, code: Token | None, token: Token, unary: bool, sign: bool) -> bool:  # noqa: PLR0911 -- a table of rules
    """Whether a space stands before a token; the first rule that applies decides."""
    if before is None or code is None:
        return False
    if token.kind is TokenKind.SEPARATOR:
        return False
    if before.is_comment or token.is_comment:
        return True
    if token.kind in (TokenKind.CLOSE, TokenKind.POSTFIX) or code.kind is TokenKind.OPEN or unary:
        return False
    if TokenKind.OTHER in (code.kind, token.kind):
        return token.start > code.end
    if code.text in _TIGHT or (token.text in _TIGHT and not sign):
        return False
    return token.text != "(" or not _takes_argument(code)


def _takes_argument(token: Token) -> bool:
    """Whether a parenthesis behind it is its argument or index."""
    return token.kind in (TokenKind.NAME, TokenKind.CLOSE, TokenKind.NUMBER)


def _ranks(tokens: Sequence[Token], dialect: Dialect) -> tuple[Mapping[str, int], Mapping[str, int]]:
    """Ranks of operators outside and inside of brackets."""
    if dialect is Dialect.HYSDEL_2:
        return _RANK, _RANK
    return (_RANK_OF_MUST_OF_3 if _stands_in_must(tokens) else _RANK_OF_3), _RANK_OF_3


def _stands_in_must(tokens: Sequence[Token]) -> bool:
    """Whether an item defines nothing and is no query."""
    asks = tokens[0].kind is TokenKind.KEYWORD and tokens[0].text in QUERY_KINDS
    return not asks and all(token.text != "=" for token in tokens)


def _break_level(
    before: Token | None, code: Token | None, token: Token, depth: int, ranks: Mapping[str, int]
) -> int | None:
    if before is None or code is None or token.is_comment:
        return None
    base = depth * _LEVELS_PER_DEPTH
    if code.kind is TokenKind.SEPARATOR:
        return base + (code.text == ",")
    if token.text in _CLAUSES or (token.kind is TokenKind.KEYWORD and token.text in QUERY_CLAUSES):
        return base
    if code.text == "=" and token.kind is not TokenKind.OPEN:
        return LAST_RESORT
    rank = ranks.get(token.text)
    return None if rank is None else base + rank


def _forced(before: Sequence[Token], token: Token) -> bool:
    """Comments that begin or end a line keep doing so."""
    if not before:
        return False
    begins = len(before) == 1 and before[0].kind is TokenKind.SEPARATOR  # first of its item, as on a line of its own
    if token.is_comment and (begins or stands_alone(token, before)):
        return True
    if not before[-1].is_comment:
        return False
    return ends_line(before[-1]) or (token.newlines > 0 and token.kind is not TokenKind.SEPARATOR)
