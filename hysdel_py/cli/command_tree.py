"""The command line as data: commands with their options, for completions and the manual."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

__all__ = ["Command", "Option", "command_tree"]

_FILES = ("FILE", "PATH", "CSV", "CASE", "RUN", "OLD", "NEW")


@dataclass(frozen=True, slots=True)
class Option:
    """An option or a positional argument.

    Attributes
    ----------
    flags : tuple of str
        Empty for a positional argument.
    metavar : str
        Word for its value, empty without one.
    help : str
    choices : tuple of str
    """

    flags: tuple[str, ...]
    metavar: str
    help: str
    choices: tuple[str, ...]

    @property
    def takes_file(self) -> bool:
        """Whether its value is a file."""
        return self.metavar.upper().split(".")[0] in _FILES

    @property
    def takes_folder(self) -> bool:
        """Whether its value is a folder."""
        return self.metavar.upper() == "FOLDER"


@dataclass(frozen=True, slots=True)
class Command:
    """A command.

    Attributes
    ----------
    name : str
    help : str
        One line.
    description, epilog : str
    options : tuple of Option
    """

    name: str
    help: str
    description: str
    epilog: str
    options: tuple[Option, ...]

    @property
    def flags(self) -> tuple[str, ...]:
        """All flags of its options."""
        return tuple(flag for option in self.options for flag in option.flags)

    @property
    def positional(self) -> tuple[Option, ...]:
        """Its arguments without a flag."""
        return tuple(option for option in self.options if not option.flags)


def command_tree(parser: argparse.ArgumentParser) -> tuple[Command, tuple[Command, ...]]:
    """The command itself and its subcommands, in the order of the help."""
    group = next(action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    helps = {action.dest: action.help or "" for action in group._choices_actions}
    own = _command(parser.prog, "", parser)
    return own, tuple(_command(name, helps.get(name, ""), one) for name, one in group.choices.items())


def _command(name: str, text: str, parser: argparse.ArgumentParser) -> Command:
    options = [
        _option(action, parser) for action in parser._actions if not isinstance(action, argparse._SubParsersAction)
    ]
    return Command(name, text, parser.description or "", parser.epilog or "", tuple(options))


def _option(action: argparse.Action, parser: argparse.ArgumentParser) -> Option:
    metavar = "" if action.nargs == 0 else _metavar(action)
    text = parser._get_formatter()._expand_help(action) if action.help else ""
    return Option(tuple(action.option_strings), metavar, text, tuple(map(str, action.choices or ())))


def _metavar(action: argparse.Action) -> str:
    if isinstance(action.metavar, str):
        return action.metavar
    return "|".join(map(str, action.choices)) if action.choices else action.dest.upper()
