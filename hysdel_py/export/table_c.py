"""A feedback table as C99: a header and a source without allocation.

The function looks up the stored inputs at the corners of the cell that holds the state and mixes those that exist, as
``FeedbackTable`` does with ``law="interpolate"``. Its result tells whether there is an input; where there is none it
writes nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hysdel_py.errors import ArgumentError
from hysdel_py.version import __version__

if TYPE_CHECKING:
    from hysdel_py.control.dynamic_programming.table import FeedbackTable

__all__ = ["table_to_c"]

_WIDTH = 110
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def table_to_c(table: FeedbackTable, path: str | PathLike[str], prefix: str | None = None) -> tuple[Path, Path]:
    """Write ``NAME.c`` and ``NAME.h``.

    Parameters
    ----------
    table : FeedbackTable
        With the same grids at all stages.
    path : path of the source; its ending becomes ``.c``
    prefix : str, optional
        Name of the function and prefix of the macros; the name of the file by default.

    Returns
    -------
    source, header : Path

    Raises
    ------
    ArgumentError
        A prefix that is no name in C, an unfinished table, or grids that differ from stage to stage.
    """
    source = Path(path).with_suffix(".c")
    name = prefix or re.sub(r"\W", "_", source.stem, flags=re.ASCII)
    if not _NAME.fullmatch(name):
        raise ArgumentError(
            f"prefix is {name!r}: a name of letters, digits and _ that begins with a letter was expected"
        )
    if not table.complete:
        raise ArgumentError("the table is not finished: run the recursion to its end before writing code")
    if not _has_one_grid(table):
        raise ArgumentError(
            "the grids of the table differ from stage to stage: write the table of a run without passes"
        )
    header = source.with_suffix(".h")
    source.write_text(_source(table, name, header.name), encoding="ascii")
    header.write_text(_header(table, name), encoding="ascii")
    return source, header


def _has_one_grid(table: FeedbackTable) -> bool:
    first = table.schedule[0]
    return all(
        stage.mesh.axes == first.mesh.axes
        and np.array_equal(stage.inputs, first.inputs)
        and (stage.before is None or np.array_equal(stage.before.inputs, first.inputs))
        for stage in table.schedule
    )


def _header(table: FeedbackTable, name: str) -> str:
    macro = name.upper()
    lines = [
        f"{kind} {i}: {_ascii(v.label)}, {v.low:g} to {v.high:g}"
        for kind, key in (("x", "x"), ("u", "u"))
        for i, v in enumerate(table.variables[key])
    ]
    last = "last is the input applied before. " if table.schedule[0].before is not None else "last is not used. "
    return f"""/* Feedback table of {table.stages} stages, sample time {table.sample_time:g}; hysdel_py {__version__}.
 *
 * {chr(10).join([lines[0], *(f" * {line}" for line in lines[1:])])}
 */
#ifndef {macro}_H
#define {macro}_H
#define {macro}_STAGES {table.stages}
#define {macro}_OUTSIDE 0
#define {macro}_INSIDE 1
/* {macro}_INSIDE and an input u, or {macro}_OUTSIDE and u as it was. {last}*/
int {name}(int stage, const double *x, const double *last, double *u);
#endif
"""


def _ascii(text: str) -> str:
    return text.encode("ascii", "replace").decode().replace("*/", "* /")


def _source(table: FeedbackTable, name: str, header: str) -> str:
    stage, mesh = table.schedule[0], table.schedule[0].mesh
    before = stage.before
    known = stage.inputs if before is None else before.inputs
    group = np.zeros(len(known), dtype=int) if before is None else before.group
    policy = np.stack(table.policy)
    inputs, nu = stage.inputs.shape
    kind = "signed char" if inputs <= 127 else "short" if inputs <= 32767 else "int"
    strides = np.concatenate([np.cumprod(mesh.counts[:0:-1])[::-1], [1]])
    tables = [
        _array("double", "low", mesh.low),
        _array("double", "step", mesh.step),
        _array("long", "count", mesh.counts),
        _array("long", "stride", strides),
        _array("double", "input", stage.inputs.ravel()),
        _array("double", "width", np.maximum(np.ptp(known, axis=0), 1e-300)),
        _array("long", "group", group),
        _array(kind, "policy", policy.ravel()),
    ]
    sizes = {
        "name": name, "macro": name.upper(), "header": header, "nx": len(mesh.axes), "nu": nu, "inputs": inputs,
        "columns": stage.columns, "nodes": mesh.size, "stages": table.stages,
        "column": "nearest_column(last)" if before is not None else "0",
        "least": repr(table.settings.least_weight),
    }  # fmt: skip
    return _HEAD.format(**sizes) + "".join(tables) + (_COLUMN if before is not None else "") + _CODE.format(**sizes)


def _array(kind: str, name: str, values: Iterable[Any]) -> str:
    """A constant array, its numbers exact."""
    texts = [repr(float(v)) if kind == "double" else str(int(v)) for v in values]
    lines, line = [], "   "
    for text in texts:
        if len(line) + len(text) + 2 > _WIDTH:
            lines.append(line)
            line = "   "
        line += f" {text},"
    body = "\n".join([*lines, line])
    return f"static const {kind} {name}[{len(texts)}] = {{\n{body}\n}};\n"


_HEAD = """/* Written by hysdel_py; see {header}. */
#include "{header}"
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
}}
"""
