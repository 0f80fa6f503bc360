"""A feedback table as C99: a header and a source without allocation.

The function looks up the stored inputs at the corners of the cell that holds the state and mixes those that exist, as
``FeedbackTable`` does with ``law="interpolate"``. Its result tells whether there is an input; where there is none it
writes nothing. A macro compiles a program that replays points whose inputs were computed in Python.
"""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.control.dynamic_programming.checks import whole
from hysdel_py.errors import ArgumentError
from hysdel_py.export.c_text import array, chosen_prefix, comment, float_text, guard, index_type, number_text
from hysdel_py.export.table_c_test import table_test
from hysdel_py.version import __version__

if TYPE_CHECKING:
    from hysdel_py.control.dynamic_programming.table import FeedbackTable

__all__ = ["table_to_c"]


def table_to_c(
    table: FeedbackTable, path: str | PathLike[str], prefix: str | None = None, *, points: int = 50, seed: int = 0
) -> tuple[Path, Path]:
    """Write ``NAME.c`` and ``NAME.h``.

    Parameters
    ----------
    table : FeedbackTable
        With the same grids at all stages.
    path : path of the source; its ending becomes ``.c``
    prefix : str, optional
        Name of the function and prefix of the macros; the name of the file by default.
    points : int
        Points of the self-test, which is compiled where the macro ``PREFIX_SELF_TEST`` is defined.
    seed : int
        Of these points.

    Returns
    -------
    source, header : Path

    Raises
    ------
    ArgumentError
        A prefix that is no name in C, an unfinished table, or grids that differ from stage to stage.
    """
    source = Path(path).with_suffix(".c")
    name = chosen_prefix(prefix, source)
    if not table.complete:
        raise ArgumentError("the table is not finished: run the recursion to its end before writing code")
    if not _has_one_grid(table):
        raise ArgumentError(
            "the grids of the table differ from stage to stage: write the table of a run without passes"
        )
    test = table_test(table, name, whole(points, "points", 0), whole(seed, "seed", 0))
    header = source.with_suffix(".h")
    _write(source, "\n".join([_source(table, name, header.name), *test]) + "\n")
    _write(header, "\n".join(_header(table, name)) + "\n")
    return source, header


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")


def _has_one_grid(table: FeedbackTable) -> bool:
    first = table.schedule[0]
    return all(
        stage.mesh.axes == first.mesh.axes
        and np.array_equal(stage.inputs, first.inputs)
        and (stage.before is None or np.array_equal(stage.before.inputs, first.inputs))
        for stage in table.schedule
    )


def _header(table: FeedbackTable, name: str) -> Iterator[str]:
    macro = name.upper()
    yield from comment(
        [
            f"Feedback table of {table.stages} stages, sample time {table.sample_time:g}; hysdel_py {__version__}.",
            "",
            *(
                f"{key} {i}: {v.label}, {v.low:g} to {v.high:g}"
                for key in "xu"
                for i, v in enumerate(table.variables[key])
            ),
        ]
    )
    yield from (f"#ifndef {guard(name)}", f"#define {guard(name)}", f"#define {macro}_STAGES {table.stages}")
    yield from (f"#define {macro}_OUTSIDE 0", f"#define {macro}_INSIDE 1")
    uses_last = table.schedule[0].before is not None
    yield from comment(
        [
            f"{macro}_INSIDE and an input u, or {macro}_OUTSIDE and u as it was.",
            "last is the input applied before." if uses_last else "last is not used.",
        ]
    )
    yield f"int {name}(int stage, const double *x, const double *last, double *u);"
    yield "#endif"


def _source(table: FeedbackTable, name: str, header: str) -> str:
    stage = table.schedule[0]
    inputs, nu = stage.inputs.shape
    sizes = {
        "name": name, "macro": name.upper(), "header": header, "nx": len(stage.mesh.axes), "nu": nu, "inputs": inputs,
        "columns": stage.columns, "nodes": stage.mesh.size,
        "column": "nearest_column(last)" if stage.before is not None else "0",
        "least": float_text(table.settings.least_weight),
    }  # fmt: skip
    column = _COLUMN if stage.before is not None else ""
    return _HEAD.format(**sizes) + "\n".join(_tables(table)) + "\n" + column + _CODE.format(**sizes)


def _tables(table: FeedbackTable) -> Iterator[str]:
    stage, mesh = table.schedule[0], table.schedule[0].mesh
    known = stage.inputs if stage.before is None else stage.before.inputs
    group = np.zeros(len(known), dtype=int) if stage.before is None else stage.before.group
    for c_type, name, values in (
        ("double", "low", mesh.low),
        ("double", "step", mesh.step),
        ("long", "count", mesh.counts),
        ("long", "stride", np.concatenate([np.cumprod(mesh.counts[:0:-1])[::-1], [1]])),
        ("double", "input", stage.inputs.ravel()),
        ("double", "width", np.maximum(np.ptp(known, axis=0), 1e-300)),
        ("long", "group", group),
        (index_type([-1, len(stage.inputs) - 1])[0], "policy", np.stack(table.policy).ravel()),
    ):
        yield from array(f"{c_type} {name}[{len(values)}]", [number_text(value, c_type) for value in values.tolist()])


_HEAD = """/* Written by hysdel_py; see {header}. */
#include "{header}"
#include <stdint.h>
#define NX {nx}
#define NU {nu}
#define INPUTS {inputs}
#define COLUMNS {columns}
#define NODES {nodes}L
"""

_COLUMN = """
static double size_of(double value)
{
    return value < 0 ? -value : value;
}

/* Column of the nearest input before, each entry measured by its range. */
static long nearest_column(const double *last)
{
    long i, best = 0;
    double least = 0;
    for (i = 0; i < INPUTS; i++) {
        double distance = 0;
        int j;
        for (j = 0; j < NU; j++)
            distance += size_of((input[i * NU + j] - last[j]) / width[j]);
        if (i == 0 || distance < least) {
            best = i;
            least = distance;
        }
    }
    return group[best];
}
"""

_CODE = """
/* Cell of x on one axis: its lower corner and the place in it, 0 to 1; 0 where x is outside or no number. */
static int locate(double x, int axis, long *corner, double *part)
{{
    double place = (x - low[axis]) / step[axis], last = (double)(count[axis] - 1);
    long node;
    if (!(place >= -1e-9 && place <= last + 1e-9))
        return 0;
    place = place < 0 ? 0 : place > last ? last : place;
    node = (long)(place + 0.5);
    if (place - (double)node <= 1e-9 && (double)node - place <= 1e-9)
        place = (double)node;
    *corner = (long)place;
    if (*corner > 0 && *corner > count[axis] - 2)
        *corner = count[axis] - 2 > 0 ? count[axis] - 2 : 0;
    *part = place - (double)*corner;
    return 1;
}}

int {name}(int stage, const double *x, const double *last, double *u)
{{
    long corner[NX], column, bits;
    double part[NX], sum[NU] = {{0}}, share = 0;
    int i, j;
    if (stage < 0 || stage >= {macro}_STAGES)
        return {macro}_OUTSIDE;
    for (i = 0; i < NX; i++)
        if (!locate(x[i], i, &corner[i], &part[i]))
            return {macro}_OUTSIDE;
    (void)last;
    (void)width;
    (void)group;
    column = {column};
    for (bits = 0; bits < (1L << NX); bits++) {{
        double weight = 1;
        long node = 0, chosen;
        for (i = 0; i < NX; i++) {{
            int up = (int)(bits >> (NX - 1 - i)) & 1;
            weight *= up ? part[i] : 1 - part[i];
            node += (corner[i] + up) * stride[i];
        }}
        if (!(weight > 0))
            continue;
        chosen = policy[(stage * NODES + node) * COLUMNS + column];
        if (chosen < 0)
            continue;
        share += weight;
        for (j = 0; j < NU; j++)
            sum[j] += weight * input[chosen * NU + j];
    }}
    if (share < {least})
        return {macro}_OUTSIDE;
    for (j = 0; j < NU; j++)
        u[j] = sum[j] / share;
    return {macro}_INSIDE;
}}"""
