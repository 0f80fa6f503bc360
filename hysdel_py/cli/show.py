"""``hysdel show``: print a form of a model in words."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.output import print_json
from hysdel_py.export.matrices import mld_to_dict
from hysdel_py.export.pwa_data import pwa_to_dict
from hysdel_py.model import Model

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel show clutch                  the items of the discrete hybrid automaton
  hysdel show clutch --form mld       equations and rows, each row under the source line it came from
  hysdel show clutch --form pwa       modes with their conditions and maps
"""

_FORMS: dict[str, tuple[Callable[[Model], str], Callable[[Model], Any]]] = {
    "dha": (lambda model: model.dha.describe(), lambda model: {"text": model.dha.describe()}),
    "mld": (lambda model: model.mld.describe(), lambda model: mld_to_dict(model.mld)),
    "pwa": (lambda model: model.pwa.describe(), lambda model: pwa_to_dict(model.pwa)),
}
"""For each form its text and its plain data."""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "show",
        description="Print what a model becomes, with the names of the source.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument("--form", choices=list(_FORMS), default="dha", help="which form is printed (default dha)")
    add_output(parser, "the form")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    text, data = _FORMS[options.form]
    model = load_model(options)
    if options.json:
        print_json(data(model))
    else:
        print(text(model), end="")
    return 0
