"""Many runs of the gear shifts on plants that are not the model: a table and a picture.

    python benchmarks/shift_study.py --runs 200 --results study.jsonl
    python benchmarks/shift_study.py --runs 200 --results study.jsonl --shifts upshift-12 --workers 4
    python benchmarks/shift_study.py --results study.jsonl --table --picture docs/pictures/shift-study.png

Every finished run is appended to the file of results; a study that was interrupted goes on where it ended. All shifts
take turns, so that wherever it stops each has as many runs as the others. The table tells what the file holds.
"""

# ruff: noqa: E501  (rows of printed tables read better unbroken)
from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.methods import METHODS
from hysdel_py.demos.shifts.study import spread_trials, trials

HEADER = "| shift | controller | runs | locked | torque off, part 1: median, 95 %, worst | part 2: median, 95 %, worst | locked after: median, worst | slope at lock-up: median, 95 % | brake on at reversal | brake rule broken | engine curve passed: runs, median, worst | another limit broken |"


def known(path: Path) -> list[dict[str, Any]]:
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.endswith("}")]


def study(options: argparse.Namespace) -> None:
    done = {row["key"] for row in known(options.results)}
    drawn = [
        trials(name, options.runs, controller=controller, observed=not options.plain)
        for name in options.shifts for controller in options.controllers
    ]  # fmt: skip
    wanted = [trial for turn in zip(*drawn, strict=True) for trial in turn if trial.key not in done]
    with options.results.open("a", encoding="utf-8") as file, ProcessPoolExecutor(options.workers) as pool:

        def keep(row: dict[str, Any]) -> None:
            file.write(json.dumps(row) + "\n")
            file.flush()

        spread_trials(wanted, pool, keep)


def group_of(row: dict[str, Any]) -> tuple[int, int, bool]:
    return list(SHIFTS).index(row["shift"]), METHODS.index(row["controller"]), not row["observed"]


def groups(rows: Sequence[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    return [list(group) for _, group in groupby(sorted(rows, key=group_of), key=group_of)]


def spread(values: list[float], form: str, ends: Sequence[float] = (50, 95, 100)) -> str:
    if not values:
        return "-"
    return ", ".join(format(np.percentile(values, end), form) for end in ends)


def passed(curve: list[float]) -> str:
    return f"{len(curve)}, by {spread(curve, '.1f', (50, 100))} Nm" if curve else "0"


def row_of(group: list[dict[str, Any]]) -> str:
    first, n = group[0], len(group)
    locked = [row for row in group if row["done"]]
    broken = [{text.rsplit(" by ", 1)[0] for text in row["broken"]} for row in group]
    rule = sum("brake rule" in names for names in broken)
    curve = [float(text.rsplit(" by ", 1)[1]) for row in group for text in row["broken"] if "curve" in text]
    other = sum(bool(names - {"brake rule", "engine curve"}) for names in broken)
    name = first["controller"] + ("" if first["observed"] else ", no observer")
    return (
        f"| {first['shift']} | {name} | {n} | {len(locked)} "
        f"| {spread([100 * row['relative_release'] for row in group], '.1f')} % "
        f"| {spread([row['deviation_engage'] for row in group], '.0f')} Nm "
        f"| {spread([row['shift_time'] for row in locked], '.2f', (50, 100))} s "
        f"| {spread([-row['lockup_slope'] for row in locked if row['lockup_slope'] is not None], '.0f', (50, 95))} rad/s^2 "
        f"| {sum(row['brake_at_reversal'] > 0.02 for row in group)} | {rule} "
        f"| {passed(curve)} | {other} |"
    )


def table(rows: Sequence[dict[str, Any]]) -> None:
    print(HEADER)
    print("|" + "---|" * HEADER.count(" | ") + "---|")
    for group in groups(rows):
        print(row_of(group))


def picture(rows: Sequence[dict[str, Any]], path: Path) -> None:
    from hysdel_py.plotting.shift_study import plot_study

    plot_study(groups(rows)).savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--results", type=Path, default=Path("shift-study.jsonl"))
    parser.add_argument("--shifts", nargs="+", default=list(SHIFTS), choices=list(SHIFTS))
    parser.add_argument("--controllers", nargs="+", default=["hybrid"], choices=METHODS)
    parser.add_argument("--plain", action="store_true", help="without the observer")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--table", action="store_true", help="only the table of the results that there are")
    parser.add_argument("--picture", type=Path, help="draw the results into this file")
    options = parser.parse_args()
    if not options.table:
        study(options)
    rows = known(options.results)
    table(rows)
    if options.picture:
        picture(rows, options.picture)


if __name__ == "__main__":
    main()
