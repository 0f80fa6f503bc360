"""The file of a sweep: one line of JSON for each task that ended, so that a sweep that was broken off goes on.

The first line says which task the file belongs to. A line is written when its task ends; of a line that was cut off by
a crash nothing is kept. Numbers come back as they were written; NaN and infinite ones are spelled as Python does.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from hysdel_py.errors import ArgumentError
from hysdel_py.sweeps.record import Seed, SweepRecord

__all__ = ["Journal", "task_name"]

_FORMAT = "hysdel_py sweep 1"
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def task_name(task: Callable[..., Any]) -> str:
    """Name of a task by which a file knows it again, with the arguments of a partial."""
    if isinstance(task, partial):
        given = [repr(value) for value in task.args] + [f"{key}={value!r}" for key, value in task.keywords.items()]
        return _ADDRESS.sub("", f"{task_name(task.func)}({', '.join(given)})")
    return f"{getattr(task, '__qualname__', type(task).__qualname__)}"


class Journal:
    """The records in a file, and a way to add more.

    Parameters
    ----------
    path : path
        File to read and to append to; made where there is none.
    task : str
        Name of the task.

    Raises
    ------
    ArgumentError
        The file is none of a sweep, or that of another task.
    """

    def __init__(self, path: str | Path, task: str) -> None:
        self.path = Path(path)
        self.task = task
        whole = self._whole_lines()
        if whole:
            self._require_own(whole[0])
        self.records = {record.seed: record for record in (_record(line, self.path) for line in whole[1:])}
        self._rewrite(whole or [json.dumps({"format": _FORMAT, "task": task})])

    def add(self, record: SweepRecord) -> None:
        """Write a record down; it is in the file when this returns."""
        with self.path.open("a", encoding="utf-8") as file:
            file.write(_line(record) + "\n")

    def _whole_lines(self) -> list[str]:
        """Lines that were written to their ends."""
        if not self.path.exists():
            return []
        return self.path.read_text(encoding="utf-8").split("\n")[:-1]

    def _require_own(self, line: str) -> None:
        head = _parsed(line, self.path)
        if head.get("format") != _FORMAT:
            raise ArgumentError(f"{self.path} is no file of a sweep; choose another name, or remove it")
        theirs = head.get("task")
        if theirs != self.task:
            raise ArgumentError(
                f"{self.path} holds results of {theirs}, not of {self.task}; choose another name, or remove it"
            )

    def _rewrite(self, lines: list[str]) -> None:
        """Only whole lines stay, so that the next one begins where it should."""
        self.path.write_text("".join(line + "\n" for line in lines), encoding="utf-8")


def _parsed(line: str, path: Path) -> dict[str, Any]:
    try:
        found = json.loads(line)
    except json.JSONDecodeError:
        found = None
    if not isinstance(found, dict):
        raise ArgumentError(f"{path} is no file of a sweep; choose another name, or remove it")
    return found


def _line(record: SweepRecord) -> str:
    kept: dict[str, Any] = {"seed": record.seed, "seconds": round(record.seconds, 6)}
    kept |= {"value": record.value} if record.ok else {"error": record.error, "trace": record.trace}
    return json.dumps(kept)


def _record(line: str, path: Path) -> SweepRecord:
    kept = _parsed(line, path)
    if "seed" not in kept:
        raise ArgumentError(f"{path} has a line without a seed: {line[:60]}; remove the line, or the file")
    seed: Seed = kept["seed"]
    return SweepRecord(seed, kept.get("value"), kept.get("error", ""), kept.get("trace", ""), kept.get("seconds", 0.0))
