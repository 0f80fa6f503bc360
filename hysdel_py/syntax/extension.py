"""Parts of the language that a file has to ask for, by a comment in front of it: ``/* extension: queries */``.

Their words are ordinary names in all other files, so that no model which the original compiler accepts changes.
"""

from __future__ import annotations

import re
from enum import Enum

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.front import Statement, statements
from hysdel_py.syntax.source import Source

__all__ = ["QUERY_CLAUSES", "QUERY_KINDS", "QUERY_WORDS", "Extension", "extended", "stated_extensions"]


class Extension(Enum):
    """A part of the language; the value is how its comment calls it."""

    QUERIES = "queries"


QUERY_KINDS = frozenset({"NEVER", "ALWAYS", "EVENTUALLY"})
QUERY_CLAUSES = frozenset({"WITHIN", "FROM"})
QUERY_WORDS = QUERY_KINDS | QUERY_CLAUSES | {"QUERIES"}
"""Words that cannot be names in a file with queries."""

_KNOWN = {extension.value: extension for extension in Extension}
_IMPLEMENTATION = re.compile(r"^(implementation:.*)\(auxiliaries \| section\)\*", re.MULTILINE)
_LOOP_HEAD = 'FOR "(" NAME "=" expression ":" expression (":" expression)? ")"'
_QUERIES = f"""
query_section: "QUERIES" "{{" (query ";" | queries)* "}}" -> section
queries: {_LOOP_HEAD} "{{" (query ";" | queries)* "}}" -> loop
query: ("NEVER" | "ALWAYS" | "EVENTUALLY") expression "WITHIN" expression ("FROM" expression)?
"""


def extended(grammar: str, extensions: frozenset[Extension]) -> str:
    """A grammar with the rules of some extensions."""
    if Extension.QUERIES not in extensions:
        return grammar
    grammar, count = _IMPLEMENTATION.subn(r"\1(auxiliaries | section | query_section)*", grammar)
    assert count == 1, f"the grammar has {count} rules of IMPLEMENTATION"
    return grammar + _QUERIES


def stated_extensions(source: Source, sink: Sink) -> frozenset[Extension]:
    """The extensions that the comments in front of a text ask for."""
    found = [_extension(statement, sink) for statement in statements(source, "extension")]
    return frozenset(extension for extension in found if extension is not None)


def _extension(statement: Statement, sink: Sink) -> Extension | None:
    """A text behind the first word that names no extension may be a comment like others, so it is no error."""
    extension = _KNOWN.get(statement.value)
    if extension is not None and not statement.in_front:
        sink.error(
            Code.DIALECT, "an extension has to be stated in front of SYSTEM", statement.span,
            help="move the comment to the beginning of the file",
        )  # fmt: skip
        return None
    if extension is None and statement.in_front:
        known = " and ".join(_KNOWN)
        sink.warning(
            Code.DIALECT, f"there is no extension {statement.value or '(empty)'}: the known one is {known}",
            statement.span, help="write /* extension: queries */, or change the first word of the comment",
        )  # fmt: skip
    return extension
