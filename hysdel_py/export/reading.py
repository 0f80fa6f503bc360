"""Mld forms from the files that :mod:`hysdel_py.export.matrices` writes, equal to what was written."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.export.matrices import SCHEMA
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Kind, Type, Variable
from hysdel_py.systems.symbolic_mld import MATRICES
from hysdel_py.tolerances import Tolerances

__all__ = ["check_schema", "json_data", "mld_from_dict", "read_mat", "read_mld_json", "read_npz", "variable_of"]

Path_ = str | os.PathLike[str]


def mld_from_dict(data: Mapping[str, Any]) -> Mld:
    """Mld of the plain data that :func:`~hysdel_py.export.matrices.mld_to_dict` gives.

    Raises
    ------
    ArgumentError
        The data is of another kind or version, or a part of it is missing or does not fit.
    """
    check_schema(data, SCHEMA)
    try:
        groups = {kind.value: tuple(variable_of(v, kind) for v in data["variables"][kind.value]) for kind in Kind}
        matrices = {name: _matrix(data[name], shape) for name, shape in _shapes(data["sizes"]).items()}
        origins = {key: tuple(_origin(row) for row in data[key]) for key in ("rows", "updates", "outputs")}
        return _mld(data, groups, matrices, origins)
    except (KeyError, TypeError, ValueError) as error:
        raise ArgumentError(f"the data of an Mld is damaged: {type(error).__name__}: {error}") from None


def read_mld_json(path: Path_) -> Mld:
    """Mld of a JSON file.

    Raises
    ------
    ArgumentError
        It holds something else.
    """
    return mld_from_dict(json_data(path))


def json_data(path: Path_) -> Any:
    """What a JSON file holds.

    Raises
    ------
    ArgumentError
        It is no JSON file.
    """
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except ValueError:
        raise ArgumentError(f"{os.fspath(path)} is not a JSON file") from None


def read_npz(path: Path_) -> Mld:
    """Mld of an array file of numpy.

    Raises
    ------
    ArgumentError
        It holds something else.
    """
    try:
        with np.load(Path(path)) as stored:
            arrays = dict(stored)
    except (ValueError, TypeError, EOFError):
        raise ArgumentError(f"{os.fspath(path)} is not an array file of numpy") from None
    return _from_arrays(arrays, path)


def read_mat(path: Path_) -> Mld:
    """Mld of a file for MATLAB.

    Raises
    ------
    ArgumentError
        It holds something else.
    """
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        with Path(path).open("rb") as file:
            struct = loadmat(file, chars_as_strings=True)["S"]
        arrays = {name: struct[name][0, 0] for name in struct.dtype.names}
    except (ValueError, KeyError, TypeError, MatReadError):
        raise ArgumentError(f"{os.fspath(path)} is not a MATLAB file with a struct S") from None
    return _from_arrays(arrays, path)


def _from_arrays(arrays: Mapping[str, NDArray[Any]], path: Path_) -> Mld:
    if "about" not in arrays:
        raise ArgumentError(f"{os.fspath(path)} holds no Mld: the entry about is missing")
    about = json.loads(str(arrays["about"].reshape(-1)[0]))
    return mld_from_dict(about | {name: arrays[name] for name in MATRICES if name in arrays})


def check_schema(data: Mapping[str, Any], expected: str) -> None:
    """Refuse data of another kind or version."""
    schema = data.get("schema") if isinstance(data, Mapping) else None
    if schema != expected:
        raise ArgumentError(f"the data has the schema {schema!r}: {expected!r} was expected")


def _shapes(sizes: Mapping[str, int]) -> dict[str, tuple[int, ...]]:
    shapes: dict[str, tuple[int, ...]] = {}
    for letters, rows in (("ABBB", sizes["x"]), ("CDDD", sizes["y"])):
        for letter, digit, key in zip(letters, ("", "1", "2", "3"), "xudz", strict=True):
            shapes[letter + digit] = (rows, sizes[key])
    shapes |= {"B5": (sizes["x"],), "D5": (sizes["y"],), "E5": (sizes["e"],)}
    return shapes | {f"E{i}": (sizes["e"], sizes[key]) for i, key in enumerate("udzx", start=1)}


def _matrix(entries: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Read-only matrix; one without rows or columns may have lost its shape."""
    array = np.array(entries, dtype=float).reshape(shape)
    array.setflags(write=False)
    return array


def _mld(
    data: Mapping[str, Any],
    groups: Mapping[str, Any],
    matrices: Mapping[str, NDArray[np.float64]],
    origins: Mapping[str, Any],
) -> Mld:
    from scipy.sparse import csr_array

    sparse: dict[str, Any] = {name: csr_array(matrices[name]) for name in ("E1", "E2", "E3", "E4")}
    tolerances = Tolerances(**data["tolerances"])
    return Mld(
        data["name"], **{**groups, **matrices, **sparse, **origins}, source=data["source"], tolerances=tolerances
    )


def variable_of(data: Mapping[str, Any], kind: Kind) -> Variable:
    """Variable of its plain data."""
    return Variable(
        data["name"],
        Type(data["type"]),
        kind,
        -math.inf if data["low"] is None else data["low"],
        math.inf if data["high"] is None else data["high"],
        data["unit"],
        data["description"],
        data["line"],
        data["generated"],
    )


def _origin(data: Mapping[str, Any]) -> RowOrigin:
    fields = {key: data[key] for key in RowOrigin.__slots__}
    return RowOrigin(**fields | {"depends": tuple(data["depends"])})
