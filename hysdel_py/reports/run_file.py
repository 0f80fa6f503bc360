"""A run from a file that a command wrote: the JSON of ``--json`` or the table of ``--csv``."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from hysdel_py.systems.signals import Variable

__all__ = ["RecordedRun", "RecordedSignal", "read_run", "recorded"]

Vector = NDArray[np.float64]
_GROUPS = ("x", "u", "y", "d", "z")
_EXPECTED = "a file of hysdel simulate, mpc or demo was expected: the JSON of --json or the table of --csv"


@dataclass(frozen=True, eq=False, slots=True)
class RecordedSignal:
    """One signal of a run.

    Attributes
    ----------
    name : str
    group : str
        Letter of its vector, ``info`` for what a controller recorded.
    unit : str
    is_bool : bool
    values : array
        As long as the times of the run, or one shorter.
    """

    name: str
    group: str
    unit: str
    is_bool: bool
    values: Vector


@dataclass(frozen=True, eq=False, slots=True)
class RecordedRun:
    """A run as far as its file tells it.

    Attributes
    ----------
    t : array
    signals : tuple of RecordedSignal
    messages : tuple of str
    """

    t: Vector
    signals: tuple[RecordedSignal, ...]
    messages: tuple[str, ...] = ()

    def group(self, *names: str) -> tuple[RecordedSignal, ...]:
        """Signals of some vectors."""
        return tuple(signal for signal in self.signals if signal.group in names)


def read_run(path: str | os.PathLike[str], variables: Mapping[str, Sequence[Variable]]) -> RecordedRun:
    """The run of a file.

    Parameters
    ----------
    path : str or path
    variables : mapping of "x", "u", "y", "d", "z" to variables
        Of the model of the run, for units and types; signals it does not have are kept as plain ones.

    Raises
    ------
    ArgumentError
        The file holds something else, or no signal of the model.
    """
    text = Path(path).read_text(encoding="utf-8-sig", errors="replace")
    try:
        run = _of_json(json.loads(text), variables) if text.lstrip()[:1] == "{" else _of_table(text, variables)
    except (KeyError, TypeError, ValueError) as error:
        reason = f": {error}" if isinstance(error, ArgumentError) else ""
        raise ArgumentError(f"{os.fspath(path)} is no run{reason}; {_EXPECTED}") from None
    known = {v.name for group in variables.values() for v in group}
    if not any(signal.name in known for signal in run.signals):
        names = ", ".join(signal.name for signal in run.signals) or "no signals"
        raise ArgumentError(f"{os.fspath(path)} is the run of another model: it has {names}, and none is of this model")
    return run


def recorded(run: Trajectory) -> RecordedRun:
    """The run of a Trajectory."""
    signals = [
        RecordedSignal(v.name, key, v.unit, v.is_bool, getattr(run, key)[:, i])
        for key, group in run.variables.items()
        for i, v in enumerate(group)
    ]
    signals += [RecordedSignal(name, "info", "", False, np.asarray(values)) for name, values in run.info.items()]
    return RecordedRun(run.t, tuple(signals), run.messages)


def _of_json(data: Mapping[str, Any], variables: Mapping[str, Sequence[Variable]]) -> RecordedRun:
    inner = data.get("trajectory", data)
    if "columns" in inner and "rows" in inner:
        return _of_columns(list(inner["columns"]), np.array(inner["rows"], dtype=float), variables)
    t = _numbers(inner["t"])
    signals = []
    for key in _GROUPS:
        names = inner["names"].get(key, [])
        table = _numbers(inner[key]).reshape(-1, len(names)) if names else np.zeros((0, 0))
        signals += [_signal(name, key, table[:, i], variables) for i, name in enumerate(names)]
    signals += [_signal(name, "info", _numbers(values), variables) for name, values in inner["info"].items()]
    run = RecordedRun(t, tuple(signals), tuple(map(str, inner["messages"])))
    _check_lengths(run)
    return run


def _of_table(text: str, variables: Mapping[str, Sequence[Variable]]) -> RecordedRun:
    lines = [line for line in csv.reader(io.StringIO(text)) if line]
    if len(lines) < 1 or "t" not in lines[0]:
        raise ArgumentError("its first line has no column t")
    names, rows = lines[0], lines[1:]
    if any(len(row) != len(names) for row in rows):
        raise ArgumentError(f"each line should have {len(names)} values")
    return _of_columns(
        names, np.array([[float(cell) for cell in row] for row in rows]).reshape(-1, len(names)), variables
    )


def _of_columns(names: Sequence[str], rows: Vector, variables: Mapping[str, Sequence[Variable]]) -> RecordedRun:
    columns = dict(zip(names, rows.T, strict=True))
    t = columns.pop("t")
    return RecordedRun(t, tuple(_column(name, values, variables) for name, values in columns.items()))


def _column(name: str, values: Vector, variables: Mapping[str, Sequence[Variable]]) -> RecordedSignal:
    letter, dot, own = name.partition(".")
    if dot and letter in (*_GROUPS, "info") and not any(v.name == name for group in variables.values() for v in group):
        return _signal(own, letter, values, variables)
    key = next((key for key in _GROUPS for v in variables.get(key, ()) if v.name == name), "info")
    return _signal(name, key, values, variables)


def _signal(name: str, group: str, values: Vector, variables: Mapping[str, Sequence[Variable]]) -> RecordedSignal:
    known = next((v for v in variables.get(group, ()) if v.name == name), None)
    if known is None:
        return RecordedSignal(str(name), group, "", group == "d", values)
    return RecordedSignal(name, group, known.unit, known.is_bool, values)


def _numbers(values: Sequence[Any]) -> Vector:
    """Numbers, null among them for those that JSON does not have."""
    return np.array(values, dtype=object).astype(float)


def _check_lengths(run: RecordedRun) -> None:
    for signal in run.signals:
        if len(run.t) - len(signal.values) not in (0, 1):
            raise ArgumentError(f"{signal.name} has {len(signal.values)} values at {len(run.t)} times")
