"""Matrices of an Mld as plain data for JSON and as arrays in one ``.npz`` file."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable

__all__ = ["MATRICES", "SCHEMA", "mld_to_dict", "write_json", "write_npz"]

MATRICES = ("A", "B1", "B2", "B3", "B5", "C", "D1", "D2", "D3", "D5", "E1", "E2", "E3", "E4", "E5")
SCHEMA = "hysdel_py/mld/1"
"""Name and version of the layout of the JSON form."""


def mld_to_dict(mld: Mld) -> dict[str, Any]:
    """Plain data of an Mld: sizes, variables, dense matrices as lists of rows, and the origin of each row.

    Infinite ends of ranges become null, since JSON has no infinity.
    """
    return {
        "schema": SCHEMA,
        "name": mld.name,
        "source": mld.source,
        "form": "x+ = A x + B1 u + B2 d + B3 z + B5; y = C x + D1 u + D2 d + D3 z + D5; "
        "E2 d + E3 z <= E1 u + E4 x + E5",
        "sizes": {key: getattr(mld, f"n{key}") for key in ("x", "u", "y", "d", "z", "e")},
        "variables": {key: [_variable(v) for v in getattr(mld, key)] for key in ("x", "u", "y", "d", "z")},
        **{name: _dense(mld, name).tolist() for name in MATRICES},
        "rows": _origins(mld.rows),
        "updates": _origins(mld.updates),
        "outputs": _origins(mld.outputs),
    }


def _dense(mld: Mld, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    matrix = getattr(mld, name)
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float) + 0.0


def _variable(variable: Variable) -> dict[str, Any]:
    return {
        "name": variable.name,
        "type": variable.type.value,
        "low": _finite(variable.low),
        "high": _finite(variable.high),
        "unit": variable.unit,
        "description": variable.description,
        "line": variable.line,
        "generated": variable.generated,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _origins(rows: Sequence[RowOrigin]) -> list[dict[str, Any]]:
    keys = ("item", "section", "defines", "group", "subgroup", "subindex", "line", "text")
    return [{key: getattr(row, key) for key in keys} | {"depends": list(row.depends)} for row in rows]


def write_json(mld: Mld, path: str | os.PathLike[str]) -> None:
    """Write the plain data of an Mld as JSON."""
    Path(path).write_text(json.dumps(mld_to_dict(mld), indent=1) + "\n", encoding="utf-8")


def write_npz(mld: Mld, path: str | os.PathLike[str]) -> None:
    """Write the matrices, the names and the ranges of an Mld with numpy; all arrays are dense."""
    arrays: dict[str, Any] = {name: _dense(mld, name) for name in MATRICES}
    for key in ("x", "u", "y", "d", "z"):
        group = getattr(mld, key)
        arrays[f"names_{key}"] = np.array([v.name for v in group], dtype=str)
        arrays[f"low_{key}"] = np.array([v.low for v in group], dtype=float)
        arrays[f"high_{key}"] = np.array([v.high for v in group], dtype=float)
        arrays[f"is_bool_{key}"] = np.array([v.is_bool for v in group], dtype=bool)
    with Path(path).open("wb") as file:
        np.savez(file, **arrays)
