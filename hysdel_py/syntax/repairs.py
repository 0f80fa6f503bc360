"""Small changes that let the parser go on at a token that it does not expect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from lark import Token

from hysdel_py.syntax.automaton import Automaton
from hysdel_py.syntax.lexing import END, opens_section

__all__ = ["Repair", "find", "window"]

_WINDOW = 6  # as many tokens have to fit behind a repair before it is believed
_DEEPEST = 3  # braces that are open at the same time: of the system, of a half, of a section
_SPELLING = {"SEMICOLON": ";", "LBRACE": "{", "RBRACE": "}", "RPAR": ")", "RSQB": "]"}
_INSERTED = tuple(_SPELLING)
_SKIPPED = frozenset({"SEMICOLON", "RBRACE", "RPAR", "RSQB", "COMMA", "PLUS"})
_SIMILARITY = 0.75


@dataclass(frozen=True, slots=True)
class Repair:
    """Tokens to suppose and tokens to skip.

    Attributes
    ----------
    insert : tuple of (type, text)
    skip : int
        0 or 1.
    in_item : bool
        Whether the change is inside an item, so that a brace is that of a choice.
    """

    insert: tuple[tuple[str, str], ...]
    skip: int
    in_item: bool

    @property
    def is_keyword(self) -> bool:
        """Whether a word is read as the keyword that it resembles."""
        return bool(self.insert and self.skip)

    @property
    def is_brace(self) -> bool:
        """Whether it is about a closing brace of a section."""
        return not self.in_item and any(type_ == "RBRACE" for type_, _ in self.insert)


def window(tokens: Sequence[Token], position: int) -> list[str]:
    """Types of the next few tokens, up to the end of an item."""
    types = []
    for token in tokens[position : position + _WINDOW]:
        types.append(str(token.type))
        if token.type in ("SEMICOLON", END):
            break
    return types


def find(automaton: Automaton, tokens: list[Token], position: int, *, within_item: bool) -> Repair | None:
    """The first repair behind which the next tokens fit, if there is one.

    Parameters
    ----------
    within_item : bool
        Whether the token stands inside an item; braces are then those of a choice.
    """
    for repair in _candidates(automaton, tokens, position, within_item):
        following = window(tokens, position + repair.skip)[: 1 if repair.is_keyword else _WINDOW]
        types = [type_ for type_, _ in repair.insert] + following
        if automaton.accepted(types) == len(types):
            return repair
    return None


def _candidates(automaton: Automaton, tokens: list[Token], position: int, within_item: bool) -> Iterator[Repair]:
    token = tokens[position]
    if token.type == "NAME":
        yield from _keywords(str(token), automaton.expected_keywords())
    if not within_item and (token.type == END or opens_section(tokens, position)):
        yield from (Repair((("RBRACE", "}"),) * count, 0, in_item=False) for count in range(1, _DEEPEST + 1))
    for type_ in _INSERTED if within_item else ("LBRACE",):
        yield Repair(((type_, _SPELLING[type_]),), 0, in_item=True)
    if token.type in _SKIPPED:
        yield Repair((), 1, in_item=True)


def _keywords(word: str, expected: Sequence[str]) -> Iterator[Repair]:
    """Keywords that fit here and that the word may be meant for."""
    for keyword in get_close_matches(word.upper(), expected, n=2, cutoff=_SIMILARITY):
        yield Repair(((keyword, keyword),), 1, in_item=True)
