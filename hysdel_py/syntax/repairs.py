"""Small changes that let the parser go on at a token that it does not expect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from lark import Token

from hysdel_py.syntax.automaton import Automaton
from hysdel_py.syntax.lexing import END, opens_section

__all__ = ["Repair", "close_brackets", "find", "window"]

_WINDOW = 6  # as many tokens have to fit behind a repair before it is believed
_DEEPEST = 8  # braces that are open at the same time: of the system, of a half, of a section, of loops
_SPELLING = {"SEMICOLON": ";", "LBRACE": "{", "RBRACE": "}", "RPAR": ")", "RSQB": "]", "COMMA": ","}
_INSERTED = ("SEMICOLON", "LBRACE", "RBRACE", "RPAR", "RSQB")
_INSERTED_IN_BRACKETS = ("RPAR", "RSQB", "COMMA")
_SKIPPED = frozenset({"SEMICOLON", "RBRACE", "RPAR", "RSQB", "COMMA", "PLUS"})
_BEHIND_ITEM = frozenset({"RBRACE", "REAL", "BOOL", "FOR", "INDEX", END})
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


def find(
    automaton: Automaton, tokens: list[Token], position: int, *, within_item: bool, brackets: int
) -> Repair | None:
    """The first repair behind which the next tokens fit, if there is one.

    Parameters
    ----------
    within_item : bool
        Whether the token stands inside an item; braces are then those of a choice.
    brackets : int
        How many brackets of the item are open; no semicolon is missing inside them.
    """
    inserted = (_INSERTED_IN_BRACKETS if brackets else _INSERTED) if within_item else ("LBRACE",)
    for repair in _candidates(automaton, tokens, position, inserted, within_item=within_item):
        following = window(tokens, position + repair.skip)[: 1 if repair.is_keyword else _WINDOW]
        types = [type_ for type_, _ in repair.insert] + following
        if automaton.accepted(types) == len(types):
            return repair
    return None


def close_brackets(automaton: Automaton, tokens: list[Token], position: int, brackets: int) -> Repair | None:
    """The missing brackets before a semicolon that ends its item, although it could part rows of a matrix."""
    if not _ends_item(tokens, position):
        return None
    fits = automaton.accepted(["RSQB"] * brackets + ["SEMICOLON"]) == brackets + 1
    return Repair((("RSQB", "]"),) * brackets, 0, in_item=True) if fits else None


def _ends_item(tokens: list[Token], position: int) -> bool:
    """Whether what stands behind a semicolon cannot stand in a matrix, such as a brace or a definition."""
    following = tokens[position + 1]
    if following.type in _BEHIND_ITEM:
        return True
    if following.type != "NAME":
        return False
    after = position + 2
    if tokens[after].type == "LPAR":
        types = [token.type for token in tokens[after : after + _WINDOW]]
        after += types.index("RPAR") + 1 if "RPAR" in types else 0
    return tokens[after].type == "EQUAL"


def _candidates(
    automaton: Automaton, tokens: list[Token], position: int, inserted: Sequence[str], *, within_item: bool
) -> Iterator[Repair]:
    token = tokens[position]
    if token.type == "NAME" and token not in automaton.expected_keywords():
        yield from _keywords(str(token), automaton.expected_keywords())
    if not within_item and (token.type == END or opens_section(tokens, position)):
        yield from (Repair((("RBRACE", "}"),) * count, 0, in_item=False) for count in range(1, _DEEPEST + 1))
    for type_ in inserted:
        yield Repair(((type_, _SPELLING[type_]),), 0, in_item=True)
    if token.type in _SKIPPED:
        yield Repair((), 1, in_item=True)


def _keywords(word: str, expected: Sequence[str]) -> Iterator[Repair]:
    """Keywords that fit here and that the word may be meant for."""
    for keyword in get_close_matches(word.upper(), expected, n=2, cutoff=_SIMILARITY):
        yield Repair(((keyword, keyword),), 1, in_item=True)
