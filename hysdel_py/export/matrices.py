"""An Mld as plain data, in a JSON file, and in array files for numpy (``.npz``) and MATLAB (``.mat``).

:mod:`hysdel_py.export.reading` reads all three back.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.symbolic_mld import MATRICES, SymbolicMld

__all__ = [
    "MATRICES", "SCHEMA", "dense", "json_text", "mld_to_dict", "nonzeros", "row_text", "variable_data", "write_json",
    "write_mat", "write_npz",
]  # fmt: skip

SCHEMA = "hysdel_py/mld/1"
"""Name and version of the layout of the JSON form."""
_GROUPS = ("x", "u", "y", "d", "z")


def mld_to_dict(mld: Mld) -> dict[str, Any]:
    """Plain data of an Mld: sizes, variables, dense matrices as lists of rows, and the origin of each row.

    Infinite ends of ranges become null, since JSON has no infinity.
    """
    return {**_head(mld), **{name: dense(mld, name).tolist() for name in MATRICES}, **_tail(mld)}


def _head(mld: Mld) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "name": mld.name,
        "source": mld.source,
        "tolerances": asdict(mld.tolerances),
        "form": "x+ = A x + B1 u + B2 d + B3 z + B5; y = C x + D1 u + D2 d + D3 z + D5; "
        "E2 d + E3 z <= E1 u + E4 x + E5",
        "sizes": {key: getattr(mld, f"n{key}") for key in ("x", "u", "y", "d", "z", "e")},
        "variables": {key: [variable_data(v) for v in getattr(mld, key)] for key in ("x", "u", "y", "d", "z")},
    }


def _tail(mld: Mld) -> dict[str, Any]:
    return {key: _origins(getattr(mld, key)) for key in ("rows", "updates", "outputs")}


def dense(mld: Mld | SymbolicMld, name: str) -> NDArray[Any]:
    """A matrix as a dense array without negative zeros, of objects where numbers may be symbolic."""
    matrix = getattr(mld, name)
    if isinstance(mld, SymbolicMld):
        return np.asarray(matrix)
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float) + 0.0


def nonzeros(matrix: Any) -> Iterator[list[tuple[int, float]]]:
    """Column and value of the entries of each row that are not zero, of a dense or a sparse matrix."""
    if not hasattr(matrix, "indptr"):
        for row in matrix:
            places = np.flatnonzero(row)
            yield list(zip(places.tolist(), row[places].tolist(), strict=True))
        return
    ordered = matrix.sorted_indices()
    columns, values = ordered.indices.tolist(), ordered.data.tolist()
    for start, end in pairwise(ordered.indptr.tolist()):
        yield [(j, value) for j, value in zip(columns[start:end], values[start:end], strict=True) if value]


def row_text(entries: list[tuple[int, float]], count: int, zero: str, text: Callable[[float], str]) -> str:
    """A row of so many entries as text; zeros, which large models are full of, are written run by run."""
    pieces: list[str] = []
    written = 0
    for column, value in entries:
        pieces += (zero * (column - written), text(value))
        written = column + 1
    return "".join((*pieces, zero * (count - written)))


def variable_data(variable: Variable) -> dict[str, Any]:
    """Plain data of a variable."""
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
    """Write the plain data of an Mld as JSON, each row of a matrix on a line of its own."""
    Path(path).write_text(json_text(mld), encoding="utf-8")


def json_text(mld: Mld) -> str:
    """The plain data of an Mld as JSON."""
    entries = [
        *(f"{json.dumps(key)}: {json.dumps(value, indent=1)}" for key, value in _head(mld).items()),
        *(f'"{name}": {_json_matrix(getattr(mld, name))}' for name in MATRICES),
        *(f"{json.dumps(key)}: {json.dumps(value, indent=1)}" for key, value in _tail(mld).items()),
    ]
    return "{\n" + ",\n".join(entries) + "\n}\n"


def _json_matrix(matrix: Any) -> str:
    if matrix.ndim == 1:
        return json.dumps((matrix + 0.0).tolist())
    columns = matrix.shape[1]
    rows = (row_text(row, columns, "0.0, ", lambda value: f"{json.dumps(value)}, ") for row in nonzeros(matrix))
    return "[\n" + ",\n".join(f"[{row.removesuffix(', ')}]" for row in rows) + "\n]"


def write_npz(mld: Mld, path: str | os.PathLike[str]) -> None:
    """Write the matrices, the names and the ranges of an Mld with numpy; all arrays are dense."""
    arrays: dict[str, Any] = {name: dense(mld, name) for name in MATRICES}
    for key in _GROUPS:
        group = getattr(mld, key)
        arrays[f"names_{key}"] = np.array([v.name for v in group], dtype=str)
        arrays[f"low_{key}"] = np.array([v.low for v in group], dtype=float)
        arrays[f"high_{key}"] = np.array([v.high for v in group], dtype=float)
        arrays[f"is_bool_{key}"] = np.array([v.is_bool for v in group], dtype=bool)
    arrays["about"] = np.array(_about(mld))
    with Path(path).open("wb") as file:
        np.savez(file, **arrays)


def write_mat(mld: Mld, path: str | os.PathLike[str]) -> None:
    """Write an Mld for MATLAB and Octave as the variable ``S``: matrices, names and ranges; all arrays are dense."""
    from scipy.io import savemat

    columns = {name: dense(mld, name) for name in MATRICES}
    fields: dict[str, Any] = {name: m[:, None] if m.ndim == 1 else m for name, m in columns.items()}
    for key in _GROUPS:
        group = getattr(mld, key)
        fields[f"names_{key}"] = np.array([v.name for v in group], dtype=object)
        fields[f"{key}l"] = np.array([[v.low] for v in group], dtype=float).reshape(len(group), 1)
        fields[f"{key}u"] = np.array([[v.high] for v in group], dtype=float).reshape(len(group), 1)
    with Path(path).open("wb") as file:
        savemat(file, {"S": fields | {"about": _about(mld)}}, long_field_names=True)


def _about(mld: Mld) -> str:
    """All but the matrices as JSON text, so that an array file can be read back as it was."""
    return json.dumps({**_head(mld), **_tail(mld)})
