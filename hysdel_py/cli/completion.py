"""``hysdel completion``: what a shell needs to complete the command line."""

from __future__ import annotations

import argparse

from hysdel_py.cli.command_tree import command_tree
from hysdel_py.cli.completion_scripts import SHELLS
from hysdel_py.shipped import shipped_models

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel completion bash > ~/.local/share/bash-completion/completions/hysdel
  hysdel completion zsh > ~/.zfunc/_hysdel
  hysdel completion fish > ~/.config/fish/completions/hysdel.fish

The zsh file belongs into a folder of fpath. For bash of this moment: source <(hysdel completion bash)
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "completion",
        description="Print a script that lets a shell complete commands, options, models and files.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("shell", choices=list(SHELLS), help="which shell")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    from hysdel_py.cli.main import build_parser

    root, commands = command_tree(build_parser())
    print(SHELLS[options.shell](root, commands, list(shipped_models())), end="")
    return 0
