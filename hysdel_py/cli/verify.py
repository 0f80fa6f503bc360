"""``hysdel verify``: do the forms of a model agree?"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from hysdel_py.analysis.report import VerifyStatus
from hysdel_py.analysis.verify import verify
from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.data_error import DataError
from hysdel_py.cli.output import print_json
from hysdel_py.cli.proofs import NOT_SETTLED, add_margins, margins_of, seconds_of
from hysdel_py.cli.watch import watched
from hysdel_py.errors import ArgumentError
from hysdel_py.export.pwa_data import read_pwa_json
from hysdel_py.export.reading import read_mat, read_mld_json, read_npz
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.pwa import Pwa

__all__ = ["add_parser"]

T = TypeVar("T")

_READERS = {".json": read_mld_json, ".npz": read_npz, ".mat": read_mat}

_EPILOG = """\
examples:
  hysdel verify model.hys                       random points, then a proof for every row, equation and mode
  hysdel verify model.hys --forms mld           the matrices alone
  hysdel verify model.hys --mld by_hand.json    judge another MLD form of the same model
  hysdel verify model.hys --points 0 --seconds 60

exit status: 0 the forms are equal, 1 they differ, 4 not settled within the limits
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "verify",
        description="Show that the discrete hybrid automaton, which is the meaning of a model, its MLD form and its\n"
        "PWA form have the same steps, or find a state and input where they differ.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument(
        "--mld", metavar="FILE", help=f"the MLD form to judge ({', '.join(_READERS)}); default: its own"
    )
    parser.add_argument("--pwa", metavar="FILE", help="the PWA form to judge (.json); default: its own")
    parser.add_argument(
        "--forms", metavar="LIST", help="forms to judge: mld, pwa or mld,pwa (default: those given, else both)"
    )
    parser.add_argument("--points", type=int, default=200, metavar="N", help="random points (default 200)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of the random points (default 0)")
    add_margins(parser)
    add_output(parser, "the report")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    model = load_model(options)
    with watched(not options.json) as progress:
        report = verify(
            model,
            mld=_mld(options.mld) if options.mld else None,
            pwa=_pwa(options.pwa) if options.pwa else None,
            forms=None if options.forms is None else tuple(form.strip() for form in options.forms.split(",")),
            points=options.points,
            seed=options.seed,
            margins=margins_of(options),
            seconds=seconds_of(options),
            progress=progress,
        )
    if options.json:
        print_json(report.as_data())
    else:
        print(report)
    return {VerifyStatus.EQUAL: 0, VerifyStatus.DIFFERENT: 1, VerifyStatus.NOT_SETTLED: NOT_SETTLED}[report.status]


def _mld(name: str) -> Mld:
    reader = _READERS.get(Path(name).suffix.lower())
    if reader is None:
        raise ArgumentError(f"--mld {name}: a file that ends in {', '.join(_READERS)} was expected")
    return _read(reader, name)


def _pwa(name: str) -> Pwa:
    if Path(name).suffix.lower() != ".json":
        raise ArgumentError(f"--pwa {name}: a file that ends in .json was expected")
    return _read(read_pwa_json, name)


def _read(reader: Callable[[str], T], name: str) -> T:
    """Read a file; a fault of its contents is one of the data, not of the usage."""
    try:
        return reader(name)
    except ArgumentError as error:
        text = str(error)
        raise DataError(text if name in text else f"{name}: {text}") from None
