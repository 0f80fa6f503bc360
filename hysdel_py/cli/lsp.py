"""``hysdel lsp``: help for editors while a model is written."""

from __future__ import annotations

import argparse
import os
import sys

from hysdel_py.cli.data_error import DataError

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel lsp              started by an editor, which talks to it over standard input and output

docs/editors.md tells how to set up editors. Needs pygls: pip install 'hysdel-py[lsp]'
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "lsp",
        description="Serve diagnostics, names, completion and formatting to an editor by the language server protocol.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--stdio", action="store_true", help="talk over standard input and output, which is the default"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:  # noqa: ARG001 -- all commands are called alike
    """Run the command."""
    try:
        import pygls  # noqa: F401
    except ModuleNotFoundError as error:
        raise DataError("hysdel lsp needs pygls, which is not installed: pip install 'hysdel-py[lsp]'") from error
    from hysdel_py.lsp.server import create_server

    # The server closes what it writes to; the standard output itself has to stay open for whoever called.
    create_server().start_io(stdout=os.fdopen(os.dup(sys.stdout.fileno()), "wb"))
    return 0
