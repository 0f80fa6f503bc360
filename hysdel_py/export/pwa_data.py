"""A Pwa as plain data and in a JSON file, read back equal to what was written."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.export.matrices import variable_data
from hysdel_py.export.reading import check_schema, json_data, variable_of
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.precision import Precision
from hysdel_py.geometry.search_tree import SearchTree
from hysdel_py.systems.mode import Auxiliaries, Condition, Mode, RowKind
from hysdel_py.systems.pwa import Effort, Pwa
from hysdel_py.systems.signals import Kind
from hysdel_py.tolerances import Tolerances

__all__ = ["PWA_SCHEMA", "pwa_from_dict", "pwa_to_dict", "read_pwa_json", "write_pwa_json"]

PWA_SCHEMA = "hysdel_py/pwa/1"
"""Name and version of the layout of the JSON form."""

Array = NDArray[np.float64]


def pwa_to_dict(pwa: Pwa) -> dict[str, Any]:
    """Plain data of a Pwa: variables, and for each mode its map, region, word and the conditions behind its rows."""
    return {
        "schema": PWA_SCHEMA,
        "name": pwa.name,
        "source": pwa.source,
        "tolerances": asdict(pwa.tolerances),
        "precision": asdict(pwa.modes[0].region.precision if pwa.modes else Precision()),
        "form": "x+ = A x + B u + f; y = C x + D u + g where region_A (x, u) <= region_b",
        "variables": {kind.value: [variable_data(v) for v in getattr(pwa, kind.value)] for kind in Kind},
        "is_complete": pwa.is_complete,
        "effort": asdict(pwa.effort),
        "modes": [_mode_data(mode) for mode in pwa.modes],
        "tree": None if pwa.tree is None else _tree_data(pwa.tree),
        "tests": _condition_data(pwa.tests),
        "dead_ends": _condition_data(pwa.dead_ends),
        "owner": list(pwa.owner),
        "leaves": [{"d": leaf.d.tolist(), "Z": leaf.Z.tolist(), "z0": leaf.z0.tolist()} for leaf in pwa.leaves],
    }


def _mode_data(mode: Mode) -> dict[str, Any]:
    return {
        "word": dict(mode.word),
        "is_flat": mode.is_flat,
        "conditions": list(mode.conditions),
        **{name: getattr(mode, name).tolist() for name in "ABfCDg"},
        "region_A": mode.region.A.tolist(),
        "region_b": mode.region.b.tolist(),
        "rows": _condition_data(mode.sources),
    }


def _condition_data(conditions: Sequence[Condition]) -> list[dict[str, Any]]:
    return [asdict(condition) | {"kind": condition.kind.value} for condition in conditions]


def _tree_data(tree: SearchTree) -> dict[str, Any]:
    return {"root": tree.root} | {
        name: getattr(tree, name).tolist() for name in ("normals", "offsets", "gaps", "children")
    }


def write_pwa_json(pwa: Pwa, path: str | os.PathLike[str]) -> None:
    """Write the plain data of a Pwa as JSON."""
    Path(path).write_text(json.dumps(pwa_to_dict(pwa), indent=1) + "\n", encoding="utf-8")


def read_pwa_json(path: str | os.PathLike[str]) -> Pwa:
    """Pwa of a JSON file.

    Raises
    ------
    ArgumentError
        It holds something else.
    """
    return pwa_from_dict(json_data(path))


def pwa_from_dict(data: Mapping[str, Any]) -> Pwa:
    """Pwa of the plain data that :func:`pwa_to_dict` gives.

    Raises
    ------
    ArgumentError
        The data is of another kind or version, or a part of it is missing or does not fit.
    """
    check_schema(data, PWA_SCHEMA)
    try:
        return _pwa(data)
    except (KeyError, TypeError, ValueError) as error:
        raise ArgumentError(f"the data of a Pwa is damaged: {type(error).__name__}: {error}") from None


def _pwa(data: Mapping[str, Any]) -> Pwa:
    groups = {kind.value: tuple(variable_of(v, kind) for v in data["variables"][kind.value]) for kind in Kind}
    names = tuple(v.name for v in (*groups["x"], *groups["u"]))
    sizes = {key: len(group) for key, group in groups.items()}
    precision = Precision(**data["precision"])
    modes = tuple(_mode(k, mode, sizes, names, precision) for k, mode in enumerate(data["modes"]))
    return Pwa(
        data["name"],
        **groups,
        modes=modes,
        tree=None if data["tree"] is None else _tree(data["tree"], len(names)),
        tests=_conditions(data["tests"]),
        leaves=tuple(_leaf(leaf, sizes) for leaf in data["leaves"]),
        owner=tuple(data["owner"]),
        dead_ends=_conditions(data["dead_ends"]),
        source=data["source"],
        is_complete=data["is_complete"],
        effort=Effort(**data["effort"]),
        tolerances=Tolerances(**data["tolerances"]),
    )


def _array(entries: Any, *shape: int) -> Array:
    """An array; one without rows or columns may have lost its shape."""
    return np.array(entries, dtype=float).reshape(shape)


def _mode(
    index: int, data: Mapping[str, Any], sizes: Mapping[str, int], names: tuple[str, ...], precision: Precision
) -> Mode:
    nx, nu, ny = sizes["x"], sizes["u"], sizes["y"]
    shapes = {"A": (nx, nx), "B": (nx, nu), "f": (nx,), "C": (ny, nx), "D": (ny, nu), "g": (ny,)}
    blocks = {name: _array(data[name], *shape) for name, shape in shapes.items()}
    rows = len(data["region_b"])
    region = Polyhedron(_array(data["region_A"], rows, len(names)), _array(data["region_b"], rows), precision)
    sources, word = _conditions(data["rows"]), tuple(data["word"].items())
    return Mode(index, **blocks, region=region, sources=sources, word=word, is_flat=data["is_flat"], names=names)


def _conditions(rows: Sequence[Mapping[str, Any]]) -> tuple[Condition, ...]:
    return tuple(Condition(**{**row, "kind": RowKind(row["kind"])}) for row in rows)


def _tree(data: Mapping[str, Any], dimension: int) -> SearchTree:
    count = len(data["offsets"])
    children = np.array(data["children"], dtype=np.int64).reshape(count, 2)
    normals = _array(data["normals"], count, dimension)
    return SearchTree(normals, _array(data["offsets"], count), _array(data["gaps"], count), children, data["root"])


def _leaf(data: Mapping[str, Any], sizes: Mapping[str, int]) -> Auxiliaries:
    nz, n = sizes["z"], sizes["x"] + sizes["u"]
    return Auxiliaries(_array(data["d"], sizes["d"]), _array(data["Z"], nz, n), _array(data["z0"], nz))
