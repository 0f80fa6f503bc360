"""``hysdel demo upshift-23`` and its like: gear shifts, and a drive with a supervisor."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hysdel_py.cli.output import print_json
from hysdel_py.cli.progress import clear_progress, progress_line
from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.drive import DriveRun, drive
from hysdel_py.demos.shifts.plant import FINE, STEPS_PER_SAMPLE
from hysdel_py.demos.shifts.shift import ShiftRun, run_shift

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["TITLES", "run_shift_demo"]

TITLES = {name: shift.title for name, shift in SHIFTS.items()} | {"drive": "drive with gear shifts under a supervisor"}


def run_shift_demo(options: argparse.Namespace) -> int:
    """Run one of them; the exit status is 1 if a clutch did not lock."""
    folder = Path(options.output)
    if not options.json:
        folder.mkdir(parents=True, exist_ok=True)
    progress = progress_line(not options.json)
    named = SHIFTS.get(options.name)
    result: ShiftRun | DriveRun
    if named is None:
        result = drive(progress=progress)
    else:
        result = run_shift(named, controller=options.controller, progress=progress)
    clear_progress(progress)
    if options.json:
        every = _rows(result)[:: STEPS_PER_SAMPLE // 2]
        print_json(result.figures() | {"columns": ["t", *FINE], "rows": every.tolist()})
    else:
        title = TITLES[options.name]
        lines = [f"  {text:<44} {value}" for text, value in result.table()]
        name = options.name if options.controller == "hybrid" else f"{options.name}-{options.controller}"
        print("\n".join([title[0].upper() + title[1:], *lines, *_write_files(result, folder / name)]))
    return 0 if result.done else 1


def _rows(result: ShiftRun | DriveRun) -> NDArray[np.float64]:
    return np.column_stack([result.t, result.fine])


def _write_files(result: Any, stem: Path) -> list[str]:
    table = stem.with_suffix(".csv")
    rows = (",".join(f"{value:.9g}" for value in row) for row in _rows(result))
    table.write_text("\n".join([",".join(("t", *FINE)), *rows]) + "\n", encoding="utf-8")
    try:
        figure = result.plot()
    except ModuleNotFoundError:
        return [f"wrote {table}", "no picture: matplotlib is not installed (pip install matplotlib)"]
    figure.savefig(stem.with_suffix(".png"))
    return [f"wrote {table}", f"wrote {stem.with_suffix('.png')}"]
