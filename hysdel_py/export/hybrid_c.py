"""An explicit hybrid law as C99: the regions of all sequences are tried, and their values compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike

from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.export.c_text import chosen_prefix, comment, guard, number_text, source_path
from hysdel_py.export.hybrid_points import hybrid_replay
from hysdel_py.export.hybrid_table import HybridTable, hybrid_table
from hysdel_py.export.law_c import LawCode, labels, write_lines
from hysdel_py.export.law_c_code import shared_functions
from hysdel_py.export.law_c_tables import CTables, c_tables, combined, integers_table, numbers_table
from hysdel_py.export.law_c_test import self_test
from hysdel_py.export.law_number import Number
from hysdel_py.version import __version__

__all__ = ["hybrid_to_c"]

_COST = """
static {number} cost(const {number} *theta, long region)
{{
    const {number} *row = values[region_value[region]];
    {number} sum = row[{constant}];
    int j;
{form}\
    return sum;
}}
"""
_AFFINE = """\
    for (j = 0; j < {p}; j++)
        sum += row[j] * theta[j];
"""
_QUADRATIC = """\
    int i, k = 0;
    for (i = 0; i < {p}; i++) {{
        {number} part = row[{linear} + i];
        for (j = i; j < {p}; j++)
            part += row[k++] * theta[j];
        sum += part * theta[i];
    }}
"""
_SEARCH = """
{prototype}
{{
    {number} theta[{p}]{least};
    long region, chosen = -1;
    unsigned long word = 0;
    int group = 0;
{loading}\
    while (group < {groups} && (unsigned long)group_word[group] != word)
        group++;
    if (group == {groups})
        return {upper}_OUTSIDE;
    for (region = group_start[group]; region < (long)group_start[group + 1]{stop}; region++) {{
{comparison}\
    }}
    if (chosen < 0)
        return {upper}_OUTSIDE;
    move(theta, region_map[chosen], u);
    return {upper}_INSIDE;
}}
"""
_FIRST = """\
        if (inside(theta, region))
            chosen = region;
"""
_BEST = """\
        {number} found, size = least < 0 ? -least : least;
        if (!inside(theta, region))
            continue;
        found = cost(theta, region);
        if (chosen < 0 || found < least - {tie} * (size > 1 ? size : 1)) {{
            least = found;
            chosen = region;
        }}
"""
_PROMISE = (
    "{0}_INSIDE and the move u of the region with the least value that holds the point zeta;",
    "{0}_OUTSIDE where none does, also for what is no number, and for a Boolean that is neither 0 nor 1:",
    "u keeps what it holds then.",
)


def hybrid_to_c(
    law: HybridLaw,
    path: str | PathLike[str],
    *,
    number: str = "double",
    prefix: str | None = None,
    units: Sequence[str] = (),
    points: int = 50,
    seed: int = 0,
) -> LawCode:
    """Write a hybrid law as C: a source that ends in .c, and a header beside it.

    Parameters
    ----------
    law : HybridLaw
    path : str or path
        Of the source.
    number : str
        ``"double"`` or ``"float"``.
    prefix : str, optional
        Of all names; by default the name of the file.
    units : sequence of str
        Of the parameters, for comments.
    points : int
        Points of the self-test, which is compiled where the macro ``PREFIX_SELF_TEST`` is defined.
    seed : int
        Of these points.

    Returns
    -------
    LawCode

    Raises
    ------
    ArgumentError
        An option is not one of these, or the law has no regions.
    """
    source = source_path(path)
    header = source.with_suffix(".h")
    name = chosen_prefix(prefix, source)
    names = labels(law.names, units, len(law.names), "units")
    table = hybrid_table(law, Number.of(number))
    replay = hybrid_replay(law, table, points, seed)
    tables = _tables(table)
    legend = [*_legend(law, table, tables.bytes), "", *_signals(names, [v.name for v in law.u])]
    code = [*tables.lines, "", *shared_functions(table.table, name), *_functions(table, name)]
    write_lines(header, _header(table, name, legend))
    first = [*comment([legend[0]]), f'#include "{header.name}"', "#include <stdint.h>", ""]
    write_lines(source, [*first, *code, *self_test(table.table, name, replay)])
    return LawCode(
        (source, header), name, number, "sequential", tables.bytes, table.law.count, len(table.table.maps),
        len(table.table.planes), 0, 0, 0, len(replay.zeta), "regions of several sequences are compared by value",
    )  # fmt: skip


def _tables(table: HybridTable) -> CTables:
    number = table.table.scaling.number
    width = f"[{table.values.shape[1]}]"
    return combined([
        c_tables(table.table),
        numbers_table("values", width, table.values.tolist(), number.c_type, number.bytes),
        integers_table("region_value", "", table.region_value),
        integers_table("group_word", "", table.words),
        integers_table("group_start", "", table.starts),
    ])  # fmt: skip


def _legend(law: HybridLaw, table: HybridTable, size: int) -> Iterator[str]:
    yield f"Explicit law of a hybrid controller, written by hysdel_py {__version__}."
    yield ""
    complete = "" if law.complete else "; the search was not complete"
    yield f"{len(law.sequences)} sequences of switches, {table.law.count} regions{complete}."
    yield f"Tables of {size} bytes in {table.table.scaling.number.c_type}."


def _signals(names: Sequence[str], moves: Sequence[str]) -> Iterator[str]:
    for title, entries in (("zeta", names), ("u", moves)):
        yield from (f"{title}[{index}]: {label}" for index, label in enumerate(entries))


def _header(table: HybridTable, name: str, legend: Sequence[str]) -> Iterator[str]:
    upper = name.upper()
    yield from comment(legend)
    yield f"#ifndef {guard(name)}"
    yield f"#define {guard(name)}"
    yield ""
    yield f"#define {upper}_PARAMETERS {len(table.real) + len(table.boolean)}"
    yield f"#define {upper}_MOVES {table.table.moves}"
    yield f"#define {upper}_INSIDE 0"
    yield f"#define {upper}_OUTSIDE 1"
    yield ""
    yield from comment(line.format(upper) for line in _PROMISE)
    yield f"{_prototype(table, name)};"
    yield from ("", "#endif")


def _prototype(table: HybridTable, name: str) -> str:
    number, upper = table.table.scaling.number.c_type, name.upper()
    return f"int {name}(const {number} zeta[{upper}_PARAMETERS], {number} u[{upper}_MOVES])"


def _functions(table: HybridTable, name: str) -> Iterator[str]:
    p, number = table.table.p, table.table.scaling.number.c_type
    words = {"p": str(p), "number": number, "upper": name.upper(), "groups": str(len(table.words))}
    words |= {"prototype": _prototype(table, name), "tie": number_text(table.tie, number)}
    words |= {"constant": str(table.values.shape[1] - 1), "linear": str(table.values.shape[1] - 1 - p)}
    compares = len(table.values) > 0
    words["form"] = (_QUADRATIC if table.is_quadratic else _AFFINE).format(**words)
    words["comparison"] = (_BEST if compares else _FIRST).format(**words)
    words |= {"loading": "".join(_loading(table, name)), "least": ", least = 0" if compares else ""}
    words["stop"] = "" if compares else " && chosen < 0"
    for part in (_COST,) * compares + (_SEARCH,):
        yield from part.format(**words).removeprefix("\n").removesuffix("\n").split("\n")
        yield ""


def _loading(table: HybridTable, name: str) -> Iterator[str]:
    for place, entry in enumerate(table.real):
        yield f"    theta[{place}] = zeta[{entry}];\n"
    for bit, entry in enumerate(table.boolean):
        yield f"    if (zeta[{entry}] == 1)\n        word |= 1ul << {bit};\n"
        yield f"    else if (zeta[{entry}] != 0)\n        return {name.upper()}_OUTSIDE;\n"
