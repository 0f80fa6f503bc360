"""``hysdel safety``: can a condition be reached, must it be? Also the queries that stand in a model."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from pathlib import Path

from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.intervals import add_runs, intervals
from hysdel_py.cli.native import native_output_on_stderr
from hysdel_py.cli.output import add_files, check_files, print_json
from hysdel_py.cli.proofs import NOT_SETTLED
from hysdel_py.cli.watch import watched_steps
from hysdel_py.errors import ArgumentError
from hysdel_py.model import Model
from hysdel_py.reports.queries import answer_queries
from hysdel_py.reports.safety import can_reach, must_reach
from hysdel_py.reports.safety_answer import SafetyAnswer, SafetyVerdict

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel safety model_with_queries.hys
  hysdel safety two_tanks --x0 h1=0:0.2,h2=0:0.2 --steps 20 --never 'h2 >= 0.55'
  hysdel safety two_tanks --x0 h1=0:0.2,h2=0:0.2 --steps 20 --always 'level1 <= 0.6'
  hysdel safety two_tanks --x0 h1=0.5 --input q=0 --steps 60 --eventually 'h1 <= 0.1'

Without a statement the QUERIES of the model are answered (docs/language.md). A condition is a Boolean expression of the
language over states, inputs, outputs, auxiliaries and parameters. Inputs are free at each step within what --input
allows. A run that shows the contrary is replayed by the simulator.

exit status: 0 the statements hold, 1 one does not, or there is no run, 4 not settled within the limits
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
        description="Search all runs from a set of states, under all inputs, for one that contradicts a statement.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_runs(parser, required=False)
    statement = parser.add_mutually_exclusive_group()
    statement.add_argument("--never", metavar="EXPR", help="the condition holds at none of the steps")
    statement.add_argument("--always", metavar="EXPR", help="it holds at all steps")
    statement.add_argument("--eventually", metavar="EXPR", help="each run meets it at some step")
    parser.add_argument(
        "--seconds", type=float, default=300.0, metavar="T", help="time limit of each search (default 300)"
    )
    add_files(parser)
    add_output(parser, "the answer")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status says whether the statement holds."""
    check_files(options)
    model = load_model(options)
    if not any((options.never, options.always, options.eventually)):
        return _answer_queries(model, options)
    if options.steps is None:
        raise ArgumentError("--steps is missing: a statement is judged within so many steps")
    query, target = _query(options)
    with watched_steps(not options.json, options.steps) as progress, native_output_on_stderr():
        answer = query(
            model,
            intervals(options.x0, "--x0"),
            target,
            options.steps,
            inputs=intervals(options.input, "--input"),
            seconds=options.seconds,
            progress=progress,
        )
    _write_run(answer, options)
    if options.json:
        print_json(answer.to_dict())
    else:
        print(answer, end="")
    return _HOLDS[answer.outcome]


def _answer_queries(model: Model, options: argparse.Namespace) -> int:
    """The queries of the model, one after the other."""
    wrong = [name for name in ("steps", "x0", "csv", "plot") if getattr(options, name)]
    if wrong:
        raise ArgumentError(f"--{wrong[0]} goes with --never, --always or --eventually: a query says it itself")
    if not model.typed.queries:
        raise ArgumentError(
            f"{model.name} has no QUERIES: give --never, --always or --eventually, or write queries into the model "
            "(docs/language.md)"
        )
    with watched_steps(not options.json, len(model.typed.queries)) as progress, native_output_on_stderr():
        answers = answer_queries(
            model, inputs=intervals(options.input, "--input"), seconds=options.seconds, progress=progress
        )
    if options.json:
        print_json([answer.to_dict() for answer in answers])
    else:
        print("\n".join(map(str, answers)), end="")
    return _worst(_HOLDS[answer.answer.outcome] for answer in answers)


def _worst(statuses: Iterable[int]) -> int:
    """One that does not hold counts more than one that is not settled."""
    found = set(statuses)
    return 1 if 1 in found else max(found)


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
