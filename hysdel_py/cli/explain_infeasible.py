"""``hysdel explain-infeasible``: why no sequence of inputs works."""

from __future__ import annotations

import argparse

from hysdel_py.analysis.contradiction import Verdict
from hysdel_py.cli.arguments import add_model, add_output, add_start, assignments, given_vector, load_model
from hysdel_py.cli.controller import limits_of
from hysdel_py.cli.native import native_output_on_stderr
from hysdel_py.cli.output import print_json
from hysdel_py.cli.watch import watched
from hysdel_py.control.limits import Limits
from hysdel_py.model import Model
from hysdel_py.reports.explain_infeasible import explain_infeasible
from hysdel_py.reports.explanation import Explanation

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel explain-infeasible two_tanks --x0 0.5,0.55 -N 4 --input q=2e-4
  hysdel explain-infeasible clutch --param we_min=60 --x0 82.5,50,30,60,0 -N 5 --limit y1=80.3:

An input that is not given by --input is free within its range. The exit status is 0 if there is a sequence of inputs
(which is printed), 1 if there is none, and 4 if the search ended without an answer.
"""

NOT_SETTLED = 4


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "explain-infeasible",
        description="Find the smallest set of source items and time steps that contradict each other, or an input "
        "sequence that works.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_start(parser)
    parser.add_argument("-N", "--horizon", type=int, required=True, metavar="N", help="number of steps")
    parser.add_argument(
        "--limit",
        metavar="NAME=LOW:HIGH",
        action="append",
        default=[],
        help="limit of an output, state or input; an end may be left out",
    )
    parser.add_argument(
        "--input", metavar="NAME=VALUE", action="append", default=[], help="an input that is given and stays"
    )
    parser.add_argument("--seconds", type=float, default=60.0, metavar="T", help="time limit (default 60)")
    add_output(parser, "the answer")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status says whether there is a sequence of inputs."""
    model = load_model(options)
    start = given_vector(options.x0, model.dha.x, "--x0", "state")
    limits, inputs = _limits(model, options), assignments(options.input, "--input")
    with watched(not options.json) as progress, native_output_on_stderr():
        explanation = explain_infeasible(
            model, start, options.horizon, limits=limits, inputs=inputs, seconds=options.seconds, progress=progress
        )
    if options.json:
        print_json(explanation.to_dict())
    else:
        print(explanation, end="")
    return _status(explanation)


def _limits(model: Model, options: argparse.Namespace) -> Limits | None:
    return Limits(**limits_of(model.mld, options.limit)) if options.limit else None


def _status(explanation: Explanation) -> int:
    if explanation.feasible:
        return 0
    return NOT_SETTLED if explanation.finding.verdict is Verdict.NOT_SETTLED else 1
