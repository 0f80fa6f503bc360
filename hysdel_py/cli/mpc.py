"""``hysdel mpc``: control a model in a loop."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from hysdel_py.cli.arguments import (
    add_model,
    add_output,
    add_start,
    given_vector,
    load_model,
)
from hysdel_py.cli.controller import add_demands, add_shape, all_limits, blocking_of, cost_of, references_of
from hysdel_py.cli.output import add_files, check_files, check_picture, emit_trajectory
from hysdel_py.cli.progress import clear_progress, progress_line
from hysdel_py.cli.tree import save_tree
from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.errors import Interrupted
from hysdel_py.model import Model
from hysdel_py.optimize.node_log import NodeLog

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel mpc two_tanks --x0 0.1,0.4 --horizon 6 --weight level2=10 --ref level2=0.3 --steps 30
  hysdel mpc clutch --param we_min=60 --x0 100,70,20,0,0 --horizon 5 --weight y1=1,y2=4,y3=4 --ref y1=100 \\
      --limit y1=80: --soft y1 --node-limit 50 --steps 70 --plot run.png

Weights, references and limits name outputs, states, inputs or auxiliaries of the model; hysdel compile FILE lists them.
A weighted signal without a reference follows 0. The plant of the loop is the model itself. The exit status is 1 if the
loop ended early. In the column "status", 0 stands for a plan that is proven optimal and 1 for one that may not be.
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "mpc",
        description="Run a hybrid model predictive controller on its own model.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_start(parser)
    parser.add_argument("--horizon", type=int, default=10, metavar="N", help="steps that are planned (default 10)")
    parser.add_argument("--steps", type=int, default=20, metavar="N", help="steps of the loop (default 20)")
    add_demands(parser)
    parser.add_argument("--backend", default="auto", help="solver of the quadratic programs: auto, dense, piqp or osqp")
    parser.add_argument("--time-limit", type=float, metavar="SECONDS", help="longest search per step (default none)")
    parser.add_argument("--node-limit", type=int, metavar="N", help="nodes of the branch and bound per step")
    parser.add_argument(
        "--on-failure", choices=["stop", "hold"], default="stop",
        help="when there is no plan: end the loop (default), or apply the last input again",
    )  # fmt: skip
    _add_shape(parser)
    _add_records(parser)
    add_files(parser)
    add_output(parser, "the trajectory")
    parser.set_defaults(run=run, compiles=True)


def _add_shape(parser: argparse.ArgumentParser) -> None:
    """Add what a plan may look like, and what happens without one."""
    add_shape(parser)
    parser.add_argument("--last-input", metavar="INPUT", default="", help="input before the first step, for changes")
    parser.add_argument(
        "--fallback", choices=["soft", "last_plan"],
        help="input when there is no plan: from softened limits, or the next one of the last plan",
    )  # fmt: skip


def _add_records(parser: argparse.ArgumentParser) -> None:
    """Add what can be written down about the answers."""
    parser.add_argument("--dump-problem", metavar="FILE", help="write the program of the first step, for hysdel solve")
    parser.add_argument("--node-log", metavar="FILE", help="write every node of every search as CSV")
    parser.add_argument("--tree", metavar="FILE", help="draw the largest search tree of the run (.svg, .png, .pdf)")
    parser.add_argument("--why", action="store_true", help="say on the error stream what holds the first plan")


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status is 1 if the loop ended early."""
    check_files(options)
    check_picture(options.tree, "--tree")
    model = load_model(options)
    log = NodeLog()
    controller = _controller(model, options, log)
    references = references_of(options)
    x0 = given_vector(options.x0, model.mld.x, "--x0", "state")
    last = given_vector(options.last_input, model.mld.u, "--last-input", "input") if _needs_last(options) else None
    _record_first(controller, options, x0, references, last)
    log.entries.clear()
    progress = progress_line(not options.json)
    try:
        trajectory = closed_loop(
            model, controller, x0, options.steps, references, on_failure=options.on_failure, progress=progress,
            last_input=last,
        )  # fmt: skip
    except Interrupted as stopped:  # what was computed is worth as much as that of a loop that ended early
        trajectory = stopped.partial
    finally:
        clear_progress(progress)
    if options.node_log:
        log.write(options.node_log)
    if options.tree:
        _draw_tree(controller, log, options.tree)
    emit_trajectory(trajectory, model, options)
    if trajectory.steps == options.steps:
        return 0
    print(_ended_early(trajectory.steps, options), file=sys.stderr)
    return 1


def _draw_tree(controller: HybridMpc, log: NodeLog, path: str) -> None:
    """Draw the search with the most nodes."""
    f = controller.formulation
    save_tree(log, [f.describe_variable(i) for i in range(f.layout.n)], path)


def _ended_early(steps: int, options: argparse.Namespace) -> str:
    hints = ["--soft NAME softens a limit"] * bool(options.limit)
    hints += ["--on-failure hold goes on with the last input"] * (options.on_failure == "stop" and steps > 0)
    return f"hysdel mpc: the loop ended after {steps} of {options.steps} steps{'; ' * bool(hints)}{', '.join(hints)}"


def _needs_last(options: argparse.Namespace) -> bool:
    return bool(options.weight_change or options.limit_change or options.last_input)


def _record_first(controller: HybridMpc, options: argparse.Namespace, x0: Any, references: Any, last: Any) -> None:
    """Write the program of the first step, and say what holds its plan."""
    if options.dump_problem:
        controller.dump_problem(options.dump_problem, x0, references, last_input=last)
    if options.why:
        move = controller.solve(x0, references, last_input=last)
        explained = move.case is not None and move.case.v is not None
        print(controller.why(move).describe() if explained else move.message, file=sys.stderr)
        controller.reset()


def _controller(model: Model, options: argparse.Namespace, log: NodeLog) -> HybridMpc:
    return HybridMpc(
        model,
        options.horizon,
        cost_of(model.mld, options),
        all_limits(model.mld, options),
        backend=options.backend,
        time_limit=options.time_limit,
        node_limit=options.node_limit,
        progress=log if options.node_log or options.tree else None,
        blocking=blocking_of(options),
        control_horizon=options.control_horizon,
        binary_horizon=options.binary_horizon,
        fallback=options.fallback,
    )
