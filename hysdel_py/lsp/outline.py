"""Sections and declarations of a text, found by tokens and brackets so that mistakes elsewhere do not hide them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hysdel_py.syntax.source import Span
from hysdel_py.syntax.tokens import DECLARING, TYPES, Token, TokenKind

__all__ = ["Declared", "Outline", "Section", "outline_of"]

_DECLARING_WORDS = TYPES | {"INDEX"}
_CONTROL = ("IF", "THEN", "ELSE")


@dataclass(frozen=True, slots=True)
class Declared:
    """A name in its declaration."""

    name: str
    type: str
    section: str
    span: Span


@dataclass(frozen=True, slots=True)
class Section:
    """A word with its braces; `end` is the end of the text where the brace is missing."""

    word: str
    start: int
    body: int
    end: int
    parents: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Outline:
    """Sections in the order of their beginnings, declarations in the order of the text."""

    sections: tuple[Section, ...]
    declared: tuple[Declared, ...]

    def path(self, offset: int) -> tuple[str, ...]:
        """Words of the sections around an offset, outermost first."""
        inner = [s for s in self.sections if s.body <= offset <= s.end]
        return (*inner[-1].parents, inner[-1].word) if inner else ()


@dataclass(slots=True)
class _Open:
    word: str
    start: int
    body: int
    is_section: bool


def outline_of(tokens: Sequence[Token], length: int) -> Outline:
    """Outline of a text of some length from its tokens without comments."""
    stack: list[_Open] = []
    sections: list[Section] = []
    declared: list[Declared] = []
    type_ = ""  # of the declaration that is being read
    word: Token | None = None  # last keyword since the last brace or semicolon
    for index, token in enumerate(tokens):
        if token.kind is TokenKind.OPEN:
            is_section = token.text == "{" and word is not None and word.text not in _CONTROL
            start = word.start if word is not None else token.start
            stack.append(_Open(word.text if word and is_section else token.text, start, token.end, is_section))
        elif token.kind is TokenKind.CLOSE and stack:
            _close(stack, token.start, sections)
        elif token.text in _DECLARING_WORDS and _declares(stack):
            type_ = token.text
        elif token.kind is TokenKind.NAME and type_ and _declares(stack) and _begins(tokens[index - 1]):
            declared.append(Declared(token.text, type_, stack[-1].word, token.span))
        word, type_ = _after(token, word, type_, stack)
    while stack:
        _close(stack, length, sections)
    return Outline(tuple(sorted(sections, key=lambda s: (s.body, -s.end))), tuple(declared))


def _after(token: Token, word: Token | None, type_: str, stack: list[_Open]) -> tuple[Token | None, str]:
    """Keyword and type that hold behind a token."""
    if token.kind is TokenKind.KEYWORD:
        return token, type_
    if token.text in "{};":
        return None, type_ if stack and not stack[-1].is_section else ""
    return word, type_


def _close(stack: list[_Open], end: int, sections: list[Section]) -> None:
    top = stack.pop()
    if top.is_section:
        parents = tuple(entry.word for entry in stack if entry.is_section)
        sections.append(Section(top.word, top.start, top.body, end, parents))


def _declares(stack: list[_Open]) -> bool:
    """Whether declarations stand directly in the innermost section."""
    if not stack or stack[-1].word not in DECLARING:
        return False
    return stack[-1].word != "OUTPUT" or any(entry.word == "INTERFACE" for entry in stack)


def _begins(before: Token) -> bool:
    return before.text == "," or before.text in _DECLARING_WORDS
