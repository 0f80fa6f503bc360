"""Explicit laws as JSON files that any program can read; reading one back gives an equal law."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from hysdel_py.control.explicit_file import objective_of_arrays
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.law_signals import LawSignals, read_signals, signals_text
from hysdel_py.errors import ArgumentError
from hysdel_py.export.reading import check_schema, json_data
from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["LAW_SCHEMA", "law_from_dict", "law_to_dict", "read_law_json", "write_law_json"]

LAW_SCHEMA = "hysdel_py explicit law 1"
_MEANING = "z = K zeta + k where A zeta <= b; value 1/2 zeta'P zeta + q'zeta + r; the first entries of z are the move"


def law_to_dict(law: ExplicitLaw) -> dict[str, Any]:
    """Plain data of a law; an infinite side of the domain is None."""
    return {
        "schema": LAW_SCHEMA,
        "meaning": _MEANING,
        "parameters": list(law.names),
        "moves": law.moves,
        "complete": law.complete,
        "tolerance": law.tolerance,
        "domain": {"A": law.domain.A.tolist(), "b": [b if math.isfinite(b) else None for b in law.domain.b.tolist()]},
        "signals": None if law.signals is None else _signals_data(law.signals),
        "objective": None if law.objective is None else law.objective.to_dict(),
        "regions": [_region(law, region) for region in range(law.count)],
    }


def _signals_data(signals: LawSignals) -> dict[str, Any]:
    """What the law reads and gives; an infinite end of a range is None."""
    data: dict[str, Any] = json.loads(signals_text(signals))
    for entry in (*data["x"], *data["u"]):
        for end in ("low", "high"):
            entry[end] = entry[end] if math.isfinite(entry[end]) else None
    return data


def _signals(data: Mapping[str, Any] | None) -> LawSignals | None:
    if data is None:
        return None
    ranges = {"low": -math.inf, "high": math.inf}
    groups = {
        group: [entry | {end: far for end, far in ranges.items() if entry[end] is None} for entry in data[group]]
        for group in ("x", "u")
    }
    return read_signals(json.dumps({**data, **groups}))


def _region(law: ExplicitLaw, region: int) -> dict[str, Any]:
    A, b = law.rows(region)
    data = {"active": list(law.active[region]), "A": A.tolist(), "b": b.tolist(),
            "K": law.K[region].tolist(), "k": law.k[region].tolist()}  # fmt: skip
    if law.has_value:
        data |= {"P": law.P[region].tolist(), "q": law.q[region].tolist(), "r": float(law.r[region])}
    return data


def write_law_json(law: ExplicitLaw, path: str | PathLike[str]) -> None:
    """Write a law; each region is on a line of its own."""
    data = law_to_dict(law)
    regions = data.pop("regions")
    head = [f"{json.dumps(key)}: {json.dumps(value, allow_nan=False)}" for key, value in data.items()]
    body = ",\n".join(json.dumps(region, allow_nan=False) for region in regions)
    text = "{\n" + ",\n".join([*head, f'"regions": [\n{body}\n]']) + "\n}\n"
    Path(path).write_text(text, encoding="utf-8", newline="\n")


def read_law_json(path: str | PathLike[str]) -> ExplicitLaw:
    """The law that a file holds.

    Raises
    ------
    ArgumentError
        It holds something else, or its data is damaged.
    """
    return law_from_dict(json_data(path))


def law_from_dict(data: Mapping[str, Any]) -> ExplicitLaw:
    """Law of the plain data that :func:`law_to_dict` gives.

    Raises
    ------
    ArgumentError
        The data is of another kind or version, or a part of it is missing or does not fit.
    """
    check_schema(data, LAW_SCHEMA)
    try:
        return _law(data)
    except (KeyError, TypeError, ValueError) as error:
        raise ArgumentError(f"the data of an explicit law is damaged: {type(error).__name__}: {error}") from None


def _law(data: Mapping[str, Any]) -> ExplicitLaw:
    names, regions = tuple(map(str, data["parameters"])), data["regions"]
    p, count, has_value = len(names), len(regions), all("P" in region for region in regions)
    n = len(regions[0]["k"]) if regions else int(data["moves"])
    if any(len(region["A"]) != len(region["b"]) or not region["b"] for region in regions):
        raise ValueError("a region has as many rows as sides, and at least one")
    valued = regions if has_value else []
    sides = [math.inf if b is None else b for b in data["domain"]["b"]]
    return ExplicitLaw(
        A=_numbers([row for region in regions for row in region["A"]], -1, p),
        b=_numbers([side for region in regions for side in region["b"]], -1),
        starts=np.cumsum([0, *(len(region["b"]) for region in regions)]),
        K=_numbers([region["K"] for region in regions], count, n, p),
        k=_numbers([region["k"] for region in regions], count, n),
        P=_numbers([region["P"] for region in valued], len(valued), p, p),
        q=_numbers([region["q"] for region in valued], len(valued), p),
        r=_numbers([region["r"] for region in valued], len(valued)),
        active=tuple(tuple(map(int, region["active"])) for region in regions),
        domain=Polyhedron(_numbers(data["domain"]["A"], -1, p), np.array(sides, dtype=float)),
        moves=int(data["moves"]),
        names=names,
        complete=bool(data["complete"]),
        tolerance=float(data["tolerance"]),
        signals=_signals(data.get("signals")),
        objective=_objective(data.get("objective"), n, p),
    )


def _objective(data: Mapping[str, Any] | None, n: int, p: int) -> Any:
    if data is None:
        return None
    shapes: dict[str, tuple[int, ...]] = {"H": (n, n), "f": (n,), "F": (n, p), "Y": (p, p), "y": (p,), "constant": ()}
    return objective_of_arrays({name: _numbers(data[name], *shape) for name, shape in shapes.items()})


def _numbers(values: Any, *shape: int) -> Any:
    array = np.array(values, dtype=float).reshape(shape)
    if not np.isfinite(array).all():
        raise ValueError("a number is not finite")
    return array
