"""Diagnostics as text with the source line and a caret, and as plain data for JSON."""

from __future__ import annotations

from typing import Any

from hysdel_py.diagnostics.diagnostic import Diagnostic, Fix
from hysdel_py.syntax.source import Source, Span

__all__ = ["as_data", "place", "region", "render"]

_WIDTH = 120


def render(diagnostic: Diagnostic, source: Source) -> str:
    """Text of a diagnostic: headline, source line with carets, further places, help."""
    headline = f"{diagnostic.severity.value}[{diagnostic.code.value}]: {diagnostic.message}"
    lines = [headline]
    if diagnostic.span is None:
        lines.append(f"  --> {source.name}")
    else:
        lines += place(diagnostic.span, source, "^")
    for label in diagnostic.labels:
        lines += [f"  {label.text}:", *place(label.span, source, "-")]
    if diagnostic.help:
        lines.append(f"  help: {diagnostic.help}")
    lines += [f"  fix: {_spoken(fix, source)}" for fix in diagnostic.fixes]
    return "\n".join(lines) + "\n"


def _spoken(fix: Fix, source: Source) -> str:
    """A replacement in words."""
    written = source.text[fix.span.start : fix.span.end]
    if not written:
        return f"insert '{fix.replacement}'"
    return f"replace '{written}' by '{fix.replacement}'" if fix.replacement else f"delete '{written}'"


def place(span: Span, source: Source, mark: str = "^") -> list[str]:
    """Lines that show a place: file, line and column, the line itself, and marks below the span."""
    source, span = source.home(span)
    line, column = source.position(span.start)
    gutter = " " * len(str(line))
    shown, start = _window(source.line_text(line).replace("\t", " "), column - 1)
    length = max(1, min(span.end, span.start + len(shown) - start) - span.start)
    return [
        f"{gutter}--> {source.name}:{line}:{column}",
        f"{gutter} |",
        f"{line} | {shown}",
        f"{gutter} | {' ' * start}{mark * length}",
    ]


def _window(text: str, column: int) -> tuple[str, int]:
    """Cut a very long line to the part around a column."""
    if len(text) <= _WIDTH:
        return text, column
    left = max(0, column - _WIDTH // 2)
    prefix = "..." if left else ""
    suffix = "..." if left + _WIDTH < len(text) else ""
    return f"{prefix}{text[left : left + _WIDTH]}{suffix}", column - left + len(prefix)


def as_data(diagnostic: Diagnostic, source: Source) -> dict[str, Any]:
    """Plain data of a diagnostic for JSON; lines and columns count from 1."""
    home = source if diagnostic.span is None else source.home(diagnostic.span)[0]
    data: dict[str, Any] = {
        "code": diagnostic.code.value,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "help": diagnostic.help,
        "file": home.name,
    }
    if diagnostic.span is not None:
        data |= region(diagnostic.span, source)
    if diagnostic.labels:
        data["labels"] = [{"text": label.text, **region(label.span, source)} for label in diagnostic.labels]
    if diagnostic.fixes:
        data["fixes"] = [{"replacement": f.replacement, **region(f.span, source)} for f in diagnostic.fixes]
    return data


def region(span: Span, source: Source) -> dict[str, int]:
    """First and last place of a span in its file; lines and columns count from 1, the last column is behind it."""
    source, span = source.home(span)
    line, column = source.position(span.start)
    end_line, end_column = source.position(span.end)
    return {"line": line, "column": column, "end_line": end_line, "end_column": end_column}
