"""Tables and files that several commands write."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hysdel_py.cli.data_error import DataError
from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from hysdel_py.model import Model
    from hysdel_py.systems.trajectory import Trajectory

__all__ = [
    "add_files", "check_files", "check_picture", "check_target", "emit_trajectory", "print_json", "table",
    "without_nonfinite",
]  # fmt: skip

PICTURES = (".png", ".pdf", ".svg", ".jpg")
_MAX_LINES = 60
_SAMPLE_TIMES = ("ts", "Ts", "T_s")  # as in Model.sample_time


def add_files(parser: argparse.ArgumentParser) -> None:
    """Add the files that a trajectory can be written to."""
    parser.add_argument("--csv", metavar="PATH", help="write the whole table to a file")
    parser.add_argument("--plot", metavar="PATH", help=f"write a picture ({', '.join(PICTURES)}; needs matplotlib)")


def check_files(options: argparse.Namespace) -> None:
    """Find out before a long run whether its files can be written.

    Raises
    ------
    ArgumentError
        There is no such folder, or no such kind of picture.
    DataError
        matplotlib is not installed.
    """
    if options.csv:
        check_target(Path(options.csv), "--csv")
    check_picture(options.plot, "--plot")


def check_picture(path: str | None, option: str) -> None:
    """The same for one picture, if it is asked for."""
    if not path:
        return
    check_target(Path(path), option)
    if Path(path).suffix.lower() not in PICTURES:
        raise ArgumentError(f"{option} {path}: a name that ends in {', '.join(PICTURES)} was expected")
    if not _has_matplotlib():
        raise DataError(f"{option} needs matplotlib, which is not installed: pip install matplotlib")


def check_target(path: Path, option: str) -> None:
    """Refuse a file in a folder that does not exist, and a folder in place of a file."""
    if not path.parent.is_dir():
        raise ArgumentError(f"{option} {path}: there is no folder {path.parent}")
    if path.is_dir():
        raise ArgumentError(f"{option} {path}: this is a folder, the name of a file was expected")


def _has_matplotlib() -> bool:
    try:
        import matplotlib.figure  # noqa: F401
    except ModuleNotFoundError:
        return False
    return True


def _time_unit(model: Model) -> str:
    """Unit that the model gives beside its sample time, empty where it gives none."""
    units = {symbol.name: symbol.unit for symbol in model.typed.symbols if symbol.is_parameter}
    return next((units[name] for name in _SAMPLE_TIMES if name in units), "")


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


def print_json(data: Any) -> None:
    """Print plain data as JSON by the book: infinite numbers and NaN become null."""
    print(json.dumps(without_nonfinite(data), allow_nan=False))


def without_nonfinite(data: Any) -> Any:
    """Plain data with null in place of infinite numbers and NaN, which JSON does not have."""
    if isinstance(data, dict):
        return {key: without_nonfinite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [without_nonfinite(value) for value in data]
    if isinstance(data, float) and not abs(data) < float("inf"):
        return None
    return data


def emit_trajectory(trajectory: Trajectory, model: Model, options: argparse.Namespace) -> None:
    """Write what the options ask for: JSON or a table on the screen, a CSV file, a picture."""
    if options.csv:
        Path(options.csv).write_text(trajectory.to_csv(), encoding="utf-8")
    if options.plot:
        trajectory.plot(time_unit=_time_unit(model)).savefig(options.plot)
    if options.json:
        print_json(trajectory.to_dict())
        return
    print(table(trajectory.columns()))
    for message in trajectory.messages:
        print(message)
