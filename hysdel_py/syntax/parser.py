"""Text to syntax tree."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax import ast
from hysdel_py.syntax.dialect import Dialect, grammar_of, stated_dialect
from hysdel_py.syntax.extension import Extension, extended, stated_extensions
from hysdel_py.syntax.source import Source, Span

if TYPE_CHECKING:
    from lark import Lark

    from hysdel_py.syntax.recovery import Recovered

__all__ = ["grammar_text", "parse", "parse_what_is_sound"]


def grammar_text() -> str:
    """The grammar: inside an installed package, beside the package in a checkout."""
    installed = resources.files("hysdel_py") / "grammar" / "hysdel.lark"
    if installed.is_file():
        return installed.read_text(encoding="utf-8")
    return (Path(__file__).parents[2] / "grammar" / "hysdel.lark").read_text(encoding="utf-8")


@cache
def _lark(dialect: Dialect, extensions: frozenset[Extension]) -> Lark:
    from hysdel_py.syntax.parser_tables import parser_of
    from hysdel_py.syntax.tree_to_ast import TreeToAst

    name = "-".join([dialect.name, *sorted(extension.name for extension in extensions)]).lower()
    return parser_of(extended(grammar_of(dialect, grammar_text()), extensions), name, TreeToAst())


def parse(source: Source, sink: Sink) -> ast.System | None:
    """Parse a source text.

    Returns
    -------
    System or None
        None after an error, which is in the sink. A text without a system gives an empty system and a warning, as
        the original compiler accepts it.
    """
    before = sink.error_count
    recovered = parse_what_is_sound(source, sink)
    return None if sink.error_count > before else recovered.system


def parse_what_is_sound(source: Source, sink: Sink) -> Recovered:
    """Parse a source text in its dialect and keep what can be read of a faulty one, for further checks."""
    from hysdel_py.syntax.recovery import Recovered, parse_tokens

    before = sink.error_count
    dialect, extensions = stated_dialect(source, sink), stated_extensions(source, sink)
    recovered = parse_tokens(_lark(dialect, extensions), source, sink)
    if recovered.system is not None:
        return replace(recovered, system=replace(recovered.system, dialect=dialect))
    if sink.error_count == before:
        sink.warning(Code.EMPTY, f"{source.name} holds no SYSTEM: the model is empty")
        empty = ast.System("", (), (), Span(0, len(source.text)), dialect=dialect)
        return Recovered(empty, recovered.lost)
    return recovered
