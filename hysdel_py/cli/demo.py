"""``hysdel demo``: ready-made applications."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from hysdel_py.cli.demo_shifts import TITLES, run_shift_demo
from hysdel_py.cli.output import print_json
from hysdel_py.cli.progress import clear_progress, progress_line
from hysdel_py.demos.clutch import ClutchDemo, engage
from hysdel_py.demos.dynamic_programming import DpDemo, engage_by_dp
from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.methods import METHODS
from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel demo clutch
  hysdel demo clutch --horizon 5 --output results
  hysdel demo clutch --json
  hysdel demo dp
  hysdel demo dp --two-inputs
  hysdel demo upshift-23
  hysdel demo upshift-23 --controller ramps
  hysdel demo drive --output results
"""
_ENGINE_TORQUES = 8


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "demo",
        description="Run a ready-made application, print its figures, and write a picture and a table.\n"
        f"  {'clutch':<21}engage a dry clutch by hybrid model predictive control\n"
        f"  {'dp':<21}engage a dry clutch by numerical dynamic programming\n"
        + "\n".join(f"  {name:<21}{title}" for name, title in TITLES.items()),
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", choices=["clutch", "dp", *TITLES], help="which one")
    parser.add_argument("--horizon", type=int, default=10, metavar="N", help="clutch: steps planned (default 10)")
    parser.add_argument(
        "--backend", default="auto", help="clutch: solver of the quadratic programs: auto, dense, piqp or osqp"
    )
    parser.add_argument(
        "--hard", action="store_true", help="clutch: keep the engine-speed limit hard: the loop ends early"
    )
    parser.add_argument(
        "--grid", type=float, default=1.0, metavar="STEP", help="dp: distance of the nodes in rad/s (default 1)"
    )
    parser.add_argument(
        "--controller", choices=METHODS, default="hybrid",
        help="shifts: who runs it: the hybrid controllers, the same with fixed modes, or ramps (default hybrid)",
    )  # fmt: skip
    parser.add_argument("--two-inputs", action="store_true", help="dp: the engine torque is an input too")
    parser.add_argument(
        "--output", metavar="FOLDER", default="hysdel-demo", help="where the files go (default hysdel-demo)"
    )
    parser.add_argument("--json", action="store_true", help="print the figures as JSON and write no files")
    parser.set_defaults(run=run, compiles=True)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status is 1 if the clutch was not engaged."""
    _require_own_options(options)
    if options.name in TITLES:
        return run_shift_demo(options)
    folder = Path(options.output)
    if not options.json:
        folder.mkdir(parents=True, exist_ok=True)
    progress = progress_line(not options.json)
    result: ClutchDemo | DpDemo
    if options.name == "dp":
        torques = _ENGINE_TORQUES if options.two_inputs else 0
        result = engage_by_dp(options.grid, engine_torques=torques, progress=progress)
    else:
        result = engage(horizon=options.horizon, backend=options.backend, hard=options.hard, progress=progress)
    clear_progress(progress)
    trajectory = result.trajectory
    if options.json:
        print_json(result.figures() | {"trajectory": None if trajectory is None else trajectory.to_dict()})
    else:
        print(_report(result))
        print("\n".join(_write_files(result, trajectory, folder / options.name)))
    return 0 if result.engaged else 1


_OWN: dict[str, dict[str, object]] = {
    "clutch": {"horizon": 10, "backend": "auto", "hard": False},
    "dp": {"grid": 1.0, "two_inputs": False},
}


def _require_own_options(options: argparse.Namespace) -> None:
    """Refuse options of the other demo, which would change nothing."""
    if options.controller != "hybrid" and options.name not in SHIFTS:
        raise ArgumentError(f"--controller belongs to the shifts ({', '.join(SHIFTS)}), not to {options.name}")
    for name, defaults in _OWN.items():
        for option, default in defaults.items():
            if name != options.name and getattr(options, option) != default:
                raise ArgumentError(f"--{option.replace('_', '-')} belongs to the demo {name}, not to {options.name}")


def _report(result: ClutchDemo | DpDemo) -> str:
    messages: tuple[str, ...] = ()
    if isinstance(result, DpDemo):
        title, rows = "Engagement of a dry clutch by numerical dynamic programming", result.rows()
    else:
        title, rows = "Engagement of a dry clutch by hybrid model predictive control", result.table()
        messages = result.messages
    return "\n".join([title, *(f"  {text:<44} {value}" for text, value in rows), *messages])


def _write_files(result: ClutchDemo | DpDemo, trajectory: Trajectory | None, stem: Path) -> list[str]:
    written = []
    if trajectory is not None:
        written.append(stem.with_suffix(".csv"))
        written[0].write_text(trajectory.to_csv(), encoding="utf-8")
    try:
        figure = result.plot()
    except ModuleNotFoundError:
        missing = "no picture: matplotlib is not installed (pip install matplotlib)"
        return [*(f"wrote {path}" for path in written), missing]
    written.append(stem.with_suffix(".png"))
    figure.savefig(written[-1])
    return [f"wrote {path}" for path in written]
