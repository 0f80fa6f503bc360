"""The program inside the C source of a law that replays points and fails where a move differs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hysdel_py.export.c_text import array, float_text
from hysdel_py.export.law_points import ReplayPoints
from hysdel_py.export.law_table import LawTable

__all__ = ["self_test"]

_MAIN = """
/* 0 if the law agrees with the points. */
int main(void)
{{
    int k, i, wrong = 0;
    for (k = 0; k < {count}; k++) {{
        {result} u[{moves}];
{load}\
        const int status = {name}(zeta, u);
        int bad = status != (replay_inside[k] ? {upper}_INSIDE : {upper}_OUTSIDE);
        for (i = 0; i < {moves} && replay_inside[k] && !bad; i++) {{
            const double error = {value} - replay_u[k][i];
            bad = !(error <= replay_tolerance[i] && -error <= replay_tolerance[i]);
        }}
        if (bad)
            printf("point %d: status %d, expected %d, or a different move\\n", k, status, !replay_inside[k]);
        wrong += bad;
    }}
    printf("%d of {count} points differ\\n", wrong);
    return wrong != 0;
}}
"""


def self_test(table: LawTable, name: str, replay: ReplayPoints) -> Iterator[str]:
    """Lines of the program, compiled where a macro asks for it; none without points."""
    if not len(replay.zeta):
        return
    number = table.scaling.number
    inside = np.asarray(~np.isnan(replay.u).any(axis=1))
    zeta = table.scaling.raw(replay.zeta)
    kind = number.c_type if number.is_fixed else "double"
    yield f"#ifdef {name.upper()}_SELF_TEST"
    yield "#include <stdio.h>"
    yield ""
    yield from array(f"{kind} replay_zeta[{len(zeta)}][{zeta.shape[1]}]", [_row(row, number.is_fixed) for row in zeta])
    moves = np.nan_to_num(replay.u)
    yield from array(f"double replay_u[{len(moves)}][{table.moves}]", [_row(row, False) for row in moves])
    yield from array(f"unsigned char replay_inside[{len(inside)}]", [str(int(flag)) for flag in inside])
    yield from array(f"double replay_tolerance[{table.moves}]", [float_text(value) for value in replay.tolerance])
    words = {"name": name, "upper": name.upper(), "count": str(len(zeta)), "moves": str(table.moves)}
    words |= _loading(table, name, zeta.shape[1])
    yield from _MAIN.format(**words).removesuffix("\n").split("\n")
    yield "#endif"


def _loading(table: LawTable, name: str, p: int) -> dict[str, str]:
    number = table.scaling.number
    if number.is_fixed:
        load = f"        static const double unit[{table.moves}] = {name.upper()}_UNIT;\n"
        load += f"        const {number.c_type} *zeta = replay_zeta[k];\n"
        return {"result": "int32_t", "load": load, "value": "unit[i] * u[i]"}
    load = f"        {number.c_type} zeta[{p}];\n        for (i = 0; i < {p}; i++)\n"
    load += f"            zeta[i] = ({number.c_type})replay_zeta[k][i];\n"
    return {"result": number.c_type, "load": load, "value": "(double)u[i]"}


def _row(values: np.ndarray[tuple[int], np.dtype[np.float64]], whole: bool) -> str:
    return "{" + ", ".join(str(int(v)) if whole else float_text(v) for v in values.tolist()) + "}"
