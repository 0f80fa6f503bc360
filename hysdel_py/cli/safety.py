"""``hysdel safety``: can a condition be reached, must it be?"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.intervals import add_runs, intervals
from hysdel_py.cli.native import native_output_on_stderr
from hysdel_py.cli.output import add_files, check_files, print_json
from hysdel_py.cli.progress import clear_progress, progress_line
from hysdel_py.cli.verify import NOT_SETTLED
from hysdel_py.reports.safety import can_reach, must_reach
from hysdel_py.reports.safety_answer import SafetyAnswer, SafetyVerdict

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel safety two_tanks --x0 h1=0:0.2,h2=0:0.2 --steps 20 --never 'h2 >= 0.55'
  hysdel safety two_tanks --x0 h1=0:0.2,h2=0:0.2 --steps 20 --always 'level1 <= 0.6'
  hysdel safety two_tanks --x0 h1=0.5 --input q=0 --steps 60 --eventually 'h1 <= 0.1'

A condition is a Boolean expression of the language over states, inputs, outputs, auxiliaries and parameters. Inputs are
free at each step within what --input allows. A run that shows the contrary is replayed by the simulator.

exit status: 0 the statement holds, 1 it does not, or there is no run, 4 not settled within the limits
"""

_HOLDS = {
    SafetyVerdict.UNREACHABLE: 0,
    SafetyVerdict.INEVITABLE: 0,
    SafetyVerdict.REACHABLE: 1,
    SafetyVerdict.AVOIDABLE: 1,
    SafetyVerdict.NO_RUN: 1,
    SafetyVerdict.NOT_SETTLED: NOT_SETTLED,
}

Query = Callable[..., SafetyAnswer]


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "safety",
        help="prove that a condition never holds, always holds or must come, or show a run",
        description="Search all runs from a set of states, under all inputs, for one that contradicts a statement.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_runs(parser)
    statement = parser.add_mutually_exclusive_group(required=True)
    statement.add_argument("--never", metavar="EXPR", help="the condition holds at none of the steps")
    statement.add_argument("--always", metavar="EXPR", help="it holds at all steps")
    statement.add_argument("--eventually", metavar="EXPR", help="each run meets it at some step")
    parser.add_argument("--seconds", type=float, default=300.0, metavar="T", help="time limit (default 300)")
    add_files(parser)
    add_output(parser, "the answer")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status says whether the statement holds."""
    check_files(options)
    model = load_model(options)
    query, target = _query(options)
    progress = progress_line(not options.json)
    with native_output_on_stderr():
        answer = query(
            model,
            intervals(options.x0, "--x0"),
            target,
            options.steps,
            inputs=intervals(options.input, "--input"),
            seconds=options.seconds,
            progress=None if progress is None else lambda k, _: progress(k, options.steps),
        )
    clear_progress(progress)
    _write_run(answer, options)
    if options.json:
        print_json(answer.to_dict())
    else:
        print(answer, end="")
    return _HOLDS[answer.outcome]


def _query(options: argparse.Namespace) -> tuple[Query, str]:
    if options.eventually is not None:
        return must_reach, options.eventually
    return can_reach, options.never if options.never is not None else f"~({options.always})"


def _write_run(answer: SafetyAnswer, options: argparse.Namespace) -> None:
    """Files of the run, where there is one."""
    if answer.run is None:
        return
    if options.csv:
        Path(options.csv).write_text(answer.run.to_csv(), encoding="utf-8")
    if options.plot:
        answer.run.plot().savefig(options.plot)
