"""``hysdel diff``: have two models the same steps?"""

from __future__ import annotations

import argparse

from hysdel_py.analysis.diff import diff
from hysdel_py.analysis.report import VerifyStatus
from hysdel_py.cli.arguments import add_output, add_parameters, load_model
from hysdel_py.cli.output import print_json
from hysdel_py.cli.proofs import NOT_SETTLED, add_margins, margins_of, seconds_of
from hysdel_py.cli.watch import watched
from hysdel_py.model import Model

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel diff old.hys new.hys
  hysdel diff old.hys new.hys --param ts=0.01 --json

Variables belong together by name; states, inputs and outputs that only one model has are differences.
exit status: 0 the models have the same steps, 1 they differ, 4 not settled within the limits
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "diff",
        description="Find a state and input at which two models differ in the next state, an output or what MUST\n"
        "allows, or show that there is none.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("old", metavar="OLD", help="a .hys file or a shipped model")
    parser.add_argument("new", metavar="NEW", help="another one")
    add_parameters(parser)
    add_margins(parser)
    add_output(parser, "the report")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    models = _loaded(options.old, options), _loaded(options.new, options)
    with watched(not options.json) as progress:
        report = diff(*models, margins=margins_of(options), seconds=seconds_of(options), progress=progress)
    if options.json:
        print_json(report.as_data())
    else:
        print(report)
    return {VerifyStatus.EQUAL: 0, VerifyStatus.DIFFERENT: 1, VerifyStatus.NOT_SETTLED: NOT_SETTLED}[report.status]


def _loaded(name: str, options: argparse.Namespace) -> Model:
    return load_model(argparse.Namespace(file=name, param=options.param, search_path=options.search_path))
