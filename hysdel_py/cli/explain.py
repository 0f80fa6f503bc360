"""``hysdel explain``: what a diagnostic means and what to do."""

from __future__ import annotations

import argparse

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.explain import explain, title

__all__ = ["add_parser"]


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "explain",
        description="Print the page of a diagnostic, with an example; without a code, list all of them.",
    )
    parser.add_argument("code", metavar="CODE", nargs="?", help="such as HYS302, or only 302")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    if options.code is None:
        print("\n".join(f"{code.value}  {title(code)}" for code in Code))
    else:
        print(explain(options.code), end="")
    return 0
