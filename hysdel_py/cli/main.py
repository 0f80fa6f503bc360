"""The command ``hysdel``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from hysdel_py.cli import check, compile, demo, mpc, simulate
from hysdel_py.errors import CompileError, HysdelError
from hysdel_py.version import __version__

__all__ = ["build_parser", "main"]

_DESCRIPTION = "Compile, simulate and control hybrid systems that are written in .hys files."
_EPILOG = """\
examples:
  hysdel demo clutch                        engage a dry clutch by hybrid predictive control; writes a picture
  hysdel check model.hys                    find mistakes
  hysdel compile model.hys -o model.json    write the MLD matrices
  hysdel simulate model.hys --x0 0.5 --steps 20
  hysdel mpc clutch --help                  control a model in a loop

A shipped model can be named without a path: clutch, two_tanks, two_rooms.
exit status: 0 fine, 1 the model or the data has a mistake, 2 wrong usage, 3 a fault of this program
"""


def build_parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    parser = argparse.ArgumentParser(
        prog="hysdel",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"hysdel_py {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for command in (check, compile, simulate, mpc, demo):
        command.add_parser(commands)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    options = build_parser().parse_args(arguments)
    try:
        status: int = options.run(options)
    except CompileError as error:
        _report_compile_error(error, as_json=getattr(options, "json", False))
        return 1
    except HysdelError as error:
        return _report(str(error), as_json=getattr(options, "json", False))
    except OSError as error:
        return _report(f"{error.filename or 'file'}: {error.strerror or error}", as_json=getattr(options, "json", False))
    except BrokenPipeError:
        return 0
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 1
    except Exception as error:
        print(
            f"hysdel: internal fault, {type(error).__name__}: {error}\n"
            "This is a mistake of the program, not of the model. Please report it with the model and the command line.",
            file=sys.stderr,
        )
        return 3
    return status


def _report(message: str, *, as_json: bool) -> int:
    import json

    if as_json:
        print(json.dumps({"error": message}))
    print(f"hysdel: error: {message}", file=sys.stderr)
    return 1


def _report_compile_error(error: CompileError, *, as_json: bool) -> None:
    import json

    if as_json:
        print(json.dumps({"error": "the model has mistakes", "diagnostics": list(error.data)}))
    print(error, file=sys.stderr, end="")


if __name__ == "__main__":
    sys.exit(main())
