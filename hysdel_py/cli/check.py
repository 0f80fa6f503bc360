"""``hysdel check``: find mistakes."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.output import print_json
from hysdel_py.diagnostics.diagnostic import Severity
from hysdel_py.diagnostics.render import as_data, render
from hysdel_py.model import Model
from hysdel_py.semantics.parameters import missing_parameters

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel check model.hys
  hysdel check model.hys --param ts=0.01 --json

Parameters without a value do not fail the check; what can be checked without them is.
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "check",
        help="find mistakes in a model",
        description="Check a model and say what is wrong, where, and what to do about it.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_output(parser, "sizes and diagnostics")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    model = load_model(options)
    missing = [symbol.name for symbol in missing_parameters(model.typed, model.parameters)]
    if not missing:
        _ = model.mld  # lowering finds the mistakes that need numbers
    found = [d for d in model.diagnostics if d.severity is not Severity.NOTE]
    if options.json:
        source = model.typed.source
        print_json(_summary(model, missing) | {"diagnostics": [as_data(d, source) for d in model.diagnostics]})
        return 0
    for diagnostic in found:
        print(render(diagnostic, model.typed.source), file=sys.stderr)
    print(_sentence(model, missing, len(found)))
    return 0


def _summary(model: Model, missing: list[str]) -> dict[str, Any]:
    sizes = {} if missing else {f"n{key}": getattr(model.mld, f"n{key}") for key in ("x", "u", "y", "d", "z", "e")}
    return {"name": model.name, "file": model.typed.source.name, "missing_parameters": missing, **sizes}


def _sentence(model: Model, missing: list[str], warnings: int) -> str:
    counted = f", {warnings} warning{'s' * (warnings != 1)}" if warnings else ""
    if missing:
        return (
            f"{model.typed.source.name}: no mistakes found{counted}; parameters without a value: {', '.join(missing)}"
        )
    m = model.mld
    return (
        f"{model.typed.source.name}: no mistakes found{counted}; {m.nx} states, {m.nu} inputs, {m.ny} outputs, "
        f"{m.nd} Boolean and {m.nz} real auxiliaries, {m.ne} rows"
    )
