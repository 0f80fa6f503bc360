"""``hysdel reach``: the states that can be reached, step by step."""

from __future__ import annotations

import argparse
from typing import Any

from hysdel_py.analysis.hybrid_set import HybridSet
from hysdel_py.analysis.reach import Reach, reach, reach_backward
from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.intervals import add_runs, intervals
from hysdel_py.cli.native import native_output_on_stderr
from hysdel_py.cli.output import PICTURES, check_picture, print_json
from hysdel_py.cli.progress import clear_progress, progress_line
from hysdel_py.cli.proofs import NOT_SETTLED
from hysdel_py.errors import ArgumentError
from hysdel_py.model import Model
from hysdel_py.reports.columns import aligned
from hysdel_py.reports.safety import can_reach
from hysdel_py.reports.safety_answer import SafetyAnswer, SafetyVerdict

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel reach two_tanks --x0 h1=0.1:0.2,h2=0.3 --steps 8
  hysdel reach two_tanks --x0 h1=0.1:0.2,h2=0.3 --input q=0 --steps 8 --plot sets.png
  hysdel reach two_tanks --x0 h1=0.1:0.2,h2=0.3 --steps 8 --sets boxes --unsafe 'h2 >= 0.5'
  hysdel reach two_tanks --x0 h2=0.5:0.6 --steps 5 --backward

With --backward, --x0 is the target, and the sets hold the states from which some inputs lead into it in so many steps.
With --unsafe a run into the condition is searched as well: exit status 1 if there is one, 4 if that is not settled.
"""

_STATUS = {SafetyVerdict.REACHABLE: 1, SafetyVerdict.UNREACHABLE: 0}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "reach",
        description="Sets of states after each step, from a set of states and under all inputs.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_runs(parser)
    parser.add_argument(
        "--sets", choices=["exact", "boxes", "octagons"], default="exact",
        help="the states themselves, or what encloses them (default exact)",
    )  # fmt: skip
    parser.add_argument(
        "--most", type=int, default=200, metavar="P",
        help="more pieces than this are replaced by one box around them (default 200)",
    )  # fmt: skip
    parser.add_argument("--backward", action="store_true", help="the states that can get into --x0")
    parser.add_argument("--unsafe", metavar="EXPR", help="search a run into this condition as well")
    parser.add_argument("--plot", metavar="PATH", help=f"draw the sets ({', '.join(PICTURES)}; needs matplotlib)")
    parser.add_argument("--axes", metavar="A,B", default="", help="states on the axes of --plot (default: the first)")
    add_output(parser, "the sets")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    if options.backward and options.unsafe is not None:
        raise ArgumentError("--unsafe asks for runs from --x0, which --backward takes for the target: give one of them")
    check_picture(options.plot, "--plot")
    model = load_model(options)
    found = _sets(model, options)
    answer = None if options.unsafe is None else _unsafe(model, options)
    if options.plot:
        from hysdel_py.plotting.reach import plot_reach

        plot_reach(found, tuple(name.strip() for name in options.axes.split(",") if name.strip())).savefig(options.plot)
    if options.json:
        print_json(_data(found) | ({} if answer is None else {"unsafe": answer.to_dict()}))
    else:
        print(_text(model, found, backward=options.backward))
        if answer is not None:
            print(f"\n{answer}", end="")
    return 0 if answer is None else _STATUS.get(answer.outcome, NOT_SETTLED)


def _sets(model: Model, options: argparse.Namespace) -> Reach:
    progress = progress_line(not options.json)
    compute = reach_backward if options.backward else reach
    found = compute(
        model,
        intervals(options.x0, "--x0"),
        options.steps,
        inputs=intervals(options.input, "--input"),
        sets=options.sets,
        most=options.most,
        progress=None if progress is None else lambda k, _: progress(k, options.steps),
    )
    clear_progress(progress)
    return found


def _unsafe(model: Model, options: argparse.Namespace) -> SafetyAnswer:
    with native_output_on_stderr():
        return can_reach(
            model,
            intervals(options.x0, "--x0"),
            options.unsafe,
            options.steps,
            inputs=intervals(options.input, "--input"),
        )


def _text(model: Model, found: Reach, *, backward: bool) -> str:
    """One line for each step: the number of pieces and the range of each state."""
    kind = "the states themselves" if found.is_exact else "sets that hold the states"
    names = [v.name for v in found.sets[0].x]
    rows = [["k", "pieces", *names], *(_row(k, states, names) for k, states in enumerate(found.sets))]
    what = "steps before the target" if backward else "steps"
    lines = [f"{model.name}: {kind} after k {what}"]
    lines += aligned(rows)
    lines += [
        f"step {k}: {loss:.0%} of a box that stands for the pieces is empty"
        for k, loss in enumerate(found.losses)
        if loss
    ]
    if found.settled_at is not None:
        lines.append(f"nothing new after step {found.settled_at}: the union of these sets is that of all times")
    if not found.is_complete:
        lines.append("interrupted: the sets end early")
    return "\n".join(lines)


def _row(k: int, states: HybridSet, names: list[str]) -> list[str]:
    ranges = states.ranges()
    return [str(k), str(len(states.pieces)), *(_ends(*ranges[name]) if ranges else "-" for name in names)]


def _ends(low: float, high: float) -> str:
    return f"{low + 0.0:.4g}" if f"{low:.4g}" == f"{high:.4g}" else f"{low + 0.0:.4g} .. {high + 0.0:.4g}"


def _data(found: Reach) -> dict[str, Any]:
    return {
        "states": [v.name for v in found.sets[0].x],
        "is_exact": found.is_exact,
        "losses": list(found.losses),
        "is_complete": found.is_complete,
        "settled_at": found.settled_at,
        "sets": [[_piece(states, i) for i in range(len(states.pieces))] for states in found.sets],
    }


def _piece(states: HybridSet, number: int) -> dict[str, Any]:
    piece = states.pieces[number]
    return {
        "booleans": [int(value) for value in piece.word],
        "A": piece.region.A.tolist(),
        "b": piece.region.b.tolist(),
        "mode": piece.mode,
        "parent": piece.parent,
    }
