"""What may be typed at a place."""

from __future__ import annotations

from dataclasses import dataclass

from hysdel_py.lsp.document import Document
from hysdel_py.syntax.extension import QUERY_CLAUSES, QUERY_KINDS
from hysdel_py.syntax.tokens import DECLARING, FUNCTION_WORDS, Token

__all__ = ["Proposal", "completions"]

_ITEMS = ("AD", "DA", "LOGIC", "LINEAR", "CONTINUOUS", "AUTOMATA", "OUTPUT", "MUST")
_BY_PLACE: dict[str, tuple[str, ...]] = {
    "": ("SYSTEM",),
    "SYSTEM": ("INTERFACE", "IMPLEMENTATION"),
    "INTERFACE": ("STATE", "INPUT", "OUTPUT", "PARAMETER"),
    "IMPLEMENTATION": ("AUX", *_ITEMS),
}
# Declarations whose names stand on the left side of the items of a section.
_DEFINED_BY = {
    "AD": ("AUX", "BOOL"), "LOGIC": ("AUX", "BOOL"), "DA": ("AUX", "REAL"), "LINEAR": ("AUX", "REAL"),
    "CONTINUOUS": ("STATE", "REAL"), "AUTOMATA": ("STATE", "BOOL"), "OUTPUT": ("OUTPUT", ""),
}  # fmt: skip
_CONSTANT = ("TRUE", "FALSE")


@dataclass(frozen=True, slots=True)
class Proposal:
    """A word that fits; `kind` is "keyword", "function", "variable" or "parameter"."""

    word: str
    kind: str
    detail: str = ""


def completions(document: Document, offset: int) -> tuple[Proposal, ...]:
    """Words that fit at an offset; the editor drops those that do not begin as typed."""
    path = document.outline.path(offset)
    place = path[-1] if path else ""
    if place in _BY_PLACE:
        return _keywords(*_BY_PLACE[place], *_asked_for(document, place))
    before = _before(document, offset)
    declares = place in DECLARING and (place != "OUTPUT" or "INTERFACE" in path)
    if before is not None and before.text == "{" and path and not _opens(document, before):
        return _keywords("IF")
    if place == "QUERIES":
        return _in_query(document, before)
    if before is None or before.text in "{};":
        return _keywords("REAL", "BOOL") if declares else _left_sides(document, place)
    if declares:
        return _in_declaration(document, before)
    return _in_expression(document, place)


def _asked_for(document: Document, place: str) -> tuple[str, ...]:
    """Sections of the extensions that the text states."""
    return ("QUERIES",) if place == "IMPLEMENTATION" and "QUERIES" in document.keywords else ()


def _in_query(document: Document, before: Token | None) -> tuple[Proposal, ...]:
    """A query begins with its kind; what it reads may be anything with a name."""
    if before is None or before.text in "{};":
        return _keywords(*sorted(QUERY_KINDS), "FOR")
    names = _names(document, "STATE", "INPUT", "OUTPUT", "AUX", "PARAMETER")
    return (*names, *_functions(), *_keywords(*sorted(QUERY_CLAUSES), "REAL", *_CONSTANT))


def _before(document: Document, offset: int) -> Token | None:
    """Last token that ends before the word at an offset."""
    word = next((t.start for t in document.tokens if t.start < offset <= t.end and t.text[0].isalnum()), offset)
    return next((token for token in reversed(document.tokens) if token.end <= word), None)


def _opens(document: Document, brace: Token) -> bool:
    """Whether a brace opens a section and not a choice."""
    return any(section.body == brace.end for section in document.outline.sections)


def _keywords(*words: str) -> tuple[Proposal, ...]:
    return tuple(Proposal(word, "keyword") for word in words)


def _names(document: Document, *sections: str) -> tuple[Proposal, ...]:
    return tuple(
        Proposal(d.name, "parameter" if d.section == "PARAMETER" else "variable", f"{d.type} {d.section}")
        for d in document.outline.declared
        if d.section in sections
    )


def _left_sides(document: Document, place: str) -> tuple[Proposal, ...]:
    if place not in _DEFINED_BY:
        return _in_expression(document, place)
    section, type_ = _DEFINED_BY[place]
    return tuple(p for p in _names(document, section) if p.detail.startswith(type_))


def _in_declaration(document: Document, before: Token) -> tuple[Proposal, ...]:
    if before.text in ("REAL", "BOOL"):
        return ()  # a new name
    return (*_names(document, "PARAMETER"), *_functions(), *_keywords(*_CONSTANT))


def _in_expression(document: Document, place: str) -> tuple[Proposal, ...]:
    words = ("IF", "THEN", "ELSE") if place == "DA" else ()
    names = _names(document, "STATE", "INPUT", "AUX", "PARAMETER")
    return (*names, *_functions(), *_keywords(*words, "REAL", *_CONSTANT))


def _functions() -> tuple[Proposal, ...]:
    return tuple(Proposal(word, "function") for word in sorted(FUNCTION_WORDS))
