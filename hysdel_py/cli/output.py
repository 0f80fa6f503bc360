"""Tables and files that several commands write."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from hysdel_py.systems.trajectory import Trajectory

__all__ = ["emit_trajectory", "table", "without_nonfinite"]

_MAX_LINES = 60


def table(columns: dict[str, Any], max_lines: int = _MAX_LINES) -> str:
    """Aligned text table; the middle of a long one is left out and said so."""
    cells = {name: [_cell(value) for value in values] for name, values in columns.items()}
    widths = {name: max([len(name), *map(len, values)]) for name, values in cells.items()}
    lines = ["  ".join(name.rjust(widths[name]) for name in cells)]
    body = ["  ".join(value.rjust(widths[name]) for name, value in zip(cells, row, strict=True))
            for row in zip(*cells.values(), strict=True)]  # fmt: skip
    if len(body) > max_lines:
        half = max_lines // 2
        body = [*body[:half], f"... {len(body) - 2 * half} more steps; --csv writes them all ...", *body[-half:]]
    return "\n".join(lines + body)


def _cell(value: float) -> str:
    return f"{float(value):.6g}"


def without_nonfinite(data: Any) -> Any:
    """Plain data with null in place of infinite numbers and NaN, which JSON does not have."""
    if isinstance(data, dict):
        return {key: without_nonfinite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [without_nonfinite(value) for value in data]
    if isinstance(data, float) and not abs(data) < float("inf"):
        return None
    return data


def emit_trajectory(trajectory: Trajectory, options: argparse.Namespace) -> None:
    """Write what the options ask for: JSON or a table on the screen, a CSV file, a picture."""
    if options.csv:
        Path(options.csv).write_text(trajectory.to_csv(), encoding="utf-8")
    if options.plot:
        trajectory.plot().savefig(options.plot)
    if options.json:
        print(json.dumps(without_nonfinite(trajectory.to_dict())))
        return
    print(table(trajectory.columns()))
    for message in trajectory.messages:
        print(message)
