"""``hysdel demo``: ready-made applications."""

from __future__ import annotations

import argparse
from pathlib import Path

from hysdel_py.cli.output import clear_progress, print_json, progress_line
from hysdel_py.demos.clutch import ClutchDemo, engage

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel demo clutch
  hysdel demo clutch --horizon 5 --output results
  hysdel demo clutch --json
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "demo",
        help="run a ready-made application",
        description="Run a ready-made application, print its figures, and write a picture and a table.\n"
        "  clutch   engage a dry clutch by hybrid model predictive control",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", choices=["clutch"], help="which one")
    parser.add_argument("--horizon", type=int, default=10, metavar="N", help="steps that are planned (default 10)")
    parser.add_argument("--backend", default="auto", help="solver of the quadratic programs: auto, dense, piqp or osqp")
    parser.add_argument("--hard", action="store_true", help="keep the engine-speed limit hard: the loop ends early")
    parser.add_argument(
        "--output", metavar="FOLDER", default="hysdel-demo", help="where the files go (default hysdel-demo)"
    )
    parser.add_argument("--json", action="store_true", help="print the figures as JSON and write no files")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status is 1 if the clutch was not engaged."""
    folder = Path(options.output)
    if not options.json:
        folder.mkdir(parents=True, exist_ok=True)
    progress = progress_line(not options.json)
    result = engage(horizon=options.horizon, backend=options.backend, hard=options.hard, progress=progress)
    clear_progress(progress)
    if options.json:
        print_json(result.figures() | {"trajectory": result.trajectory.to_dict()})
    else:
        print(_report(result))
        print("\n".join(_write_files(result, folder)))
    return 0 if result.engaged else 1


def _report(result: ClutchDemo) -> str:
    lines = [f"  {text:<44} {value}" for text, value in result.table()]
    return "\n".join(["Engagement of a dry clutch by hybrid model predictive control", *lines, *result.messages])


def _write_files(result: ClutchDemo, folder: Path) -> list[str]:
    written = [folder / "clutch.csv"]
    written[0].write_text(result.trajectory.to_csv(), encoding="utf-8")
    try:
        figure = result.plot()
    except ModuleNotFoundError:
        return [f"wrote {written[0]}", "no picture: matplotlib is not installed (pip install matplotlib)"]
    written.append(folder / "clutch.png")
    figure.savefig(written[1])
    return [f"wrote {path}" for path in written]
