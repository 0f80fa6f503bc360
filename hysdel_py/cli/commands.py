"""The commands and what the help says of each, told without loading any of them.

A command's own module is loaded for a command line that names it, with all that it computes with.
"""

from __future__ import annotations

import argparse
from collections.abc import Collection
from importlib import import_module
from typing import Any

__all__ = ["COMMANDS", "add_commands"]

COMMANDS = {
    "check": "find mistakes in a model",
    "explain": "tell what a diagnostic means",
    "audit": "say which declared ranges make a model loose",
    "verify": "show that matrices and modes have the steps of the model",
    "diff": "find where two models differ",
    "compile": "translate a model to its mixed logical dynamical form",
    "show": "print a form of a model in words",
    "graph": "write or draw the graph of the modes",
    "report": "write a model and a run of it as a page of HTML",
    "simulate": "run a model under given inputs",
    "mpc": "control a model in a loop by hybrid model predictive control",
    "explicit": "work out the explicit law of a hybrid model predictive controller",
    "explain-infeasible": "say why no sequence of inputs keeps ranges, MUST and limits",
    "reach": "compute the states that can be reached, step by step",
    "safety": "prove that a condition never holds, always holds or must come, or show a run",
    "observe": "prove that outputs tell states or modes apart, or show two runs that they do not",
    "solve": "solve a program that hysdel mpc --dump-problem wrote",
    "demo": "run a ready-made application",
    "drivetrain": "compare simulation methods for dry friction",
    "fmt": "bring models into one layout",
    "stubs": "write the names of a model as Python types",
    "lsp": "language server for editors",
    "completion": "print the completion script of a shell",
    "manual": "print the manual page",
}
"""Commands in the order of the help, each with its line there."""


class _Commands(argparse._SubParsersAction):  # type: ignore[type-arg]  # generic for type checkers only
    """Commands whose lines in the help are those of the table."""

    def add_parser(self, name: str, **options: Any) -> Any:
        return super().add_parser(name, help=COMMANDS[name], **options)


def add_commands(parser: argparse.ArgumentParser, complete: Collection[str]) -> None:
    """Add all commands: the complete ones with their options, the others by their names."""
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", action=_Commands)
    for name in COMMANDS:
        if name in complete:
            import_module(f"hysdel_py.cli.{name.replace('-', '_')}").add_parser(commands)
        else:
            commands.add_parser(name)
