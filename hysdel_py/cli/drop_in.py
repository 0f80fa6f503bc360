"""The command line of the original compiler: ``hysdel -i in.hys -m out -5``.

Exit status 0, or 1 for every mistake; the original's users look at nothing else.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from io import TextIOWrapper
from pathlib import Path

from hysdel_py import compiler
from hysdel_py.cli.drop_in_words import FLAGS, WITH_VALUE, joined_verbosity
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic, Severity
from hysdel_py.diagnostics.render import render
from hysdel_py.errors import ArgumentError, CompileError
from hysdel_py.export.compiled import Compiled, compile_model
from hysdel_py.export.matlab import MatlabOptions, matlab_text
from hysdel_py.export.simulator_matlab import function_name, simulator_text
from hysdel_py.lowering.constants import Constants
from hysdel_py.semantics.typed_model import TypedModel

__all__ = ["DropInOptions", "read_options", "run"]


@dataclass(frozen=True, slots=True)
class DropInOptions:
    """What the command line asks for; empty names mean the standard streams, or nothing for the simulator."""

    source: str = ""
    matlab: str = ""
    simulator: str = ""
    verbosity: str = "2"
    aux: bool = False
    affine: bool = False
    every_parameter: bool = False
    no_symbol_table: bool = False
    no_row_info: bool = False
    no_parameter_checks: bool = False
    maple: bool = False

    @property
    def constants(self) -> Constants:
        """Treatment of constant terms."""
        return Constants.AFFINE if self.affine else Constants.AUX if self.aux else Constants.FORBID

    @property
    def text(self) -> MatlabOptions:
        """What the files hold."""
        return MatlabOptions(not self.no_symbol_table, not self.no_row_info, not self.no_parameter_checks, self.maple)


def read_options(arguments: Sequence[str]) -> DropInOptions:
    """Options of a command line; words that belong to none are ignored, as the original does.

    Raises
    ------
    ArgumentError
        An option is unknown, given twice, or lacks its value.
    """
    found: dict[str, str | bool] = {}
    pending = list(arguments)
    while pending:
        word = pending.pop(0)
        if joined_verbosity(word):
            word, pending = "-v", [word[2:], *pending]
        name = FLAGS.get(word) or WITH_VALUE.get(word)
        if name is None and not word.startswith("-"):
            continue
        if name is None:
            raise ArgumentError(f"unknown option {word}: {', '.join([*WITH_VALUE, *FLAGS])} were expected")
        if name in found:
            raise ArgumentError(f"the option {word} is given twice")
        if word in WITH_VALUE and not pending:
            raise ArgumentError(f"the option {word} needs a value")
        found[name] = pending.pop(0) if word in WITH_VALUE else True
    if found.get("verbosity", "2") not in ("0", "1", "2", "3"):
        raise ArgumentError(f"-v {found['verbosity']}: 0, 1, 2 or 3 was expected")
    if found.get("matlab") and found["matlab"] == found.get("simulator"):
        raise ArgumentError(f"-m and -s both name {found['matlab']}: two names were expected")
    return _options(found)


def _options(found: Mapping[str, str | bool]) -> DropInOptions:
    options = DropInOptions()
    for name, value in found.items():
        options = replace(options, **{name: value})  # type: ignore[arg-type]  # the tables pair names and types
    return options


def run(arguments: Sequence[str]) -> int:
    """Run the command line; the exit status is 0, or 1 for any mistake, whose description goes to stderr.

    A file that could not be made is removed where an old one of its name exists, so that nobody takes that for the
    result. If only the simulator is refused, the MLD file is written all the same.
    """
    try:
        options = read_options(arguments)
    except ArgumentError as error:
        print(f"hysdel: error: {error}", file=sys.stderr)
        return 1
    try:
        return _compile(options)
    except CompileError as error:
        print(error, file=sys.stderr, end="")
    except OSError as error:
        print(f"hysdel: error: {error.filename or 'file'}: {error.strerror or error}", file=sys.stderr)
    return 1


def _compile(options: DropInOptions) -> int:
    targets = {name: _target(name) for name in (options.matlab, options.simulator) if name}
    try:
        compiled, warnings = _compiled(options)
        text = matlab_text(compiled, options.text)
        _report(warnings, compiled.typed, options)
        _write(text, targets.pop(options.matlab, None))
        if options.simulator:
            target = _target(options.simulator)
            _write(simulator_text(compiled, function_name(target.stem), options.text), target)
            targets.clear()
    finally:
        for target in targets.values():
            target.unlink(missing_ok=True)
    return 0


def _compiled(options: DropInOptions) -> tuple[Compiled, tuple[Diagnostic, ...]]:
    source = Path(options.source) if options.source else _standard_input()
    typed, values, found = compiler.analyse(source, {})
    compiled, more = compile_model(typed, values, options.constants, every=options.every_parameter)
    return compiled, (*found, *more)


def _standard_input() -> str:
    """Text of standard input; bytes that are not UTF-8 can only stand in comments and need not be readable."""
    if isinstance(sys.stdin, TextIOWrapper):
        sys.stdin.reconfigure(encoding="utf-8", errors="replace")
    return sys.stdin.read() + "\n"  # a text without a line end could be taken for the name of a file


def _target(name: str) -> Path:
    return Path(name if name.endswith(".m") else f"{name}.m")


def _write(text: str, target: Path | None) -> None:
    if target is None:
        sys.stdout.write(text)
    else:
        target.write_text(text, encoding="utf-8")


def _report(diagnostics: Sequence[Diagnostic], model: TypedModel, options: DropInOptions) -> None:
    """Warnings to stderr: none with ``-v 0``, not those about wide [min, max] with ``-v 1``."""
    hidden = {Code.LOOSE_TRIPLE} if options.verbosity == "1" else set()
    for diagnostic in diagnostics:
        if diagnostic.severity is Severity.WARNING and options.verbosity != "0" and diagnostic.code not in hidden:
            print(render(diagnostic, model.source), file=sys.stderr)
