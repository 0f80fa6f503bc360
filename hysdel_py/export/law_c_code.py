"""The functions of an explicit law in C: sides of hyperplanes, the search, the move."""

from __future__ import annotations

from collections.abc import Iterator

from hysdel_py.export.c_text import number_text
from hysdel_py.export.law_number import Number
from hysdel_py.export.law_table import LawTable, Method

__all__ = ["evaluation", "prototype", "shared_functions"]

_VALUE = """
static {sum} value(const {number} *zeta, long plane)
{{
    {sum} sum = {offset};
    int j;
    for (j = 0; j < {p}; j++)
        sum += ({sum})planes[plane][j] * zeta[j];
    return sum;
}}
"""

_HOLDS = """
static int holds(const {number} *zeta, long row)
{{
    return row > 0 ? value(zeta, row - 1) <= {tolerance} : -value(zeta, -row - 1) <= {tolerance};
}}
"""

_REGION = """
static int inside(const {number} *zeta, long region)
{{
    long i;
    for (i = region_start[region]; i < (long)region_start[region + 1]; i++)
        if (!holds(zeta, region_list[i]))
            return 0;
    return 1;
}}
"""

_MOVE = """
static void move(const {number} *zeta, long map, {result} *u)
{{
    int i, j;
    for (i = 0; i < {moves}; i++) {{
        const {number} *row = maps[map] + i * {width};
        {sum} sum = {constant};
        for (j = 0; j < {p}; j++)
            sum += ({sum})row[j] * zeta[j];
        u[i] = {rounded};
    }}
}}
"""

_BOX = """
static int in_range(const {number} *zeta)
{{
    int j;
    for (j = 0; j < {p}; j++)
        if (zeta[j] < -{one} || zeta[j] > {one})
            return 0;
    return 1;
}}
"""

_AMONG = """
static long among(const {number} *zeta, long leaf)
{{
    long i;
    for (i = leaf_start[leaf]; i < (long)leaf_start[leaf + 1]; i++)
        if (inside(zeta, leaf_list[i]))
            return region_map[leaf_list[i]];
    return -1;
}}
"""

_WALK = """
/* Number of the law at a point, -1 outside. */
static long locate(const {number} *zeta)
{{
    long node = {root};
{checks}\
{walk}\
    if (node == -1)
        return -1;
    node = -2 - node;
{open}\
    return node;
}}

{prototype}
{{
    const long map = locate(zeta);
    if (map < 0)
        return {upper}_OUTSIDE;
    move(zeta, map, u);
    return {upper}_INSIDE;
}}
"""

_HULL = """\
    long i;
    for (i = 0; i < {rows}; i++)
        if (!holds(zeta, hull[i]))
            return -1;
"""

_DESCENT = """\
    while (node >= 0)
        node = test_child[node][value(zeta, test_plane[node]) > 0];
"""

_SEARCH = """
{again}
{{
    long found = *region;
{checks}\
    if (found < 0 || found >= {regions} || !inside(zeta, found))
        for (found = 0; found < {regions} && !inside(zeta, found); found++)
            ;
    if (found == {regions}) {{
        *region = -1;
        return {upper}_OUTSIDE;
    }}
    *region = found;
    move(zeta, region_map[found], u);
    return {upper}_INSIDE;
}}

{prototype}
{{
    long region = -1;
    return {name}_from(zeta, u, &region);
}}
"""


def evaluation(table: LawTable, name: str) -> Iterator[str]:
    """Lines of all functions."""
    words = _words(table, name)
    parts = [_VALUE, _HOLDS]
    parts += [_BOX] * table.scaling.number.is_fixed
    parts += [_REGION] * bool(table.regions)
    parts += [_MOVE]
    if table.method is Method.TREE:
        parts += [_AMONG] * bool(table.leaves)
        parts.append(_WALK)
        words |= {"walk": _DESCENT if table.tests else "", "open": _open_leaves(table)}
        words["checks"] = _box("        return -1;\n", table) + _HULL.format(rows=len(table.hull)) * bool(table.hull)
        words["checks"] = _declarations_first(words["checks"])
    else:
        parts.append(_SEARCH)
        words["checks"] = _box(
            f"    {{\n        *region = -1;\n        return {name.upper()}_OUTSIDE;\n    }}\n", table
        )
    for part in parts:
        yield from part.format(**words).removeprefix("\n").removesuffix("\n").split("\n")
        yield ""


def shared_functions(table: LawTable, name: str) -> Iterator[str]:
    """Lines of the functions that tell the side of a row, whether a region holds a point, and its move."""
    words = _words(table, name)
    for part in (_VALUE, _HOLDS, _REGION, _MOVE):
        yield from part.format(**words).removeprefix("\n").removesuffix("\n").split("\n")
        yield ""


def prototype(table: LawTable, name: str, *, last: bool = False) -> str:
    """Head of the function of a law, or of the one that keeps the region of the step before."""
    number = table.scaling.number
    sizes = f"[{name.upper()}_PARAMETERS]", f"[{name.upper()}_MOVES]"
    head = f"const {number.c_type} zeta{sizes[0]}, {_result(number)} u{sizes[1]}"
    return f"int {name}_from({head}, long *region)" if last else f"int {name}({head})"


def _words(table: LawTable, name: str) -> dict[str, str]:
    number, p = table.scaling.number, table.p
    scale = f" * {int(number.one)}" if number.is_fixed else ""
    total = _sum_type(number, p)
    return {
        "name": name,
        "upper": name.upper(),
        "number": number.c_type,
        "result": _result(number),
        "sum": total,
        "p": str(p),
        "width": str(p + 1),
        "moves": str(table.moves),
        "one": str(int(number.one)),
        "offset": f"({total})planes[plane][{p}]{scale}",
        "constant": f"({total})row[{p}]{scale}",
        "rounded": _rounded(number),
        "tolerance": number_text(table.tolerance, number.c_type),
        "root": str(table.root),
        "regions": str(len(table.regions)),
        "prototype": prototype(table, name),
        "again": prototype(table, name, last=True),
    }


def _result(number: Number) -> str:
    return "int32_t" if number.is_fixed else number.c_type


def _sum_type(number: Number, p: int) -> str:
    """A type that holds p + 1 products of numbers of the table."""
    if not number.is_fixed:
        return number.c_type
    return "int32_t" if (p + 1) * number.one**2 < 2**31 else "int64_t"


def _rounded(number: Number) -> str:
    if not number.is_fixed:
        return "sum"
    one, half = int(number.one), int(number.one) // 2
    return f"(int32_t)((sum >= 0 ? sum + {half} : sum - {half}) / {one})"


def _box(answer: str, table: LawTable) -> str:
    return f"    if (!in_range(zeta))\n{answer}" if table.scaling.number.is_fixed else ""


def _declarations_first(text: str) -> str:
    """Older compilers want declarations before statements."""
    declaration = "    long i;\n"
    return declaration + text.replace(declaration, "") if declaration in text else text


def _open_leaves(table: LawTable) -> str:
    if not table.leaves:
        return ""
    return f"    if (node >= {len(table.maps)})\n        return among(zeta, node - {len(table.maps)});\n"
