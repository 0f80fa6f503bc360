"""The tree of a document: sections with their declarations."""

from __future__ import annotations

from dataclasses import dataclass

from hysdel_py.lsp.document import Document
from hysdel_py.syntax.source import Span

__all__ = ["Entry", "entries"]


@dataclass(frozen=True, slots=True)
class Entry:
    """A section, or a declaration in one; `kind` is "section", "variable" or "parameter"."""

    name: str
    detail: str
    kind: str
    span: Span
    name_span: Span
    children: tuple[Entry, ...] = ()


def entries(document: Document) -> tuple[Entry, ...]:
    """Sections inside INTERFACE and IMPLEMENTATION in the order of the text."""
    sections = (s for s in document.outline.sections if s.parents and s.word not in ("INTERFACE", "IMPLEMENTATION"))
    found = []
    for section in sections:
        if section.parents[-1] not in ("INTERFACE", "IMPLEMENTATION"):
            continue
        span = Span(section.start, min(section.end + 1, len(document.text)))
        inner = tuple(
            Entry(d.name, d.type, "parameter" if d.section == "PARAMETER" else "variable", d.span, d.span)
            for d in document.outline.declared
            if section.body <= d.span.start < section.end
        )
        name_span = Span(section.start, section.start + len(section.word))
        found.append(Entry(section.word, "", "section", span, name_span, inner))
    return tuple(found)
