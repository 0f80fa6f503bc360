"""``hysdel audit``: how large and how loose the big-M constants are, and why."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import Any

from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.output import print_json
from hysdel_py.diagnostics.render import render
from hysdel_py.errors import ArgumentError
from hysdel_py.lowering.audit import Audit, AuditRow
from hysdel_py.model import audit

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel audit model.hys
  hysdel audit model.hys --rows 5
  hysdel audit model.hys --json

A row of AD or DA that is switched off allows its form to be as large as its big-M constant. "interval" is the constant
by interval arithmetic, as HYSDEL 2.0.5 has it, "lp" the one by linear programs, which is used by default. "loose" is
their ratio, "condition" the largest over the smallest coefficient of the row. The loosest rows come first.
"""

_SHOWN = 20
_WORST_SCALED = 1e4


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "audit",
        description="Show the big-M constants of a model, how tight they are, and which ranges they come from.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument("--rows", type=int, metavar="N", default=_SHOWN, help=f"rows to show (default {_SHOWN})")
    add_output(parser, "all rows and findings")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    if options.rows < 0:
        raise ArgumentError(f"--rows {options.rows}: a number of at least 0 was expected")
    model = load_model(options)
    report = audit(model)
    if options.json:
        print_json(_data(report))
        return 0
    print("\n".join(_lines(report, options.rows)))
    for found in report.decided:
        print("\n" + render(found, model.typed.source), end="")
    return 0


def _lines(report: Audit, most: int) -> Iterator[str]:
    yield f"{report.name}: {report.summary}"
    if report.rows[:most]:
        yield f"{'row':>4} {'interval':>10} {'lp':>10} {'loose':>7} {'condition':>9}  where it comes from"
    for row in report.rows[:most]:
        numbers = f"{row.interval:>10.5g} {row.lp:>10.5g} {row.looseness:>7.3g} {row.condition:>9.3g}"
        yield f"{row.index:>4} {numbers}  {row.origin}"
        if row.advice:
            yield f"{'':>46}{row.advice}"
    if len(report.rows) > most:
        yield f"{len(report.rows) - most} more rows; --rows N shows more of them"
    yield from _findings(report)


def _findings(report: Audit) -> Iterator[str]:
    finest = min((row for row in report.rows if row.resolution), key=lambda r: r.resolution or 0.0, default=None)
    if finest is not None:
        gap = f"epsilon {finest.epsilon:g} beside a coefficient of {finest.largest:.4g}"
        yield f"finest threshold: {gap} in {finest.origin}"
    for scaling in report.scalings:
        v = scaling.variable
        if not v.is_bool and scaling.largest > _WORST_SCALED * scaling.smallest:
            yield f"coefficients of {v.name} lie between {scaling.smallest:.3g} and {scaling.largest:.3g}: scale it"
    if report.rows:
        yield "help: a tighter declared range of the variable named makes the constant of its row smaller"
    for name, kept in report.merged.items():
        yield f"{name} equals {kept}: share=True merges them"
    for removed in report.redundant:
        yield f"row {removed.index} follows from the others: {removed.origin}"


def _data(report: Audit) -> dict[str, Any]:
    return {
        "name": report.name,
        "summary": report.summary,
        "rows": [_row(row) for row in report.rows],
        "scalings": [{"name": s.variable.name, "largest": s.largest, "smallest": s.smallest} for s in report.scalings],
        "decided": [{"code": found.code.value, "message": found.message} for found in report.decided],
        "merged": dict(report.merged),
        "redundant": [removed.index for removed in report.redundant],
    }


def _row(row: AuditRow) -> dict[str, Any]:
    return {
        "row": row.index,
        "item": row.origin.item,
        "defines": row.origin.defines,
        "line": row.origin.line,
        "text": row.origin.text,
        "interval": row.interval,
        "lp": row.lp,
        "looseness": row.looseness,
        "condition": row.condition,
        "epsilon": row.epsilon,
        "sources": [
            {
                "name": s.variable.name,
                "size": s.size,
                "declared": s.declared.name,
                "line": s.declared.line,
                "low": s.declared.low,
                "high": s.declared.high,
            }
            for s in row.sources
        ],
        "advice": row.advice,
    }
