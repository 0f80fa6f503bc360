"""``hysdel observe``: do inputs and outputs tell the states and modes of a model?"""

from __future__ import annotations

import argparse

from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.intervals import add_runs, intervals
from hysdel_py.cli.native import native_output_on_stderr
from hysdel_py.cli.output import print_json
from hysdel_py.cli.proofs import NOT_SETTLED
from hysdel_py.cli.watch import watched
from hysdel_py.reports.observability import observability
from hysdel_py.reports.observability_answer import ObservabilityVerdict

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel observe two_tanks --steps 4
  hysdel observe two_tanks --steps 4 --of modes --apart 0.1
  hysdel observe two_tanks --steps 4 --of h1 --input q=0

Two runs under the same inputs are searched that differ at the start and have the same outputs. Both are replayed by the
simulator.

exit status: 0 the outputs tell them apart, 1 they do not, or there is no run, 4 not settled within the limits
"""

_STATUS = {
    ObservabilityVerdict.OBSERVABLE: 0,
    ObservabilityVerdict.INDISTINGUISHABLE: 1,
    ObservabilityVerdict.NO_RUN: 1,
    ObservabilityVerdict.NOT_SETTLED: NOT_SETTLED,
}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "observe",
        description="Search two runs that start apart and have the same inputs and outputs.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_runs(parser)
    parser.add_argument(
        "--of", metavar="WHAT", default="states",
        help="states, modes, or names of states or of Boolean auxiliaries, with commas (default states)",
    )  # fmt: skip
    parser.add_argument(
        "--apart", type=float, default=0.05, metavar="SHARE",
        help="by which share of its range a real state differs at least (default 0.05)",
    )  # fmt: skip
    parser.add_argument(
        "--resolution", type=float, default=1e-3, metavar="SHARE",
        help="real outputs that differ by no more than this share of their range are the same (default 0.001)",
    )  # fmt: skip
    parser.add_argument("--seconds", type=float, default=300.0, metavar="T", help="time limit (default 300)")
    add_output(parser, "the answer")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status says whether the states are observable."""
    model = load_model(options)
    of = (
        options.of
        if options.of in ("states", "modes")
        else tuple(n.strip() for n in options.of.split(",") if n.strip())
    )
    with watched(not options.json) as progress, native_output_on_stderr():
        answer = observability(
            model,
            options.steps,
            of=of,
            apart=options.apart,
            resolution=options.resolution,
            x0=intervals(options.x0, "--x0"),
            inputs=intervals(options.input, "--input"),
            seconds=options.seconds,
            progress=progress,
        )
    if options.json:
        print_json(answer.to_dict())
    else:
        print(answer, end="")
    return _STATUS[answer.outcome]
