"""``hysdel manual``: the manual page of the command, written from the command line itself."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from hysdel_py.cli.command_tree import Command, Option, command_tree
from hysdel_py.version import __version__

__all__ = ["add_parser", "manual_page"]

_EPILOG = """\
examples:
  hysdel manual > hysdel.1 && man ./hysdel.1
  hysdel manual | man -l -
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "manual",
        description="Print the manual page, section 1, for man.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:  # noqa: ARG001 -- all commands are called alike
    """Run the command."""
    from hysdel_py.cli.main import build_parser

    print(manual_page(*command_tree(build_parser())), end="")
    return 0


def manual_page(root: Command, commands: tuple[Command, ...]) -> str:
    """The page in the language of man(7)."""
    lines = [f'.TH HYSDEL 1 "" "hysdel_py {__version__}"', ".ad l", ".SH NAME",
             f"hysdel \\- {_text(_first(root.description))}",
             ".SH SYNOPSIS", ".B hysdel", ".I COMMAND", "[options]", ".SH COMMANDS"]  # fmt: skip
    for command in commands:
        lines += [".TP", f".B {_text(command.name)}", _text(command.help)]
    for command in commands:
        lines += [f".SH HYSDEL {_text(command.name.upper())}", *_verbatim(command.description)]
        for option in command.options:
            lines += _option(option)
        lines += _verbatim(command.epilog)
    return "\n".join([*lines, ".SH NOTES", *_verbatim(root.epilog)]) + "\n"


def _first(text: str) -> str:
    return text.strip().rstrip(".").split(". ")[0]


def _option(option: Option) -> Iterator[str]:
    names = ", ".join(f"\\fB{_text(flag)}\\fR" for flag in option.flags)
    breakable = _text(option.metavar).replace("|", "|\\:") if option.metavar else ""
    value = f"\\fI{breakable}\\fR" if option.metavar else ""
    yield ".TP"
    yield f"{names} {value}".strip()
    yield _text(" ".join(option.help.split()))


def _verbatim(text: str) -> Iterator[str]:
    """Lines as they stand."""
    if text.strip():
        yield ".PP"
        yield ".nf"
        yield from (_text(line) for line in text.rstrip().split("\n"))
        yield ".fi"


def _text(text: str) -> str:
    """A line that holds no request: no leading dot or quote, no backslash, hyphens that can be copied."""
    plain = text.replace("\\", "\\e").replace("-", "\\-")
    return f"\\&{plain}" if plain[:1] in (".", "'") else plain
