"""The program inside the C source of a feedback table that replays points and fails where an input differs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.export.c_text import array, float_text

if TYPE_CHECKING:
    from hysdel_py.control.dynamic_programming.table import FeedbackTable

__all__ = ["table_test"]

Matrix = NDArray[np.float64]

_WIDER = 0.1
"""Share of its range by which each axis is widened for the points, so that some lie outside."""
_ACCURACY = "1e-12"

_MAIN = """
/* 0 if the table agrees with the points. */
int main(void)
{{
    int k, i, wrong = 0;
    for (k = 0; k < {count}; k++) {{
        double u[NU];
        const int status = {name}(replay_stage[k], replay_x[k], replay_last[k], u);
        int bad = status != (replay_inside[k] ? {macro}_INSIDE : {macro}_OUTSIDE);
        for (i = 0; i < NU && replay_inside[k] && !bad; i++) {{
            const double theirs = replay_u[k][i], room = {accuracy} * (1.0 + (theirs < 0.0 ? -theirs : theirs));
            bad = !(u[i] - theirs <= room && theirs - u[i] <= room);
        }}
        if (bad)
            printf("point %d: status %d, inside %d, or a different input\\n", k, status, replay_inside[k]);
        wrong += bad;
    }}
    printf("%d of {count} points differ\\n", wrong);
    return wrong != 0;
}}
"""


def table_test(table: FeedbackTable, name: str, points: int, seed: int) -> Iterator[str]:
    """Lines of the program, compiled where a macro asks for it; none without points."""
    if not points:
        return
    rng = np.random.default_rng(seed)
    x, last = (_spread(rng, table, key, points) for key in "xu")
    stages = rng.integers(0, table.stages, points).tolist()
    answers = [table(*given, "interpolate") for given in zip(x, stages, last, strict=True)]
    nothing = np.zeros(last.shape[1])
    yield f"#ifdef {name.upper()}_SELF_TEST"
    yield "#include <stdio.h>"
    yield ""
    yield from array(f"int replay_stage[{points}]", [str(stage) for stage in stages])
    yield from array(f"unsigned char replay_inside[{points}]", [str(int(u is not None)) for u in answers])
    for field, rows in (("x", x), ("last", last), ("u", [nothing if u is None else u for u in answers])):
        yield from array(f"double replay_{field}[{points}][{len(rows[0])}]", [_row(row.tolist()) for row in rows])
    words = {"name": name, "macro": name.upper(), "count": points, "accuracy": _ACCURACY}
    yield from _MAIN.format(**words).removesuffix("\n").split("\n")
    yield "#endif"


def _spread(rng: np.random.Generator, table: FeedbackTable, key: str, points: int) -> Matrix:
    """Random states or inputs, some of them outside the axes."""
    low = np.array([v.low for v in table.variables[key]])
    high = np.array([v.high for v in table.variables[key]])
    more = _WIDER * (high - low)
    return rng.uniform(low - more, high + more, (points, len(low)))


def _row(values: Sequence[float]) -> str:
    return "{" + ", ".join(map(float_text, values)) + "}"
