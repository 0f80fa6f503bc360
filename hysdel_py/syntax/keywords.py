"""The words that cannot be names in a file, which depends on the extensions that it asks for."""

from __future__ import annotations

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.extension import QUERY_WORDS, Extension, stated_extensions
from hysdel_py.syntax.source import Source
from hysdel_py.syntax.tokens import KEYWORDS

__all__ = ["keywords_of"]


def keywords_of(text: str) -> frozenset[str]:
    """Keywords of a text."""
    extensions = stated_extensions(Source("", text), Sink())
    return KEYWORDS | QUERY_WORDS if Extension.QUERIES in extensions else KEYWORDS
