"""``hysdel report``: a model and a run of it as one page of HTML."""

from __future__ import annotations

import argparse
from pathlib import Path

from hysdel_py.cli.arguments import add_model, load_model
from hysdel_py.cli.data_error import DataError
from hysdel_py.cli.output import check_target
from hysdel_py.errors import ArgumentError
from hysdel_py.reports.page import html_report
from hysdel_py.reports.run_file import read_run
from hysdel_py.systems.summary import counted

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel report two_tanks -o two_tanks.html
  hysdel mpc two_tanks --x0 0.1,0.4 --horizon 6 --weight level2=10 --ref level2=0.3 --json > run.json
  hysdel report two_tanks run.json

The page holds everything it shows: it needs no network and opens from a folder.
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "report",
        description="Write one page of HTML: source beside its rows, signals, big-M constants, modes, and a run.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument(
        "run_file", metavar="RUN", nargs="?", help="a run of hysdel simulate, mpc or demo (.json or .csv)"
    )
    parser.add_argument("-o", "--output", metavar="PATH", help="the page (default: name of the model and .html)")
    parser.add_argument(
        "--max-modes", type=int, default=200, metavar="N", help="end the search for modes (default 200)"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    if options.max_modes < 1:
        raise ArgumentError(f"--max-modes {options.max_modes}: a number of at least 1 was expected")
    target = Path(options.output or f"{Path(options.file).stem}.html")
    check_target(target, "--output")
    model = load_model(options)
    recorded = None
    if options.run_file:
        try:
            recorded = read_run(options.run_file, {key: getattr(model.mld, key) for key in ("x", "u", "y", "d", "z")})
        except ArgumentError as error:
            raise DataError(str(error)) from None
    text = html_report(model, recorded, max_modes=options.max_modes)
    target.write_text(text, encoding="utf-8", newline="\n")
    shown = "" if recorded is None else f" and {counted(len(recorded.t), 'sample')} of a run"
    print(f"{target}: {counted(model.mld.ne, 'row')}{shown}")
    return 0
