"""``hysdel check``: find mistakes."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Any

from hysdel_py.cli.arguments import add_parameters, load_model
from hysdel_py.cli.colour import painted
from hysdel_py.cli.output import print_json
from hysdel_py.cli.proofs import seconds_of
from hysdel_py.cli.watch import watched
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic, Severity
from hysdel_py.diagnostics.explain import explain
from hysdel_py.diagnostics.render import as_data, render
from hysdel_py.diagnostics.sarif import as_sarif
from hysdel_py.errors import CompileError
from hysdel_py.model import Model
from hysdel_py.semantics.parameters import missing_parameters
from hysdel_py.shipped import shipped_models
from hysdel_py.syntax.source import Source
from hysdel_py.version import __version__

if TYPE_CHECKING:
    from hysdel_py.analysis.well_posed import WellPosedness

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel check model.hys
  hysdel check *.hys --strict
  hysdel check model.hys --param ts=0.01 --format json
  hysdel check model.hys --deep
  hysdel check model.hys -W HYS525 --ignore HYS501

Parameters without a value do not fail the check; what can be checked without them is.
hysdel explain CODE tells more about a diagnostic.
exit status: 1 if any file has an error, or with --strict a warning
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "check",
        description="Check models and say what is wrong, where, and what to do about it.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    shipped = ", ".join(shipped_models())
    parser.add_argument("files", metavar="FILE", nargs="+", help=f"a .hys file, or a shipped model: {shipped}")
    add_parameters(parser)
    parser.add_argument("--format", choices=("text", "json", "sarif"), default="text", help="form of the report")
    parser.add_argument("--json", dest="format", action="store_const", const="json", help="the same as --format json")
    parser.add_argument(
        "--deep", action="store_true", help="search all states and inputs for what is probably not meant, too"
    )
    parser.add_argument(
        "--seconds", type=float, default=inf, metavar="T", help="time limit of --deep for each file (default none)"
    )
    parser.add_argument("--strict", action="store_true", help="warnings fail the check")
    parser.add_argument(
        "-W", dest="warn", metavar="CODE", action="append", default=[], help="show notes of this code as warnings"
    )
    parser.add_argument(
        "--ignore", metavar="CODE", action="append", default=[], help="say nothing of warnings and notes of this code"
    )
    parser.set_defaults(run=run)


@dataclass(frozen=True, slots=True)
class _Report:
    """What the check of one file found; `model` is None where it has errors."""

    source: Source
    model: Model | None
    diagnostics: tuple[Diagnostic, ...]
    deep: WellPosedness | None = None

    def has(self, severity: Severity) -> bool:
        return any(d.severity is severity for d in self.diagnostics)

    @property
    def warnings(self) -> int:
        return sum(d.severity is Severity.WARNING for d in self.diagnostics)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    raised, ignored = _codes(options.warn), _codes(options.ignore)
    reports = [_chosen(_check(file, options), raised, ignored) for file in options.files]
    {"text": _print_text, "json": _print_json, "sarif": _print_sarif}[options.format](reports)
    failing = (Severity.ERROR, Severity.WARNING) if options.strict else (Severity.ERROR,)
    return int(any(report.has(severity) for report in reports for severity in failing))


def _codes(texts: Iterable[str]) -> set[Code]:
    """Codes of an option; several may stand in one text, parted by commas."""
    return {Code(explain(part)[2:8]) for text in texts for part in text.split(",")}


def _check(file: str, options: argparse.Namespace) -> _Report:
    model, deep = None, None
    try:
        model = load_model(argparse.Namespace(file=file, param=options.param, search_path=options.search_path))
        if not missing_parameters(model.typed, model.parameters):
            _ = model.mld  # lowering finds the mistakes that need numbers
            deep = _deep(model, options) if options.deep else None
    except CompileError as error:
        earlier = () if model is None else model.diagnostics
        return _Report(error.source, None, tuple(dict.fromkeys((*earlier, *error.diagnostics))))
    if deep is None:
        return _Report(model.typed.source, model, model.diagnostics, None)
    return _Report(model.typed.source, model, deep.beside(model.diagnostics), deep)


def _deep(model: Model, options: argparse.Namespace) -> WellPosedness:
    from hysdel_py.analysis.well_posed import well_posed  # the check alone needs none of the analyses

    with watched(options.format == "text", f"{model.name}: search {{}}") as progress:
        return well_posed(model, seconds=seconds_of(options), progress=progress)


def _chosen(report: _Report, raised: set[Code], ignored: set[Code]) -> _Report:
    """The report with the severities that the options ask for."""
    kept = (d for d in report.diagnostics if d.severity is Severity.ERROR or d.code not in ignored)
    return replace(
        report,
        diagnostics=tuple(
            replace(d, severity=Severity.WARNING) if d.severity is Severity.NOTE and d.code in raised else d
            for d in kept
        ),
    )


def _print_text(reports: list[_Report]) -> None:
    for report in reports:
        shown = [d for d in report.diagnostics if d.severity is not Severity.NOTE]
        if shown:
            end = "" if report.model is None and len(reports) == 1 else "\n"
            text = "\n".join(render(d, report.source) for d in shown)
            print(painted(text, sys.stderr), end=end, file=sys.stderr)
        if report.model is not None:
            print(_sentence(report, report.model))
            print("".join(f"not settled: {question}\n" for question in _unsettled(report)), end="")
        elif len(reports) > 1:
            errors = (
                len(report.diagnostics) - report.warnings - sum(d.severity is Severity.NOTE for d in report.diagnostics)
            )
            print(f"{report.source.name}: {errors} mistake{'s' * (errors != 1)} found")


def _print_json(reports: list[_Report]) -> None:
    """One object for one file, a list of them for several."""
    found = [_summary(report) | {"diagnostics": [as_data(d, report.source) for d in report.diagnostics]}
             for report in reports]  # fmt: skip
    print_json(found[0] if len(found) == 1 else found)


def _unsettled(report: _Report) -> tuple[str, ...]:
    """What the search of --deep left open."""
    return report.deep.unsettled if report.deep is not None else ()


def _deep_data(report: _Report) -> dict[str, Any]:
    """Points that show what --deep found, and what it left open."""
    if report.deep is None:
        return {}
    found = [
        {"code": f.diagnostic.code.value, "message": f.diagnostic.message,
         "point": None if f.point is None else f.point.as_data()}
        for f in report.deep.findings
    ]  # fmt: skip
    return {"deep": {"findings": found, "unsettled": list(report.deep.unsettled)}}


def _print_sarif(reports: list[_Report]) -> None:
    print_json(as_sarif([(report.source, d) for report in reports for d in report.diagnostics], __version__))


def _missing(model: Model) -> list[str]:
    return [symbol.name for symbol in missing_parameters(model.typed, model.parameters)]


def _summary(report: _Report) -> dict[str, Any]:
    model = report.model
    if model is None:
        return {"file": report.source.name, "error": "the model has mistakes"}
    missing = _missing(model)
    sizes = {} if missing else {f"n{key}": getattr(model.mld, f"n{key}") for key in ("x", "u", "y", "d", "z", "e")}
    named = {"name": model.name, "file": report.source.name, "missing_parameters": missing}
    return named | sizes | _deep_data(report)


def _sentence(report: _Report, model: Model) -> str:
    warnings, missing = report.warnings, _missing(model)
    counted = f", {warnings} warning{'s' * (warnings != 1)}" if warnings else ""
    if missing:
        return f"{report.source.name}: no mistakes found{counted}; parameters without a value: {', '.join(missing)}"
    m = model.mld
    return (
        f"{report.source.name}: no mistakes found{counted}; {m.nx} states, {m.nu} inputs, {m.ny} outputs, "
        f"{m.nd} Boolean and {m.nz} real auxiliaries, {m.ne} rows"
    )
