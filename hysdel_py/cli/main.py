"""The command ``hysdel``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Collection, Sequence
from time import perf_counter

from hysdel_py.cli.colour import painted
from hysdel_py.cli.commands import COMMANDS, add_commands
from hysdel_py.cli.drop_in_words import is_drop_in
from hysdel_py.cli.negative_values import join_negative_values
from hysdel_py.cli.output import print_json
from hysdel_py.cli.progress import clear_progress, is_terminal, tell_of_plain_kernels, telling_of_compiling
from hysdel_py.cli.streams import forget_output, open_missing_streams
from hysdel_py.errors import ArgumentError, CompileError, HysdelError
from hysdel_py.version import __version__

__all__ = ["build_parser", "main"]

FINE, MISTAKE, USAGE, FAULT = 0, 1, 2, 3

_DESCRIPTION = "Compile, simulate and control hybrid systems that are written in .hys files."
_EPILOG = """\
examples:
  hysdel drivetrain compare                 simulation methods for dry friction, errors and times
  hysdel demo clutch                        engage a dry clutch by hybrid predictive control; writes a picture
  hysdel check model.hys                    find mistakes
  hysdel explain HYS302                     what a diagnostic means
  hysdel compile model.hys -o model.json    write the MLD matrices
  hysdel audit two_tanks                    big-M constants, and the ranges that make them large
  hysdel show two_tanks --form pwa          the modes of the piecewise affine form
  hysdel simulate two_tanks --x0 0.1,0.2 --input 1e-4,1
  hysdel verify model.hys                   show that the matrices have the steps of the model
  hysdel diff old.hys new.hys               where two models differ, with a point that shows it
  hysdel fmt model.hys                      bring it into the canonical layout
  hysdel mpc two_tanks --x0 0.1,0.4 --horizon 6 --weight level2=10 --ref level2=0.3
  hysdel explicit two_tanks --horizon 2 --weight level2=10,q=0.1 --ref level2=0.3 --out law.npz

Each command has its own help: hysdel simulate --help
A shipped model can be named without a path: clutch, two_tanks and others; hysdel check --help lists them.
exit status: 0 fine, 1 the model or the data has a mistake or a run ended early, 2 wrong usage,
3 a fault of this program, 4 not settled (verify, diff, explain-infeasible, reach, safety, observe)

The command line of HYSDEL 2.0.5 is understood as well: hysdel -i model.hys -m model -5; see docs/drop-in.md
"""


def build_parser(complete: Collection[str] = tuple(COMMANDS)) -> argparse.ArgumentParser:
    """The parser of the whole command line, or one that knows the options of some commands only."""
    parser = argparse.ArgumentParser(
        prog="hysdel",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="store_true", help="print the version and end")
    parser.add_argument("--verbose", action="store_true", help="with --version: those of Python and packages too")
    add_commands(parser, complete)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status.

    Wrong usage that is found while the arguments are read, and ``--help``, end by SystemExit, as usual.
    """
    open_missing_streams()
    try:
        try:
            return _run(sys.argv[1:] if arguments is None else arguments)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        forget_output()
        return FINE
    except OSError as error:  # what a command leaves to be written in the end, as on a full disk
        forget_output()
        print(f"hysdel: error: {error.filename or 'standard output'}: {error.strerror or error}", file=sys.stderr)
        return MISTAKE
    except KeyboardInterrupt:  # before a command runs: while those there are, or the arguments, are read
        print("interrupted", file=sys.stderr)
        return MISTAKE


def _run(arguments: Sequence[str]) -> int:
    if is_drop_in(arguments):
        return _run_drop_in(arguments)
    parser = build_parser(COMMANDS.keys() & set(arguments))
    options = _parse(parser, join_negative_values(arguments))
    if options.version:
        print(_versions() if options.verbose else f"hysdel_py {__version__}")
        return FINE
    if options.command is None:
        parser.print_help(sys.stderr)
        print("\nhysdel: error: a COMMAND was expected", file=sys.stderr)
        return USAGE
    return _guarded(options)


def _versions() -> str:
    from hysdel_py.cli.versions import all_versions

    return all_versions()


def _parse(parser: argparse.ArgumentParser, arguments: Sequence[str]) -> argparse.Namespace:
    """Read the arguments; who asked for JSON gets an object also where the usage is wrong."""
    try:
        return parser.parse_args(arguments)
    except SystemExit as stop:
        if stop.code:
            _suggest_command(arguments)
        if stop.code and "--json" in arguments:
            print_json({"error": "wrong usage; the message is on the error stream"})
        raise


def _suggest_command(arguments: Sequence[str]) -> None:
    """Name the command that was meant, where a word is nearly one."""
    from difflib import get_close_matches

    word = next((argument for argument in arguments if not argument.startswith("-")), "")
    close = [] if word in COMMANDS else get_close_matches(word, COMMANDS, n=1)
    if close:
        print(f"help: did you mean hysdel {close[0]}?", file=sys.stderr)


def _run_drop_in(arguments: Sequence[str]) -> int:
    """Run the command line of the original compiler, which ends with 1 whatever the fault."""
    from hysdel_py.cli import drop_in

    try:
        return drop_in.run(arguments)
    except BrokenPipeError:
        raise
    except Exception as error:
        _report_fault(error, argparse.Namespace())
        return MISTAKE


def _guarded(options: argparse.Namespace) -> int:
    """Run a command; every error becomes a message and an exit status."""
    status, begin = MISTAKE, perf_counter()
    try:
        with telling_of_compiling():
            status = options.run(options)
        if getattr(options, "compiles", False):
            tell_of_plain_kernels(perf_counter() - begin)
    except BrokenPipeError:
        raise
    except CompileError as error:
        _report_compile_error(error, options)
    except ArgumentError as error:
        _report(str(error), options)
        print(f"help: hysdel {options.command} --help", file=sys.stderr)
        status = USAGE
    except HysdelError as error:
        _report(str(error), options)
    except OSError as error:
        _report(f"{error.filename or 'file'}: {error.strerror or error}", options)
    except KeyboardInterrupt:
        clear_progress(is_terminal() or None)
        print("interrupted", file=sys.stderr)
    except Exception as error:
        _report_fault(error, options)
        status = FAULT
    return status


def _report_fault(error: Exception, options: argparse.Namespace) -> None:
    if getattr(options, "json", False):
        print_json({"error": f"internal fault, {type(error).__name__}: {error}"})
    print(
        f"hysdel: internal fault, {type(error).__name__}: {error} ({_place(error)})\n"
        "This is a mistake of the program, not of the model. Please report it with the model, the command line and\n"
        "the output of: hysdel --version --verbose",
        file=sys.stderr,
    )


def _place(error: Exception) -> str:
    """Where an error was raised, for the report of a fault."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return "place unknown" if trace is None else f"{trace.tb_frame.f_globals.get('__name__')}, line {trace.tb_lineno}"


def _report(message: str, options: argparse.Namespace) -> None:
    if getattr(options, "json", False):
        print_json({"error": message})
    print(f"hysdel {options.command}: error: {message}", file=sys.stderr)


def _report_compile_error(error: CompileError, options: argparse.Namespace) -> None:
    if getattr(options, "json", False):
        print_json({"error": "the model has mistakes", "diagnostics": list(error.data)})
    print(painted(str(error), sys.stderr), file=sys.stderr, end="")


if __name__ == "__main__":
    sys.exit(main())
