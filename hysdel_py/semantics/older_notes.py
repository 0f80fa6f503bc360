"""Notes about the outside of a file that HYSDEL 2.0.5 would refuse; those about expressions come from the typer."""

from __future__ import annotations

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax import ast
from hysdel_py.syntax.dialect import Dialect
from hysdel_py.syntax.source import Source

__all__ = ["note_what_the_original_refuses"]


def note_what_the_original_refuses(system: ast.System, source: Source, sink: Sink) -> None:
    """Report line ends, comments and places of sections that the original compiler refuses, each kind once."""
    if "\r" in source.text:
        sink.note(Code.EXTENSION, "HYSDEL 2.0.5 refuses carriage returns (line ends of Windows)")
    line_comment = next((span for span in source.comments if source.text.startswith("//", span.start)), None)
    if line_comment is not None:
        sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no comments behind //", line_comment)
    if system.dialect is not Dialect.HYSDEL_2:
        sink.note(Code.EXTENSION, "HYSDEL 2.0.5 has a precedence of its own for logic and no other dialect")
    late = _late_auxiliaries(system)
    if late is not None:
        sink.note(Code.EXTENSION, "HYSDEL 2.0.5 wants one AUX, at the beginning of IMPLEMENTATION", late.span)


def _late_auxiliaries(system: ast.System) -> ast.DeclarationSection | None:
    """The first AUX that is not at the beginning of IMPLEMENTATION."""
    auxiliaries = [section for section in system.declarations if section.kind is ast.SectionKind.AUX]
    first_item = min((section.span.start for section in system.sections), default=None)
    for index, section in enumerate(auxiliaries):
        if index or (first_item is not None and section.span.start > first_item):
            return section
    return None
