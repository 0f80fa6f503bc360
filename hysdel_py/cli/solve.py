"""``hysdel solve``: solve a mixed-integer program that a controller wrote down."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from hysdel_py.cli.arguments import add_output
from hysdel_py.cli.interrupt import Interruption, first_interrupt
from hysdel_py.cli.output import check_picture, print_json
from hysdel_py.cli.progress import clear_progress, counter
from hysdel_py.cli.tree import save_tree
from hysdel_py.optimize.case_file import CaseFile, read_case
from hysdel_py.optimize.miqp import MiqpResult, MiqpSettings, MiqpStatus
from hysdel_py.optimize.mixed_integer import SearchInfo
from hysdel_py.optimize.node_log import NodeLog

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel mpc two_tanks --x0 0.1,0.4 --horizon 6 --weight level2=10 --ref level2=0.3 --dump-problem case.json
  hysdel solve case.json

The exit status is 0 if the program is solved, also where it is proven to have no solution, and 1 otherwise.
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "solve",
        description="Solve a mixed-integer program from a file, with the settings of the file or others.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="CASE", help="a JSON file of --dump-problem or HybridMpc.dump_problem")
    parser.add_argument("--backend", help="solver of the quadratic programs: auto, dense, piqp or osqp")
    parser.add_argument("--time-limit", type=float, metavar="SECONDS", help="longest search")
    parser.add_argument("--node-limit", type=int, metavar="N", help="nodes of the search")
    parser.add_argument("--gap", type=float, metavar="NUMBER", help="relative gap at which the search ends")
    parser.add_argument("--node-log", metavar="FILE", help="write every node of the search as CSV")
    parser.add_argument("--tree", metavar="FILE", help="draw the search tree (.svg, .png, .pdf)")
    add_output(parser, "the answer")
    parser.set_defaults(run=run, compiles=True)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    check_picture(options.tree, "--tree")
    case, log = read_case(options.file), NodeLog()
    show = counter(not options.json, "{} nodes, {} open, best {:.6g}, bound {:.6g}")
    with first_interrupt() as interruption:
        result = case.solve(_settings(case, options), progress=_watcher(log, show, interruption))
    clear_progress(show)
    if options.node_log:
        log.write(options.node_log)
    if options.tree:
        save_tree(log, [_name(case, i) for i in range(case.miqp.qp.n)], options.tree)
    if options.json:
        print_json(_data(case, result))
    else:
        print("\n".join(_lines(case, result)))
    return 0 if result.status in (MiqpStatus.OPTIMAL, MiqpStatus.INFEASIBLE) else 1


def _watcher(
    log: NodeLog, show: Callable[..., None] | None, interruption: Interruption
) -> Callable[[SearchInfo], bool]:
    """What is done after each node: keep it, show it, and end the search after Ctrl-C with what is known by then."""

    def watch(info: SearchInfo) -> bool:
        log(info)
        if show is not None:
            show(info.nodes, info.open, info.objective, info.bound)
        return not interruption.asked

    return watch


def _settings(case: CaseFile, options: argparse.Namespace) -> MiqpSettings:
    chosen: dict[str, Any] = {
        "backend": options.backend,
        "time_limit": options.time_limit,
        "node_limit": options.node_limit,
        "gap_rel": options.gap,
    }
    return replace(case.settings, **{name: value for name, value in chosen.items() if value is not None})


def _lines(case: CaseFile, result: MiqpResult) -> list[str]:
    qp = case.miqp.qp
    lines = [
        f"{qp.n} variables, {len(case.miqp.binaries)} of them binary, {qp.m} rows",
        f"{result.status.value}: {result.message}",
        f"objective {result.objective:.6g}",
        f"search: bound {result.bound:.9g}, gap {result.gap:.3g}, {result.nodes} nodes, "
        f"{result.qps} continuous programs, {1e3 * result.seconds:.1f} ms",
    ]
    if result.x is not None:
        lines += [f"  {_name(case, i)} = {value:.9g}" for i, value in enumerate(result.x)]
    return lines


def _name(case: CaseFile, i: int) -> str:
    return case.variables[i] if case.variables else f"x[{i}]"


def _data(case: CaseFile, result: MiqpResult) -> dict[str, Any]:
    numbers = {name: getattr(result, name) for name in ("objective", "bound", "gap", "nodes", "qps", "seconds")}
    finite = {name: value if np.isfinite(value) else None for name, value in numbers.items()}
    x = None if result.x is None else result.x.tolist()
    return {"status": result.status.value, "message": result.message, **finite, "variables": case.variables, "x": x}
