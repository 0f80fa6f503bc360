"""Feedback tables as .npz files."""

from __future__ import annotations

from os import PathLike
from typing import Any
from zipfile import BadZipFile

import numpy as np

from hysdel_py.control.dynamic_programming.grids import Axis, Mesh
from hysdel_py.control.dynamic_programming.schedule import Before, Stage
from hysdel_py.control.dynamic_programming.settings import DpSettings
from hysdel_py.control.dynamic_programming.table import FeedbackTable
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Kind, Type, Variable

__all__ = ["load_table", "save_table"]

_FORMAT = 1


def save_table(table: FeedbackTable, path: str | PathLike[str]) -> None:
    """Write a table; nothing in the file needs to be executed to read it."""
    with open(path, "wb") as file:
        np.savez_compressed(file, **_content(table))


def _content(table: FeedbackTable) -> dict[str, Any]:
    content: dict[str, Any] = {
        "format": np.array(_FORMAT),
        "first": np.array(table.first),
        "sample_time": np.array(table.sample_time),
        "remembers": np.array(table.schedule[0].before is not None),
    }
    for key, group in table.variables.items():
        content[f"{key}_names"] = np.array([v.name for v in group])
        content[f"{key}_units"] = np.array([v.unit for v in group])
        content[f"{key}_ranges"] = np.array([[v.low, v.high] for v in group])
    for k, stage in enumerate(table.schedule):
        content[f"axes_{k}"] = np.array([[axis.low, axis.high, axis.count] for axis in stage.mesh.axes])
        content[f"inputs_{k}"], content[f"values_{k}"] = stage.inputs, table.values[k]
        if stage.before is not None:
            before = stage.before
            content[f"before_{k}"], content[f"group_{k}"], content[f"changes_{k}"] = (
                before.inputs,
                before.group,
                before.changes,
            )
    return content | {f"policy_{k}": policy for k, policy in enumerate(table.policy)}


def load_table(path: str | PathLike[str]) -> FeedbackTable:
    """Read a table.

    Raises
    ------
    ArgumentError
        The file is no feedback table or of another format.
    """
    try:
        with np.load(path, allow_pickle=False) as data:
            content = {name: data[name] for name in data.files}
    except (BadZipFile, ValueError) as error:
        raise ArgumentError(f"{path} is not an .npz file: {error}") from None
    if content.get("format") != _FORMAT or "remembers" not in content:
        raise ArgumentError(f"{path} holds no feedback table of format {_FORMAT}")
    count = sum(name.startswith("axes_") for name in content)
    variables = {"x": _variables(content, "x", Kind.STATE), "u": _variables(content, "u", Kind.INPUT)}
    return FeedbackTable(
        tuple(_stage(content, k, variables["x"]) for k in range(count)),
        [content[f"values_{k}"] for k in range(count)],
        [content[f"policy_{k}"] for k in range(count - 1)],
        int(content["first"]),
        variables,
        float(content["sample_time"]),
        None,
        DpSettings(),
    )


def _variables(content: dict[str, Any], key: str, kind: Kind) -> tuple[Variable, ...]:
    rows = zip(content[f"{key}_names"], content[f"{key}_units"], content[f"{key}_ranges"], strict=True)
    return tuple(
        Variable(str(name), Type.REAL, kind, float(low), float(high), str(unit)) for name, unit, (low, high) in rows
    )


def _stage(content: dict[str, Any], k: int, variables: tuple[Variable, ...]) -> Stage:
    axes = tuple(
        Axis(v.name, float(low), float(high), int(count), v.unit)
        for v, (low, high, count) in zip(variables, content[f"axes_{k}"], strict=True)
    )
    names = ("before", "group", "changes")
    before = Before(*(content[f"{name}_{k}"] for name in names)) if content["remembers"] else None
    return Stage(Mesh(axes), content[f"inputs_{k}"], before)
