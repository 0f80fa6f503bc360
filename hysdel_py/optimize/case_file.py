"""A mixed-integer program as a JSON file, to be solved again anywhere.

``null`` stands for a side or bound that is infinite, and for a time without limit. Matrices are lists of rows, columns
and values of their entries, so that other programs can read them too.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.mixed_integer import Miqp, MiqpResult, MiqpSettings
from hysdel_py.optimize.qp import Qp

__all__ = ["FORMAT", "CaseFile", "read_case", "solve_case", "write_case"]

Vector = NDArray[np.float64]
FORMAT = "hysdel_py mixed-integer program 1"
PROGRAM = "min 1/2 x'Px + q'x + constant, l <= Ax <= u, lb <= x <= ub, x[i] in {0, 1} for i in binaries"
KEPT = ("backend", "gap_abs", "gap_rel", "feasibility", "time_limit", "node_limit")
"""Settings that go into the file."""
SIDES = {"l": -inf, "u": inf, "lb": -inf, "ub": inf}


@dataclass(frozen=True, slots=True, eq=False)
class CaseFile:
    """What a file holds.

    Attributes
    ----------
    miqp : Miqp
    settings : MiqpSettings
    variables, rows : tuple of str
        Meaning of each variable and row; empty where the file does not say.
    """

    miqp: Miqp
    settings: MiqpSettings
    variables: tuple[str, ...] = ()
    rows: tuple[str, ...] = ()

    def solve(self, settings: MiqpSettings | None = None, **vectors: Any) -> MiqpResult:
        """Solve with the settings of the file or others: HiGHS without a quadratic term, else branch and bound.

        Further keywords go to the search.
        """
        from hysdel_py.optimize.milp import solve_milp
        from hysdel_py.optimize.miqp import solve_miqp

        engine = solve_miqp if self.miqp.qp.P.nnz else solve_milp
        return engine(self.miqp, settings or self.settings, **vectors)


def write_case(
    path: str | Path, miqp: Miqp, settings: MiqpSettings, variables: Sequence[str] = (), rows: Sequence[str] = ()
) -> None:
    """Write a program, its settings and the meaning of its variables and rows."""
    qp = miqp.qp
    data = {
        "format": FORMAT,
        "program": PROGRAM,
        "settings": {name: _number(getattr(settings, name)) for name in KEPT},
        "P": _entries(qp.P),
        "A": _entries(qp.A),
        "q": qp.q.tolist(),
        "constant": qp.constant,
        **{name: [_number(value) for value in getattr(qp, name).tolist()] for name in SIDES},
        "binaries": miqp.binaries.tolist(),
        "priorities": miqp.priorities.tolist(),
        "drivers": miqp.drivers.tolist(),
        "variables": list(variables),
        "rows": list(rows),
    }
    Path(path).write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


def read_case(path: str | Path) -> CaseFile:
    """Read a program that :func:`write_case` wrote.

    Raises
    ------
    ArgumentError
        The file is missing, is no JSON, or does not hold such a program.
    """
    try:
        data = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ArgumentError(f"{path} cannot be read as JSON: {error}") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise ArgumentError(f'{path} has no entry "format": "{FORMAT}": a file of dump_problem was expected')
    try:
        return _case(data)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise ArgumentError(f"{path} does not hold the program that its format promises: {error!r}") from None


def solve_case(path: str | Path) -> MiqpResult:
    """Read a program and solve it with the settings of the file."""
    return read_case(path).solve()


def _case(data: dict[str, Any]) -> CaseFile:
    sides = {name: _sides(data[name], without) for name, without in SIDES.items()}
    qp = Qp(P=_matrix(data["P"]), q=data["q"], A=_matrix(data["A"]), constant=data["constant"], **sides)
    miqp = Miqp(qp, data["binaries"], priorities=data["priorities"], drivers=data["drivers"])
    settings: dict[str, Any] = {
        name: inf if value is None else value for name, value in data["settings"].items() if name in KEPT
    }
    return CaseFile(miqp, MiqpSettings(**settings), tuple(data["variables"]), tuple(data["rows"]))


def _number(value: Any) -> Any:
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _sides(values: list[float | None], without: float) -> Vector:
    return np.array([without if value is None else value for value in values], dtype=float)


def _entries(matrix: Any) -> dict[str, Any]:
    coo = matrix.tocoo()
    rows, columns = coo.coords
    return {"shape": list(coo.shape), "rows": rows.tolist(), "columns": columns.tolist(), "values": coo.data.tolist()}


def _matrix(entries: dict[str, Any]) -> Any:
    from scipy.sparse import csc_array

    return csc_array((entries["values"], (entries["rows"], entries["columns"])), shape=tuple(entries["shape"]))
