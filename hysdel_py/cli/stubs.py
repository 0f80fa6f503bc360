"""``hysdel stubs``: the names of a model for editors and type checkers."""

from __future__ import annotations

import argparse
from pathlib import Path

from hysdel_py.cli.arguments import add_model, load_model
from hysdel_py.cli.output import check_target
from hysdel_py.export.stubs import Field, stub_module
from hysdel_py.semantics.symbols import Role, Symbol
from hysdel_py.semantics.typed_model import TypedModel

__all__ = ["add_parser", "stubs_of"]

_EPILOG = """\
examples:
  hysdel stubs tank.hys -o tank_names.py
  hysdel stubs clutch                       print the module

In Python, from tank_names import TankState, TankParameters; a TankState is a vector whose numbers have names.
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "stubs",
        description="Write a Python module with the states, inputs, outputs and parameters of a model as types.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument("-o", "--output", metavar="PATH", help="write a .py or .pyi file instead of printing")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    if options.output:
        check_target(Path(options.output), "--output")
    text = stubs_of(load_model(options).typed)
    if options.output:
        Path(options.output).write_text(text, encoding="utf-8")
    else:
        print(text, end="")
    return 0


def stubs_of(model: TypedModel) -> str:
    """Text of the module for a model."""
    vectors = {
        role.name.capitalize(): [_field(symbol) for symbol in model.vector(role)]
        for role in (Role.STATE, Role.INPUT, Role.OUTPUT)
    }
    return stub_module(model.name or "model", vectors, [_field(symbol) for symbol in model.parameters])


def _field(symbol: Symbol) -> Field:
    return Field(symbol.name, not symbol.is_real, symbol.unit, symbol.description, required=symbol.value is None)
