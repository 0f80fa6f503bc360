"""The file of a sweep: one line of JSON for each task that ended, so that a sweep that was broken off goes on.

The first line says which task the file belongs to. A line is written when its task ends; of a line that was cut off by
a crash nothing is kept. Numbers come back as they were written; NaN and infinite ones are spelled as Python does.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import partial
from hashlib import sha256
from os import PathLike
from pathlib import Path
from types import MethodType
from typing import Any

from hysdel_py.errors import ArgumentError
from hysdel_py.sweeps.record import SweepRecord

__all__ = ["Journal", "task_name"]

_FORMAT = "hysdel_py sweep 1"
_OPENING = f'{{"format": "{_FORMAT}", '
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def task_name(task: Callable[..., Any]) -> str:
    """Name of a task by which a file knows it again.

    It has the arguments of a partial, the attributes of an object that is called or whose method is, and the code of a
    lambda; what a function takes from around it is not seen.
    """
    if isinstance(task, partial):
        given = [_told(value) for value in task.args] + [
            f"{key}={_told(value)}" for key, value in task.keywords.items()
        ]
        return f"{task_name(task.func)}({', '.join(given)})"
    if isinstance(task, MethodType):
        return f"{_told(task.__self__)}.{task.__func__.__name__}"
    name = getattr(task, "__qualname__", None)
    if name is None:
        return _told(task)
    return f"{name} {_digest(_code(task))}" if name.endswith("<lambda>") else f"{name}"


def _told(value: Any) -> str:
    """A value as a text that another value has not: `repr` shortens arrays and leaves out attributes."""
    if hasattr(value, "tobytes") and hasattr(value, "shape"):
        return f"array{value.shape} {_digest(f'{value.dtype}'.encode() + value.tobytes())}"
    if _is_anonymous(value):
        attributes = ", ".join(f"{key}={_plain_repr(part)}" for key, part in vars(value).items())
        return f"{type(value).__qualname__}({attributes})"
    return _plain_repr(value)


def _is_anonymous(value: Any) -> bool:
    """Whether `repr` is the one of every object: a kind and an address."""
    return hasattr(value, "__dict__") and repr(value) == object.__repr__(value)


def _plain_repr(value: Any) -> str:
    return _ADDRESS.sub("", repr(value))


def _code(function: Any) -> bytes:
    code = function.__code__
    return bytes(code.co_code) + _plain_repr((code.co_names, code.co_consts)).encode()


def _digest(content: bytes) -> str:
    return sha256(content).hexdigest()[:12]


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
        The file is none of a sweep or that of another task, a line of it is damaged, or it cannot be one.
    """

    def __init__(self, path: str | Path, task: str) -> None:
        self.path = _writable(path)
        self.task = task
        self._head = json.dumps({"format": _FORMAT, "task": task})
        content = self.path.read_bytes() if self.path.exists() else b""
        whole, _, tail = content.rpartition(b"\n")
        lines = whole.splitlines()
        self._require_own(lines, tail)
        places = ((place, line) for place, line in enumerate(lines[1:], 2) if line.strip())
        self.records = {record.seed: record for record in (_record(line, place, self.path) for place, line in places)}
        self._continue_after(len(content) - len(tail))

    def add(self, record: SweepRecord) -> None:
        """Write a record down; it is in the file when this returns."""
        with self.path.open("a", encoding="utf-8") as file:
            file.write(_line(record) + "\n")

    def _require_own(self, lines: list[bytes], tail: bytes) -> None:
        """Nothing is written into a file that is none of this task; a head that was cut off is."""
        if not lines:
            opening = _OPENING.encode()
            if not (opening.startswith(tail) or tail.startswith(opening)):
                raise _no_sweep(self.path)
            return
        head = _parsed(lines[0])
        if head.get("format") != _FORMAT:
            raise _no_sweep(self.path)
        theirs = head.get("task")
        if theirs != self.task:
            raise ArgumentError(
                f"{self.path} holds results of {theirs}, not of {self.task}; choose another name, or remove it"
            )

    def _continue_after(self, length: int) -> None:
        """Whole lines stay untouched and nothing else does, so that the next one begins where it should."""
        with self.path.open("ab") as file:
            file.truncate(length)
            if not length:
                file.write(self._head.encode() + b"\n")


def _writable(path: str | Path) -> Path:
    if not isinstance(path, str | PathLike):
        raise ArgumentError(f"resume is the name of a file, not {path!r}")
    target = Path(path)
    if target.is_dir():
        raise ArgumentError(f"resume names a file, and {target} is a folder")
    if not target.parent.is_dir():
        raise ArgumentError(f"{target}: the folder {target.parent} does not exist")
    return target


def _no_sweep(path: Path) -> ArgumentError:
    return ArgumentError(f"{path} is no file of a sweep; choose another name, or remove it")


def _parsed(line: bytes) -> dict[str, Any]:
    """What a line holds, nothing where it is damaged."""
    try:
        found = json.loads(line.decode("utf-8"))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def _line(record: SweepRecord) -> str:
    kept: dict[str, Any] = {"seed": record.seed, "seconds": round(record.seconds, 6)}
    kept |= {"value": record.value} if record.ok else {"error": record.error, "trace": record.trace}
    return json.dumps(kept)


def _record(line: bytes, place: int, path: Path) -> SweepRecord:
    kept = _parsed(line)
    seed, error = kept.get("seed"), kept.get("error", "")
    is_ended = "value" in kept or (isinstance(error, str) and error)
    if not isinstance(seed, int | str) or isinstance(seed, bool) or not is_ended:
        text = line[:60].decode("ascii", "replace")
        raise ArgumentError(f"line {place} of {path} is no result of a task: {text}; remove the line to run it again")
    return SweepRecord(seed, kept.get("value"), error, kept.get("trace", ""), kept.get("seconds", 0.0))
