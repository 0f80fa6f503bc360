"""Diagnostics as a SARIF 2.1.0 log, which code hosts and editors read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from hysdel_py.diagnostics.diagnostic import Diagnostic, Severity
from hysdel_py.diagnostics.explain import title
from hysdel_py.diagnostics.render import region
from hysdel_py.syntax.source import Source, Span

__all__ = ["SCHEMA", "as_sarif"]

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"

_LEVEL = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}


def as_sarif(found: Sequence[tuple[Source, Diagnostic]], version: str) -> dict[str, Any]:
    """One log with one run, whose rules are the codes that occur; `version` is that of the program."""
    codes = sorted({diagnostic.code for _, diagnostic in found}, key=lambda code: code.value)
    rules = [{"id": code.value, "name": code.name, "shortDescription": {"text": title(code)}} for code in codes]
    driver = {"name": "hysdel", "version": version, "rules": rules}
    number = {code: index for index, code in enumerate(codes)}
    results = [_result(source, diagnostic, number[diagnostic.code]) for source, diagnostic in found]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}


def _result(source: Source, diagnostic: Diagnostic, rule: int) -> dict[str, Any]:
    text = f"{diagnostic.message}; {diagnostic.help}" if diagnostic.help else diagnostic.message
    result: dict[str, Any] = {
        "ruleId": diagnostic.code.value,
        "ruleIndex": rule,
        "level": _LEVEL[diagnostic.severity],
        "message": {"text": text},
        "locations": [_location(source, diagnostic.span)],
    }
    if diagnostic.labels:
        result["relatedLocations"] = [
            _location(source, label.span) | {"message": {"text": label.text}} for label in diagnostic.labels
        ]
    if diagnostic.fixes:
        replacements = [
            {"deletedRegion": _region(source, fix.span), "insertedContent": {"text": fix.replacement}}
            for fix in diagnostic.fixes
        ]
        changes = [{"artifactLocation": _artifact(source), "replacements": replacements}]
        result["fixes"] = [{"artifactChanges": changes}]
    return result


def _location(source: Source, span: Span | None) -> dict[str, Any]:
    home = source if span is None else source.home(span)[0]
    physical: dict[str, Any] = {"artifactLocation": _artifact(home)}
    if span is not None:
        physical["region"] = _region(source, span)
    return {"physicalLocation": physical}


def _artifact(source: Source) -> dict[str, str]:
    from urllib.parse import quote

    return {"uri": quote(source.name if source.path is None else source.path.as_posix())}


def _region(source: Source, span: Span) -> dict[str, int]:
    places = region(span, source)
    return {
        "startLine": places["line"],
        "startColumn": places["column"],
        "endLine": places["end_line"],
        "endColumn": places["end_column"],
    }
