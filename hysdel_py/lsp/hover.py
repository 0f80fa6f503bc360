"""What is shown for the name under the pointer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from hysdel_py.export.identifiers import element_of
from hysdel_py.lsp.document import Document
from hysdel_py.lsp.names import references
from hysdel_py.semantics.symbols import Symbol
from hysdel_py.semantics.typed_model import Item
from hysdel_py.systems.describe import inequalities
from hysdel_py.systems.mld import Mld

__all__ = ["hover"]

_MOST_ROWS = 12


def hover(document: Document, offset: int) -> str:
    """Markdown about the name at an offset; empty where there is nothing to say.

    Type, role, range or value, unit and description; the item that defines the name and the rows that this becomes.
    """
    token = document.name_at(offset)
    if token is None or token.span not in references(document, offset):
        return ""
    symbol = document.symbols.get(token.text)
    if symbol is not None:
        return "\n\n".join(_about(symbol, document))
    elements = [symbol for name, symbol in document.symbols.items() if element_of(name)[0] == token.text]
    if elements:
        return "\n\n".join(_about_vector(token.text, elements, document))
    declared = next((d for d in document.outline.declared if d.name == token.text), None)
    return f"**{declared.name}**: {declared.type}, declared in {declared.section}" if declared else ""


def _about(symbol: Symbol, document: Document) -> Iterator[str]:
    value = _value(symbol, document) if symbol.is_parameter else _range(symbol, document)
    yield f"**{symbol.name}**: {symbol.spoken}{value}{f' [{symbol.unit}]' if symbol.unit else ''}"
    if symbol.description:
        yield symbol.description
    for item in document.model.items if document.model else ():
        if item.target == symbol:
            yield "\n".join(_about_item(item, document.mld))


def _about_vector(name: str, elements: Sequence[Symbol], document: Document) -> Iterator[str]:
    """A vector or matrix as a whole: what its elements share, the value or range of each, and its equations."""
    first = elements[0]
    yield f"**{name}**: {len(elements)} elements, {first.spoken}{f' [{first.unit}]' if first.unit else ''}"
    if first.description:
        yield first.description
    told = [
        f"- {s.name}{_value(s, document) if s.is_parameter else _range(s, document)}" for s in elements[:_MOST_ROWS]
    ]
    more = [f"- ... {len(elements) - _MOST_ROWS} more"] if len(elements) > _MOST_ROWS else []
    yield "\n".join(told + more)
    items = document.model.items if document.model else ()
    texts = dict.fromkeys(
        f"{i.section.value}, line {i.line}\n```hysdel\n{i.text}\n```" for i in items if i.target in elements
    )
    yield from texts


def _value(symbol: Symbol, document: Document) -> str:
    value = document.values.get(symbol.name)
    if value is not None:
        return f" = {value:.12g}" if symbol.is_real else f" = {'TRUE' if value else 'FALSE'}"
    if symbol.value is not None:
        return f" = {document.source.excerpt(symbol.value.span)}"
    return ", no value given"


def _range(symbol: Symbol, document: Document) -> str:
    if not symbol.is_real:
        return ""
    if document.mld is not None:
        variables = (*document.mld.x, *document.mld.u, *document.mld.z)
        for variable in variables:
            if variable.name == symbol.name:
                return f" in [{variable.low:.12g}, {variable.high:.12g}]"
    if symbol.bounds is None:
        return ""
    low, high = (document.source.excerpt(bound.span) for bound in symbol.bounds)
    return f" in [{low}, {high}]"


def _about_item(item: Item, mld: Mld | None) -> Iterator[str]:
    yield f"{item.section.value}, line {item.line}"
    yield "```hysdel"
    yield item.text
    yield "```"
    if mld is None:
        return
    rows = [text for row, text in zip(mld.rows, inequalities(mld), strict=True) if row.group == item.number]
    if rows:
        yield f"{len(rows)} row{'s' * (len(rows) != 1)}"
        yield "```"
        yield from rows[:_MOST_ROWS]
        if len(rows) > _MOST_ROWS:
            yield f"... {len(rows) - _MOST_ROWS} more"
        yield "```"
