"""Where a name is declared and used, and giving it another one."""

from __future__ import annotations

import re

from hysdel_py.errors import ArgumentError
from hysdel_py.lsp.document import Document
from hysdel_py.syntax.source import Span
from hysdel_py.syntax.tokens import FUNCTION_WORDS, TokenKind

__all__ = ["definition", "references", "rename"]

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_PREDEFINED = frozenset({"pi", "MLD_epsilon", "MLD_bigMbound"})


def definition(document: Document, offset: int) -> Span | None:
    """Where the name at an offset is declared; None for what is no name or is declared nowhere."""
    token = document.name_at(offset)
    if token is None or token.span not in references(document, offset):
        return None
    return next((d.span for d in document.outline.declared if d.name == token.text), None)


def references(document: Document, offset: int) -> tuple[Span, ...]:
    """All places of the name at an offset, its declaration included, in the order of the text."""
    token = document.name_at(offset)
    if token is None:
        return ()
    uses = _uses(document, token.text)
    return uses if token.span in uses else ()


def _uses(document: Document, name: str) -> tuple[Span, ...]:
    """Places where a name stands for a variable: not behind SYSTEM, and not for a part of something else."""
    tokens = document.tokens
    return tuple(
        token.span
        for index, token in enumerate(tokens)
        if token.text == name
        and token.kind is TokenKind.NAME
        and name not in FUNCTION_WORDS
        and not (index and tokens[index - 1].text in ("SYSTEM", "."))
    )


def rename(document: Document, offset: int, name: str) -> tuple[Span, ...]:
    """Places to change for giving the name at an offset another one.

    Raises
    ------
    ArgumentError
        There is nothing to rename, or the new name is none, a word of the language or taken.
    """
    places = references(document, offset)
    token = document.name_at(offset)
    if token is None or not places:
        raise ArgumentError("there is no name here that could be changed")
    if definition(document, offset) is None:
        raise ArgumentError(f"{token.text} is not declared in this file and cannot be renamed")
    if not _NAME.fullmatch(name):
        raise ArgumentError(f"{name!r} is not a name: a letter, then letters, digits and underscores were expected")
    if name in document.keywords | FUNCTION_WORDS:
        raise ArgumentError(f"{name} is a word of the language and cannot be a name")
    if name != token.text and (name in _PREDEFINED or _uses(document, name)):
        raise ArgumentError(f"{name} is already in use in this file")
    return places
