"""Explicit laws as .npz files."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from os import PathLike
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.law_signals import read_signals, signals_text
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.parametric.objective import ParametricObjective

__all__ = ["law_arrays", "law_of_arrays", "load_law", "objective_of_arrays", "save_law"]

_FORMAT = 1
_OBJECTIVE = "objective_"
_ARRAYS = ("A", "b", "starts", "K", "k", "P", "q", "r")


def save_law(law: ExplicitLaw, path: str | PathLike[str]) -> None:
    """Write a law; nothing in the file needs to be executed to read it."""
    with open(path, "wb") as file:
        np.savez(file, **law_arrays(law))


def law_arrays(law: ExplicitLaw) -> dict[str, Any]:
    """All that a law consists of, as arrays."""
    return (
        {name: getattr(law, name) for name in _ARRAYS}
        | {
            "format": np.array(_FORMAT),
            "moves": np.array(law.moves),
            "names": np.array(law.names),
            "complete": np.array(law.complete),
            "tolerance": np.array(law.tolerance),
            "domain_sides": law.domain.b,
            "domain_rows": law.domain.A,
            "active": np.array([row for rows in law.active for row in rows], dtype=np.int64),
            "active_starts": np.cumsum([0, *(len(rows) for rows in law.active)]),
        }
        | _objective_arrays(law.objective)
        | ({} if law.signals is None else {"signals": np.array(signals_text(law.signals))})
    )


def load_law(path: str | PathLike[str]) -> ExplicitLaw:
    """Read a law.

    Raises
    ------
    ArgumentError
        The file is no explicit law or of another format.
    """
    try:
        with np.load(path, allow_pickle=False) as data:
            content = {name: data[name] for name in data.files}
    except (BadZipFile, ValueError) as error:
        raise ArgumentError(f"{path} is not an .npz file: {error}") from None
    if content.get("format") != _FORMAT:
        raise ArgumentError(f"{path} holds no explicit law of format {_FORMAT}")
    return law_of_arrays(content)


def law_of_arrays(content: Mapping[str, Any]) -> ExplicitLaw:
    """Inverse of :func:`law_arrays`."""
    return ExplicitLaw(
        **{name: content[name] for name in _ARRAYS},
        domain=Polyhedron(content["domain_rows"], content["domain_sides"]),
        active=_sets(content["active"], content["active_starts"]),
        moves=int(content["moves"]),
        names=tuple(str(name) for name in content["names"]),
        complete=bool(content["complete"]),
        tolerance=float(content["tolerance"]),
        signals=read_signals(str(content["signals"])) if "signals" in content else None,
        objective=_objective(content) if f"{_OBJECTIVE}H" in content else None,
    )


def _objective_arrays(objective: ParametricObjective | None) -> dict[str, Any]:
    if objective is None:
        return {}
    content = objective.arrays() | {"constant": np.array(objective.constant)}
    return {_OBJECTIVE + name: array for name, array in content.items()}


def _objective(content: Mapping[str, Any]) -> ParametricObjective:
    own = {name.removeprefix(_OBJECTIVE): value for name, value in content.items() if name.startswith(_OBJECTIVE)}
    return objective_of_arrays(own)


def objective_of_arrays(arrays: Mapping[str, Any]) -> ParametricObjective:
    """The objective of its coefficients by name."""
    return ParametricObjective(**{**arrays, "constant": float(arrays["constant"])})


def _sets(rows: NDArray[np.int64], starts: NDArray[np.int64]) -> tuple[tuple[int, ...], ...]:
    ends = starts.tolist()
    return tuple(tuple(rows[a:b].tolist()) for a, b in pairwise(ends))
