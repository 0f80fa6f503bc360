"""``hysdel drivetrain``: simulation methods for dry friction compared."""

from __future__ import annotations

import argparse
from pathlib import Path

from hysdel_py.cli.data_error import DataError
from hysdel_py.cli.output import print_json
from hysdel_py.cli.progress import clear_progress, progress_line
from hysdel_py.drivetrain.comparison import Comparison, Pair, Row, compare

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel drivetrain compare --quick                     about a minute, and more when kernels are compiled first
  hysdel drivetrain compare --case b --orders
  hysdel drivetrain compare --quick --json
  hysdel drivetrain compare --plot precision.png

The Dual-clutch has an engine, two clutches with different gears, a driveshaft that twists and a vehicle; both clutches
stick and slip in turn in 10 s. The first table has one line for each method and step:
  mean error    mean over time and over four speeds of the absolute difference to the exact solution [rad/s]
  time          processor time over that of the Switch Model with Euler steps of 1e-3 s; only ratios mean something
  events        changes between stick and slip that the method saw (case a has 18 or 19, case b 6)
  energy off    greatest energy that no work accounts for [J], of some 26 kJ
Names in capitals are methods with the options of the source document. The second table has mean differences between
two methods, and what the document prints for them; --orders adds the exponent of the error over the step.
What a method has to say about its run, such as torques that are not unique, stands behind its line.

A drivetrain of your own is described in Python: see docs/drivetrain.md.
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "drivetrain",
        description="Simulate one drivetrain with two dry clutches by every method, and compare errors and times.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("action", choices=["compare"], help="what to do")
    parser.add_argument("--case", choices=["a", "b"], default="a", help="history of the inputs (default a, the harder)")
    parser.add_argument("--quick", action="store_true", help="steps of 1e-3 s only, each method once")
    parser.add_argument("--orders", action="store_true", help="also fit orders of convergence")
    parser.add_argument("--plot", metavar="FILE", help="write a picture of error over time")
    parser.add_argument("--json", action="store_true", help="print the tables as JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    steps, repeats = ((1e-3,), 1) if options.quick else ((1e-3, 1e-4), 2)
    progress = progress_line(not options.json)
    found = compare(options.case, steps, orders=options.orders, repeats=repeats, progress=progress)
    clear_progress(progress)
    if options.json:
        print_json(found.to_dict())
    else:
        print("\n".join(_report(found)))
    if options.plot:
        _write_picture(found, Path(options.plot))
    return 0


def _report(found: Comparison) -> list[str]:
    lines = [f"Dual-clutch, case {found.case}, 10 s", "", f"{'method':<34}{'step':>8}{'mean error':>12}{'time':>8}"]
    lines[-1] += f"{'events':>8}{'energy off [J]':>16}"
    lines += [_row_line(row) for row in found.rows]
    lines += ["", f"{'mean difference between':<58}{'step':>8}{'here':>10}  document"]
    lines += [_pair_line(pair) for pair in found.pairs]
    if found.orders:
        lines += ["", f"{'order of convergence':<34}"]
        lines += [f"{name:<34}{order:>8.2f}" for name, order in found.orders.items()]
    return lines


def _row_line(row: Row) -> str:
    step = "-" if row.dt is None else f"{row.dt:g}"
    note = f"  ({'; '.join(row.messages)})" if row.messages else ""
    return f"{row.method:<34}{step:>8}{row.error:>12.2e}{row.ratio:>8.2f}{row.events:>8}{row.imbalance:>16.1e}{note}"


def _pair_line(pair: Pair) -> str:
    return f"{pair.first + ' and ' + pair.second:<58}{pair.dt:>8g}{pair.difference:>10.1e}  {pair.printed}"


def _write_picture(found: Comparison, path: Path) -> None:
    try:
        from hysdel_py.plotting.drivetrain import plot_work_precision

        plot_work_precision(found).savefig(path)
    except ModuleNotFoundError:
        raise DataError("no picture: matplotlib is not installed (pip install matplotlib)") from None
