"""The cell magic ``%%hysdel``: a cell of a notebook is a model.

``%load_ext hysdel_py`` makes it known.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from typing import TYPE_CHECKING, Any, NoReturn

from hysdel_py.cli.arguments import parameter_values
from hysdel_py.diagnostics.diagnostic import Severity
from hysdel_py.diagnostics.render import render
from hysdel_py.errors import ArgumentError, CompileError
from hysdel_py.markup.elements import element, fragment
from hysdel_py.model import load

if TYPE_CHECKING:
    from hysdel_py.model import Model

__all__ = ["HtmlAndText", "compile_cell", "register"]


class HtmlAndText:
    """What is shown of a cell: HTML where it can be, text elsewhere."""

    def __init__(self, html: str, text: str) -> None:
        self._html, self._text = html, text

    def _repr_html_(self) -> str:
        return self._html

    def __repr__(self) -> str:
        return self._text


class _Parser(argparse.ArgumentParser):
    """A parser that raises instead of ending the process."""

    def error(self, message: str) -> NoReturn:
        raise ArgumentError(f"%%hysdel: {message}; as in %%hysdel tank --param ts=0.1")


def _parser() -> _Parser:
    parser = _Parser(prog="%%hysdel", add_help=False)
    parser.add_argument("name", nargs="?", default="model")
    parser.add_argument("--param", action="append", default=[])
    parser.add_argument("-I", "--search-path", action="append", default=[])
    return parser


def compile_cell(line: str, cell: str) -> tuple[str, Model]:
    """The variable that a cell names and the model that it holds.

    Parameters
    ----------
    line : str
        What stands behind ``%%hysdel``: a name (``model`` by default), ``--param NAME=VALUE``, ``-I FOLDER``.
    cell : str
        The text of the model.

    Raises
    ------
    ArgumentError
        Wrong options.
    CompileError
    """
    options = _parser().parse_args(shlex.split(line))
    if not options.name.isidentifier():
        raise ArgumentError(f"%%hysdel {options.name}: the name of a variable was expected")
    values: dict[str, Any] = parameter_values(options.param, "--param")
    model = load(cell, search_path=options.search_path, **values)
    return options.name, model


def register(shell: Any) -> None:
    """Make the magic known to an IPython shell."""

    def hysdel(line: str, cell: str) -> HtmlAndText | None:
        """Compile the cell to a model; see hysdel_py.notebook.magic."""
        try:
            name, model = compile_cell(line, cell)
        except (ArgumentError, CompileError) as error:
            _refuse(error)
        shell.user_ns[name] = model
        return _remarks(model)

    shell.register_magic_function(hysdel, magic_kind="cell", magic_name="hysdel")


def _refuse(error: ArgumentError | CompileError) -> NoReturn:
    """End the cell with what is wrong in it, without a trace through our code."""
    from IPython.core.error import UsageError

    if isinstance(error, CompileError):
        print(error, file=sys.stderr, end="")
        count = sum(d.severity is Severity.ERROR for d in error.diagnostics)
        raise UsageError(f"%%hysdel: {count} mistake{'s' * (count != 1)} in the model above") from None
    raise UsageError(str(error)) from None


def _remarks(model: Model) -> HtmlAndText | None:
    """Warnings and notes, where there are any."""
    found = [render(d, model.typed.source) for d in model.diagnostics]
    if not found:
        return None
    return HtmlAndText(fragment([element("pre", text) for text in found]), "\n".join(found).rstrip())
