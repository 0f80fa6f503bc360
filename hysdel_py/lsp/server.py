"""The language server: a thin layer that puts the answers of this room into the words of the protocol.

Needs pygls, which the extra ``lsp`` installs; nothing else in the package imports this module when loaded.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import unquote, urlparse
from urllib.request import url2pathname

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer

from hysdel_py.diagnostics.diagnostic import Diagnostic, Severity
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.errors import ArgumentError
from hysdel_py.lsp.completion import Proposal, completions
from hysdel_py.lsp.document import Document
from hysdel_py.lsp.hover import hover
from hysdel_py.lsp.names import definition, references, rename
from hysdel_py.lsp.symbols import Entry, entries
from hysdel_py.syntax.formatter import format_text
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.source import Span
from hysdel_py.version import __version__

__all__ = ["create_server"]

_SEVERITY = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.NOTE: types.DiagnosticSeverity.Hint,
}
_COMPLETION = {
    "keyword": types.CompletionItemKind.Keyword,
    "function": types.CompletionItemKind.Function,
    "variable": types.CompletionItemKind.Variable,
    "parameter": types.CompletionItemKind.Constant,
}
_SYMBOL = {
    "section": types.SymbolKind.Namespace,
    "variable": types.SymbolKind.Variable,
    "parameter": types.SymbolKind.Constant,
}

_AtPlace = (
    types.HoverParams | types.DefinitionParams | types.ReferenceParams | types.RenameParams | types.CompletionParams
)


def create_server() -> LanguageServer:
    """A server that is ready for :meth:`start_io`."""
    server = LanguageServer("hysdel", __version__)
    handlers = _Handlers(server)
    answers: dict[str, Callable[..., Any]] = {
        types.TEXT_DOCUMENT_DID_OPEN: handlers.changed,
        types.TEXT_DOCUMENT_DID_CHANGE: handlers.changed,
        types.TEXT_DOCUMENT_DID_CLOSE: handlers.closed,
        types.TEXT_DOCUMENT_HOVER: handlers.hover,
        types.TEXT_DOCUMENT_DEFINITION: handlers.definition,
        types.TEXT_DOCUMENT_REFERENCES: handlers.references,
        types.TEXT_DOCUMENT_RENAME: handlers.rename,
        types.TEXT_DOCUMENT_COMPLETION: handlers.completion,
        types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: handlers.symbols,
        types.TEXT_DOCUMENT_FORMATTING: handlers.formatting,
    }
    for method, answer in answers.items():
        server.feature(method)(partial(answer))  # pygls sets attributes, which a method does not take
    return server


class _Handlers:
    """One method per request; remembers what is known about each open text."""

    def __init__(self, server: LanguageServer) -> None:
        self._server = server
        self._documents: dict[str, Document] = {}

    def _document(self, uri: str) -> Document:
        text = self._server.workspace.get_text_document(uri).source
        known = self._documents.get(uri)
        if known is None or known.text != text:
            known = self._documents[uri] = _opened(text, uri)
        return known

    def _place(self, params: _AtPlace) -> tuple[Document, int]:
        document = self._document(params.text_document.uri)
        return document, document.positions.offset(params.position.line, params.position.character)

    def changed(self, params: types.DidOpenTextDocumentParams | types.DidChangeTextDocumentParams) -> None:
        uri, version = params.text_document.uri, params.text_document.version
        document = self._document(uri)
        found = [_diagnostic(document, diagnostic, uri) for diagnostic in document.diagnostics]
        self._server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, found, version))

    def closed(self, params: types.DidCloseTextDocumentParams) -> None:
        self._documents.pop(params.text_document.uri, None)
        self._server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(params.text_document.uri, []))

    def hover(self, params: types.HoverParams) -> types.Hover | None:
        document, offset = self._place(params)
        text, token = hover(document, offset), document.name_at(offset)
        if not text or token is None:
            return None
        return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, text), _range(document, token.span))

    def definition(self, params: types.DefinitionParams) -> types.Location | None:
        document, offset = self._place(params)
        span = definition(document, offset)
        return None if span is None else types.Location(params.text_document.uri, _range(document, span))

    def references(self, params: types.ReferenceParams) -> list[types.Location]:
        document, offset = self._place(params)
        declared = None if params.context.include_declaration else definition(document, offset)
        spans = (span for span in references(document, offset) if span != declared)
        return [types.Location(params.text_document.uri, _range(document, span)) for span in spans]

    def rename(self, params: types.RenameParams) -> types.WorkspaceEdit:
        document, offset = self._place(params)
        try:
            spans = rename(document, offset, params.new_name)
        except ArgumentError as error:
            raise JsonRpcInvalidParams(str(error)) from error
        edits = [types.TextEdit(_range(document, span), params.new_name) for span in spans]
        return types.WorkspaceEdit(changes={params.text_document.uri: edits})

    def completion(self, params: types.CompletionParams) -> list[types.CompletionItem]:
        return [_completion(proposal) for proposal in completions(*self._place(params))]

    def symbols(self, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        document = self._document(params.text_document.uri)
        return [_symbol(document, entry) for entry in entries(document)]

    def formatting(self, params: types.DocumentFormattingParams) -> list[types.TextEdit]:
        document = self._document(params.text_document.uri)
        sink = Sink()
        parse(document.source, sink)
        formatted = document.text if sink.failed else format_text(document.text)
        if formatted == document.text:
            return []
        return [types.TextEdit(_range(document, Span(0, len(document.text))), formatted)]


def _opened(text: str, uri: str) -> Document:
    """A text with its name and, where it is a file, its folder."""
    parsed = urlparse(uri)
    folder = Path(url2pathname(parsed.path)).parent if parsed.scheme == "file" else None
    return Document(text, PurePosixPath(unquote(parsed.path)).name, folder)


def _range(document: Document, span: Span) -> types.Range:
    start, end = (types.Position(*document.positions.position(offset)) for offset in (span.start, span.end))
    return types.Range(start, end)


def _diagnostic(document: Document, diagnostic: Diagnostic, uri: str) -> types.Diagnostic:
    help_ = f"\nhelp: {diagnostic.help}" if diagnostic.help else ""
    related = [
        types.DiagnosticRelatedInformation(types.Location(uri, _range(document, label.span)), label.text)
        for label in diagnostic.labels
    ]
    return types.Diagnostic(
        range=_range(document, diagnostic.span or Span(0, 0)),
        message=diagnostic.message + help_,
        severity=_SEVERITY[diagnostic.severity],
        code=diagnostic.code.value,
        source="hysdel",
        related_information=related or None,
    )


def _completion(proposal: Proposal) -> types.CompletionItem:
    return types.CompletionItem(proposal.word, kind=_COMPLETION[proposal.kind], detail=proposal.detail or None)


def _symbol(document: Document, entry: Entry) -> types.DocumentSymbol:
    return types.DocumentSymbol(
        name=entry.name,
        kind=_SYMBOL[entry.kind],
        range=_range(document, entry.span),
        selection_range=_range(document, entry.name_span),
        detail=entry.detail or None,
        children=[_symbol(document, child) for child in entry.children],
    )
